//! Walks of light and of sight through surfaces and media; sampling of points on segments.
