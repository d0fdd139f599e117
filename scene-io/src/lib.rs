//! Scenes from files and images to files: the host that the tyndall command renders.
