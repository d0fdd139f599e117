//! Colours and numbers that a texture may vary.

use super::reader::{Field, Table};
use crate::Error;
use crate::files::Files;
use crate::material::{FLIP, Map, ScalarMap};
use crate::texture::{Budget, ColourSpace, Filter, Texture, Wrap};
use glam::{Affine2, Vec2};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
use tyndall_core::Rgb;

/// What a texture is read from, and how.
type Source = (PathBuf, ColourSpace, [Wrap; 2], Filter);

/// The textures of a scene, each read once.
pub(super) struct Textures<'a> {
    pub(super) files: &'a Files,
    budget: &'a Budget,
    loaded: HashMap<Source, Arc<Texture>>,
}

const CHANNELS: [&str; 4] = ["red", "green", "blue", "alpha"];

impl<'a> Textures<'a> {
    pub(super) fn new(files: &'a Files, budget: &'a Budget) -> Self {
        let loaded = HashMap::new();
        Self {
            files,
            budget,
            loaded,
        }
    }

    pub(super) fn get(
        &mut self,
        path: PathBuf,
        space: ColourSpace,
        wrap: [Wrap; 2],
        filter: Filter,
    ) -> Result<Arc<Texture>, Error> {
        let source = (path, space, wrap, filter);
        if let Some(texture) = self.loaded.get(&source) {
            return Ok(texture.clone());
        }
        let mut texture = Texture::load(&source.0, space, self.budget)?;
        (texture.wrap, texture.filter) = (wrap, filter);
        let texture = Arc::new(texture);
        self.loaded.insert(source, texture.clone());
        Ok(texture)
    }

    /// `{ file, scale, rotation, offset, wrap, filter }`.
    pub(super) fn map(&mut self, table: &Table<'_>, space: ColourSpace) -> Result<Map, Error> {
        let file = table.required("file")?;
        let wrap = match table.optional("wrap") {
            Some(field) => match field.one_of(&["repeat", "mirror", "clamp"])? {
                "repeat" => Wrap::Repeat,
                "mirror" => Wrap::Mirror,
                _ => Wrap::Clamp,
            },
            None => Wrap::default(),
        };
        let filter = match table.optional("filter") {
            Some(field) if field.one_of(&["bilinear", "nearest"])? == "nearest" => Filter::Nearest,
            _ => Filter::default(),
        };
        let transform = transform(table)?;
        let path = self.files.named(file.string()?);
        let texture = self.get(path, space, [wrap; 2], filter);
        Ok(Map {
            texture: texture.map_err(|e| file.error(e))?,
            transform: FLIP * transform,
        })
    }

    /// A colour, or a texture and its `factor`. `colour` reads the former.
    pub(super) fn colour(
        &mut self,
        field: &Field<'_>,
        colour: impl Fn(&Field<'_>) -> Result<Rgb, Error>,
    ) -> Result<(Rgb, Option<Map>), Error> {
        if !field.is_table() {
            return Ok((colour(field)?, None));
        }
        let table = field.table()?;
        let factor = table.optional("factor");
        let factor = factor.map_or(Ok(Rgb::new(1.0, 1.0, 1.0)), |f| colour(&f))?;
        let map = self.map(&table, ColourSpace::Srgb)?;
        table.finish()?;
        Ok((factor, Some(map)))
    }

    /// A number from 0 to 1, or a texture, its `factor` and `channel`; without that it is red, or
    /// alpha where `alpha` and the image has it.
    pub(super) fn scalar(
        &mut self,
        field: &Field<'_>,
        alpha: bool,
    ) -> Result<(f32, Option<ScalarMap>), Error> {
        if !field.is_table() {
            return Ok((share(field)?, None));
        }
        let table = field.table()?;
        let factor = table.optional("factor").map_or(Ok(1.0), |f| share(&f))?;
        let map = self.map(&table, ColourSpace::Linear)?;
        let channel = match table.optional("channel") {
            Some(field) => {
                let name = field.one_of(&CHANNELS)?;
                CHANNELS.iter().position(|c| *c == name).unwrap_or(0)
            }
            None if alpha && map.texture.has_alpha() => 3,
            None => 0,
        };
        table.finish()?;
        Ok((factor, Some(ScalarMap { map, channel })))
    }
}

/// A number from 0 to 1.
pub(super) fn share(field: &Field<'_>) -> Result<f32, Error> {
    field.number_that(|x| (0.0..=1.0).contains(&x), "a number from 0 to 1")
}

/// First scaled, then rotated counter-clockwise, then moved.
fn transform(table: &Table<'_>) -> Result<Affine2, Error> {
    let pair = |field: Field<'_>| match field.elements()?.as_slice() {
        [u, v] => Ok(Vec2::new(u.number()? as f32, v.number()? as f32)),
        _ => Err(field.error("expected an array of two numbers, [u, v]")),
    };
    let scale = match table.optional("scale") {
        Some(field) if field.is_array() => pair(field)?,
        Some(field) => Vec2::splat(field.number()? as f32),
        None => Vec2::ONE,
    };
    let degrees = table.optional("rotation").map_or(Ok(0.0), |f| f.number())?;
    let offset = table.optional("offset").map_or(Ok(Vec2::ZERO), pair)?;
    Ok(Affine2::from_scale_angle_translation(
        scale,
        degrees.to_radians() as f32,
        offset,
    ))
}
