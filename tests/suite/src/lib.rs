//! Integrators on scenes and hosts against closed forms and against path.
