//! A third-party renderer that borrows an integrator of Tyndall.
