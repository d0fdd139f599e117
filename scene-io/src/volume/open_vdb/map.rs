//! Transforms from voxels to space.

use super::cursor::Cursor;
use crate::volume::message::shown;
use glam::{DAffine3, DMat3, DVec3};

/// Reads a transform.
///
/// Scales come with what OpenVDB derives of them: voxel size, 1/s, 1/s², 1/2s.
pub(super) fn read(cursor: &mut Cursor) -> Result<DAffine3, String> {
    let name = cursor.string()?;
    match name {
        b"UniformScaleMap" | b"ScaleMap" => {
            let [x, y, z, ..] = cursor.f64s::<15>()?;
            Ok(DAffine3::from_scale(DVec3::new(x, y, z)))
        }
        b"UniformScaleTranslateMap" | b"ScaleTranslateMap" => {
            let [u, v, w, x, y, z, ..] = cursor.f64s::<18>()?;
            let matrix3 = DMat3::from_diagonal(DVec3::new(x, y, z));
            let translation = DVec3::new(u, v, w);
            Ok(DAffine3 {
                matrix3,
                translation,
            })
        }
        b"TranslationMap" => Ok(DAffine3::from_translation(cursor.f64s()?.into())),
        b"AffineMap" | b"UnitaryMap" => matrix(cursor.f64s()?),
        b"NonlinearFrustumMap" => Err(
            "it lies in the frustum of a camera: resample it to a box along the axes and export that"
                .into(),
        ),
        _ => Err(format!(
            "its transform `{}` is not read: export it with a linear transform",
            shown(name)
        )),
    }
}

/// Of a matrix whose rows are the images of the axes and of the origin.
fn matrix(m: [f64; 16]) -> Result<DAffine3, String> {
    let row = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
    if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
        return Err("its transform is not affine: export it with a linear transform".into());
    }
    Ok(DAffine3 {
        matrix3: DMat3::from_cols(row(0), row(1), row(2)),
        translation: row(3),
    })
}

/// Writes a transform.
pub(super) fn write(to_world: DAffine3, out: &mut Vec<u8>) {
    let [x, y, z] = to_world.matrix3.to_cols_array_2d();
    let translation = to_world.translation.to_array();
    let scale = DVec3::new(x[0], y[1], z[2]);
    let (name, numbers) = if to_world.matrix3 == DMat3::from_diagonal(scale) {
        let derived = [
            DVec3::from(translation),
            scale,
            scale.abs(),
            1.0 / scale,
            1.0 / (scale * scale),
            0.5 / scale,
        ];
        let name = if scale.x == scale.y && scale.x == scale.z {
            "UniformScaleTranslateMap"
        } else {
            "ScaleTranslateMap"
        };
        (name, derived.map(|v| v.to_array()).concat())
    } else {
        let rows = [(x, 0.0), (y, 0.0), (z, 0.0), (translation, 1.0)];
        let rows = rows.map(|([a, b, c], d)| [a, b, c, d]);
        ("AffineMap", rows.concat())
    };
    super::write::string(name.as_bytes(), out);
    out.extend(numbers.into_iter().flat_map(f64::to_le_bytes));
}
