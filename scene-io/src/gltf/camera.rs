//! Cameras: they look along −z, y being up.

use super::document::Document;
use super::node::Placed;
use crate::Error;
use glam::DVec3;

/// A camera of the file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) position: DVec3,
    pub(crate) forward: DVec3,
    pub(crate) up: DVec3,
    pub(crate) projection: Projection,
    /// Width over height of the picture, if the file says.
    pub(crate) aspect: Option<f64>,
}

/// How much of the world a camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Projection {
    /// The vertical angle of view in radians.
    Perspective { yfov: f64 },
    /// The height of the picture in the coordinates of the world.
    Orthographic { height: f64 },
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
    let m = placed.to_world.matrix3;
    let (projection, aspect) = projection(document, index, m.y_axis.length())?;
    if aspect.is_some_and(|a| !(1e-4..=1e4).contains(&a)) {
        let why = "has a picture that is no picture, by its width over its height: export again";
        return Err(document.error(format!("cameras[{index}]"), why));
    }
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
        projection,
        aspect,
    })
}

/// The projection of a camera, and the aspect of its picture; `scale` is that of the world, upwards
/// in the picture.
fn projection(
    document: &Document,
    index: usize,
    scale: f64,
) -> Result<(Projection, Option<f64>), Error> {
    let camera = &document.root.cameras[index];
    let fault = |key: &str, why: &str| {
        Err(document.error(
            format!("cameras[{index}].{key}"),
            format!("{why}: export again"),
        ))
    };
    if let Some(orthographic) = &camera.orthographic {
        let [x, y] = [orthographic.xmag, orthographic.ymag].map(|m| f64::from(m).abs());
        let height = 2.0 * y * scale;
        if !(height as f32 > 0.0 && (height as f32).is_finite() && x > 0.0) {
            return fault("orthographic", "must have xmag and ymag above 0");
        }
        return Ok((Projection::Orthographic { height }, Some(x / y)));
    }
    let Some(perspective) = &camera.perspective else {
        return fault("perspective", "is missing");
    };
    let yfov = f64::from(perspective.yfov);
    if !(yfov as f32 > 0.0 && yfov < std::f64::consts::PI) {
        return fault("perspective.yfov", "must be between 0 and π");
    }
    let aspect = perspective.aspect_ratio.map(f64::from);
    Ok((Projection::Perspective { yfov }, aspect))
}
