//! rpt's scenes by Tyndall's integrators.

mod fog;
mod photons;
