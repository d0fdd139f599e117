//! Wavefront OBJ and MTL files.

mod check;

use crate::files::Files;
use crate::{Error, open};
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use tobj::{LoadError, MTLLoadResult};

/// The faces of one material in an OBJ file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    pub(crate) positions: Vec<DVec3>,
    /// One a vertex, or none.
    pub(crate) normals: Vec<Vec3>,
    /// Texture coordinates, one a vertex, or none.
    pub(crate) uvs: Vec<Vec2>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// An OBJ file: its faces by the name that `usemtl` gives them (empty if none does).
pub(crate) struct Obj {
    pub(crate) groups: BTreeMap<String, Group>,
    /// The materials that the MTL files define.
    pub(crate) materials: BTreeMap<String, Mtl>,
    /// Why there are no materials, if a file of them could not be read.
    pub(crate) mtl_problem: Option<String>,
}

/// A material of an MTL file.
pub(crate) struct Mtl {
    pub(crate) material: tobj::Material,
    /// What its textures are named from: the folder of the MTL file.
    pub(crate) files: Files,
}

/// Reads an OBJ file and the MTL files that it names. Polygons become triangles; points and lines
/// are left out. Positions are read in `f64`.
pub(crate) fn read(path: &Path, files: &Files) -> Result<Obj, Error> {
    let problem = |problem: String| Error::Build {
        path: path.to_owned(),
        problem,
    };
    let bytes = open::read(path)?;
    let options = tobj::LoadOptions {
        triangulate: true,
        single_index: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let files = files.followed_from(path);
    let complaint = RefCell::new(None);
    // One for each material, in their order.
    let places = RefCell::new(Vec::new());
    let load_mtl = |mtl: &Path| {
        let path = files.named(mtl);
        let loaded = read_mtl(&path, &complaint)?;
        let count = loaded.0.len();
        (places.borrow_mut()).extend(std::iter::repeat_n(files.followed_from(&path), count));
        Ok(loaded)
    };
    check::obj(&bytes).map_err(problem)?;
    let loaded = tobj::load_obj_buf(&mut bytes.as_slice(), &options, load_mtl);
    let (models, materials) =
        loaded.map_err(|e| problem(format!("is no OBJ file: {e}: export it again")))?;
    let (materials, mtl_problem) = match materials {
        Ok(materials) => (materials, None),
        Err(e) => {
            let why = complaint.take().unwrap_or_else(|| e.to_string());
            (Vec::new(), Some(format!("its MTL file is unusable: {why}")))
        }
    };
    let mut groups = BTreeMap::new();
    for model in models {
        // Of two MTL files, one may be usable: then there are none, and the faces have no name.
        let material = model.mesh.material_id.and_then(|m| materials.get(m));
        let name = material.map(|m| m.name.clone());
        let group: &mut Group = groups.entry(name.unwrap_or_default()).or_default();
        group.append(&model.mesh).map_err(problem)?;
    }
    groups.retain(|_, group| !group.triangles.is_empty());
    if groups.is_empty() {
        return Err(problem(
            "has no faces: export the mesh, not only its curves".into(),
        ));
    }
    let materials = materials.into_iter().zip(places.into_inner());
    let named =
        |(material, files): (tobj::Material, _)| (material.name.clone(), Mtl { material, files });
    Ok(Obj {
        groups,
        materials: materials.map(named).collect(),
        mtl_problem,
    })
}

/// Reads an MTL file; what is wrong with it becomes the `complaint`.
fn read_mtl(path: &Path, complaint: &RefCell<Option<String>>) -> MTLLoadResult {
    let complain = |why: String, error| {
        complaint.replace(Some(why));
        error
    };
    let bytes = open::read(path);
    let bytes = bytes.map_err(|e| complain(e.to_string(), LoadError::OpenFileFailed))?;
    let wrong = |why: &str| format!("{}: {why}", path.display());
    check::mtl(&bytes).map_err(|why| complain(wrong(&why), LoadError::MaterialParseError))?;
    let read = tobj::load_mtl_buf(&mut bytes.as_slice());
    read.map_err(|e| complain(wrong(&e.to_string()), e))
}

impl Group {
    fn append(&mut self, mesh: &tobj::Mesh) -> Result<(), String> {
        let first = self.positions.len() as u32;
        let vectors = |numbers: &[f64]| -> Vec<DVec3> {
            (numbers.chunks_exact(3)).map(DVec3::from_slice).collect()
        };
        let positions = vectors(&mesh.positions);
        if let Some(bad) = positions.iter().find(|p| !p.is_finite()) {
            return Err(format!("vertex {bad} is not finite: export it again"));
        }
        let mut normals: Vec<_> = vectors(&mesh.normals).iter().map(|n| n.as_vec3()).collect();
        // Faces without normals beside faces with them: zero, which means the geometric normal.
        // Those without texture coordinates get the first texel.
        if normals.is_empty() != self.normals.is_empty() {
            normals.resize(positions.len(), Vec3::ZERO);
            self.normals.resize(self.positions.len(), Vec3::ZERO);
        }
        let coordinates = mesh.texcoords.chunks_exact(2);
        let mut uvs: Vec<_> = coordinates
            .map(|c| DVec2::from_slice(c).as_vec2())
            .collect();
        if let Some(bad) = uvs.iter().find(|uv| !uv.is_finite()) {
            return Err(format!(
                "texture coordinate {bad} is not finite: export it again"
            ));
        }
        if uvs.is_empty() != self.uvs.is_empty() {
            uvs.resize(positions.len(), Vec2::ZERO);
            self.uvs.resize(self.positions.len(), Vec2::ZERO);
        }
        self.positions.extend(positions);
        self.normals.extend(normals);
        self.uvs.extend(uvs);
        let triangles = mesh.indices.chunks_exact(3);
        (self.triangles).extend(triangles.map(|t| [t[0] + first, t[1] + first, t[2] + first]));
        Ok(())
    }
}
