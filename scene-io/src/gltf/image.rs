//! Textures, from images in buffers, in place or in files beside the glTF.

use super::document::Document;
use super::uri;
use crate::Error;
use crate::texture::{Budget, ColourSpace, Filter, Texture, Wrap};
use gltf::json::Index;
use gltf::json::texture::{self, MagFilter, WrappingMode};
use gltf::json::validation::Checked;
use std::collections::HashMap;
use std::sync::Arc;

/// Textures that were read.
pub(super) struct Textures<'a> {
    document: &'a Document,
    budget: &'a Budget,
    known: HashMap<(usize, ColourSpace), Arc<Texture>>,
    /// By image: many textures may show one.
    decoded: HashMap<(usize, ColourSpace), Texture>,
}

impl<'a> Textures<'a> {
    pub(super) fn of(document: &'a Document, budget: &'a Budget) -> Self {
        Self {
            document,
            budget,
            known: HashMap::new(),
            decoded: HashMap::new(),
        }
    }

    /// A texture of the file.
    pub(super) fn get(
        &mut self,
        index: Index<texture::Texture>,
        space: ColourSpace,
    ) -> Result<Arc<Texture>, Error> {
        let key = (index.value(), space);
        if let Some(texture) = self.known.get(&key) {
            return Ok(texture.clone());
        }
        let root = &self.document.root;
        let description = &root.textures[index.value()];
        let mut texture = self.image(description.source.value(), space)?;
        if let Some(sampler) = description.sampler {
            let sampler = &root.samplers[sampler.value()];
            texture.wrap = [&sampler.wrap_s, &sampler.wrap_t].map(wrap);
            if let Some(Checked::Valid(MagFilter::Nearest)) = sampler.mag_filter {
                texture.filter = Filter::Nearest;
            }
        }
        let texture = Arc::new(texture);
        self.known.insert(key, texture.clone());
        Ok(texture)
    }

    /// An image with the sampler of nobody, decoded once for each meaning of its numbers.
    fn image(&mut self, index: usize, space: ColourSpace) -> Result<Texture, Error> {
        if let Some(texture) = self.decoded.get(&(index, space)) {
            return Ok(texture.clone());
        }
        let fault = |problem: String| self.document.error(format!("images[{index}]"), problem);
        let texture = Texture::decode(&self.bytes(index)?, space, self.budget).map_err(fault)?;
        self.decoded.insert((index, space), texture.clone());
        Ok(texture)
    }

    fn bytes(&self, index: usize) -> Result<Vec<u8>, Error> {
        let document = self.document;
        let image = &document.root.images[index];
        match (image.buffer_view, image.uri.as_deref()) {
            (Some(view), _) => Ok(document.view(view)?.0.to_vec()),
            (None, Some(uri)) => uri::read(&document.files, uri)
                .map_err(|why| document.error(format!("images[{index}].uri"), why)),
            (None, None) => {
                let why = "has neither a uri nor a bufferView: export again";
                Err(document.error(format!("images[{index}]"), why))
            }
        }
    }
}

fn wrap(mode: &Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}
