//! Cameras: they look along −z, y being up.

use super::document::Document;
use super::node::Placed;
use crate::Error;
use glam::DVec3;

/// A perspective camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) position: DVec3,
    pub(crate) forward: DVec3,
    pub(crate) up: DVec3,
    /// Vertical angle of view in radians.
    pub(crate) yfov: f64,
    /// Width over height of the picture, if the file says.
    pub(crate) aspect: Option<f64>,
}

/// The camera of this name (its own, or that of its node), or the first of the scene; `None` if no
/// name is given and there is none.
pub(super) fn find(
    document: &Document,
    nodes: &[Placed],
    name: Option<&str>,
) -> Result<Option<View>, Error> {
    let root = &document.root;
    let mut names = Vec::new();
    for placed in nodes {
        let node = &root.nodes[placed.node];
        let Some(index) = node.camera else {
            continue;
        };
        let own = root.cameras[index.value()].name.as_deref();
        let wanted = |name| own == Some(name) || node.name.as_deref() == Some(name);
        if name.is_none_or(wanted) {
            return view(document, index.value(), placed).map(Some);
        }
        names.extend(node.name.as_deref().or(own));
    }
    match name {
        None => Ok(None),
        Some(name) => {
            let why = format!(
                "has no camera {name:?}; those of the scene: {}",
                names.join(", ")
            );
            Err(document.error("cameras", why))
        }
    }
}

fn view(document: &Document, index: usize, placed: &Placed) -> Result<View, Error> {
    let camera = &document.root.cameras[index];
    let fault = |key: &str, why: &str| document.error(format!("cameras[{index}]{key}"), why);
    let Some(perspective) = &camera.perspective else {
        return Err(fault(
            ".orthographic",
            "is not supported: make the camera a perspective one, or write a `[camera]`",
        ));
    };
    let yfov = f64::from(perspective.yfov);
    if !(yfov as f32 > 0.0 && yfov < std::f64::consts::PI) {
        return Err(fault(
            ".perspective.yfov",
            "must be between 0 and π: export again",
        ));
    }
    let aspect = perspective.aspect_ratio.map(f64::from);
    if aspect.is_some_and(|a| !(1e-4..=1e4).contains(&a)) {
        return Err(fault(
            ".perspective.aspectRatio",
            "must be above 0: export again",
        ));
    }
    let m = placed.to_world.matrix3;
    let axes = (-m.z_axis).try_normalize().zip(m.y_axis.try_normalize());
    let axes = axes.filter(|(forward, up)| forward.cross(*up).length() > 1e-4);
    let (forward, up) = axes.ok_or_else(|| {
        let why = "flattens its camera: mend its transformation";
        document.error(format!("nodes[{}]", placed.node), why)
    })?;
    Ok(View {
        position: placed.to_world.translation,
        forward,
        up,
        yfov,
        aspect,
    })
}
