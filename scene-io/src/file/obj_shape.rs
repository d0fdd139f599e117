//! `[[shapes]]` of the kind `obj`, and the materials that they bring.

use super::mtl;
use super::reader::{Field, Table};
use super::shape::{Reader, Solid, transform};
use crate::Error;
use crate::obj::{self, Group, Mtl};
use std::path::Path;
use tyndall_core::Rgb;

impl Reader<'_> {
    /// Adds the faces of each material as a shape.
    pub(super) fn read_obj(
        &mut self,
        table: &Table<'_>,
        emission: Option<Rgb>,
    ) -> Result<(), Error> {
        let file = table.required("file")?;
        let path = self.textures.files.named(file.string()?);
        let obj = obj::read(&path, self.textures.files).map_err(|e| file.error(e))?;
        let fallback = (table.optional("material"))
            .map(|f| self.material(&f))
            .transpose()?;
        let map = table.optional("materials");
        if let Some(why) = &obj.mtl_problem
            && (fallback.is_none() || map.is_some())
        {
            return Err(file.error(format!("{why}; mend it, or give `material` alone")));
        }
        let mut mapped = Vec::new();
        if let Some(field) = map {
            let known: Vec<_> = obj.groups.keys().map(String::as_str).collect();
            for (name, field) in field.table()?.named() {
                field.check_name(name, "material of the OBJ file", &known)?;
                mapped.push((name, self.material(&field)?));
            }
        }
        let transform = transform(table)?;
        for (name, mut group) in obj.groups {
            let chosen = mapped.iter().find(|(n, _)| *n == name).map(|&(_, m)| m);
            let material = match (chosen.or(fallback), obj.materials.get(&name)) {
                (Some(material), _) => {
                    self.check_uvs(material, !group.uvs.is_empty(), table.field())?;
                    material
                }
                (None, Some(mtl)) => self.own_material(mtl, &path, &group, &file)?,
                (None, None) => {
                    return Err(table
                        .field()
                        .error("has faces whose material no MTL file defines: add `material`"));
                }
            };
            group.transform(&transform);
            self.add(Solid::Mesh(group), material, emission);
        }
        Ok(())
    }

    /// Complains about textures on what has no texture coordinates.
    pub(super) fn check_uvs(
        &self,
        material: usize,
        has_uvs: bool,
        field: &Field<'_>,
    ) -> Result<(), Error> {
        if !self.materials[material].maps.have_textures() || has_uvs {
            return Ok(());
        }
        Err(field.error(format!(
            "material {:?} has textures, but these faces have no texture coordinates: unwrap the \
             mesh and export it with them, or choose a material without",
            self.names[material]
        )))
    }

    /// A material of an MTL file.
    fn own_material(
        &mut self,
        mtl: &Mtl,
        obj: &Path,
        group: &Group,
        file: &Field<'_>,
    ) -> Result<usize, Error> {
        let Mtl {
            material: mtl,
            files,
        } = mtl;
        let read = mtl::read(mtl, files, &mut self.textures, &mut self.notices);
        let mut material = read.map_err(|why| {
            file.error(format!(
                "its material {:?} {why}; mend the MTL file or name a material of the scene in \
                 `materials`",
                mtl.name
            ))
        })?;
        if material.maps.have_textures() && group.uvs.is_empty() {
            self.notices.push(format!(
                "{}: faces of material {:?} have no texture coordinates: its textures are left out",
                obj.display(),
                mtl.name
            ));
            material.maps = material.maps.without_textures();
        }
        self.materials.push(material);
        Ok(self.materials.len() - 1)
    }
}
