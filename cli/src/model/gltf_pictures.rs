//! The pictures of a glTF document: PNG and JPEG, in buffers, in data URIs or in files beside it.

use std::{collections::HashMap, io::Cursor, path::Path, sync::Arc};

use gltf::json::{Root, image::Image};
use image::{ImageFormat, ImageReader, RgbaImage};

use super::{ModelError, gltf_buffers};

/// Why a picture is refused.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// It has neither a name nor a place in a buffer.
    #[error("fields `uri` and `bufferView` are both missing")]
    Nowhere,
    /// Its bytes lie outside their buffer.
    #[error("field `bufferView` is {0}, which reaches outside its buffer")]
    Outside(usize),
    /// Its bytes cannot be had.
    #[error("field `uri`: {0}")]
    Unreadable(Box<ModelError>),
    /// It is something else.
    #[error("neither a PNG nor a JPEG")]
    Format,
    /// It has no texels.
    #[error("a picture of {width}×{height} texels: one at least is called for")]
    Empty {
        /// Texels a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// It is broken.
    #[error("cannot be decoded: {0}")]
    Undecodable(#[from] image::ImageError),
}

/// All pictures that were asked for, each decoded once.
pub(super) struct Pictures<'a> {
    root: &'a Root,
    buffers: &'a [Vec<u8>],
    path: &'a Path,
    decoded: HashMap<usize, Arc<RgbaImage>>,
}

impl<'a> Pictures<'a> {
    /// Those of the document that lies at `path`.
    pub(super) fn new(root: &'a Root, buffers: &'a [Vec<u8>], path: &'a Path) -> Self {
        Self { root, buffers, path, decoded: HashMap::new() }
    }

    /// Picture `index`, as red, green, blue and alpha of 8 bits; `None` where there is no such picture.
    pub(super) fn get(&mut self, index: usize) -> Option<Result<Arc<RgbaImage>, PictureError>> {
        if let Some(decoded) = self.decoded.get(&index) {
            return Some(Ok(decoded.clone()));
        }
        let image = self.root.images.get(index)?;
        Some(self.decode(image).map(|decoded| self.decoded.entry(index).or_insert(decoded.into()).clone()))
    }

    fn decode(&self, image: &Image) -> Result<RgbaImage, PictureError> {
        match (&image.buffer_view, &image.uri) {
            (Some(view), _) => {
                let bytes = self.view(view.value()).ok_or(PictureError::Outside(view.value()))?;
                decode(bytes)
            }
            (None, Some(uri)) => {
                let bytes = gltf_buffers::resolve(uri, self.path);
                decode(&bytes.map_err(|e| PictureError::Unreadable(Box::new(e)))?)
            }
            (None, None) => Err(PictureError::Nowhere),
        }
    }

    fn view(&self, index: usize) -> Option<&[u8]> {
        let view = self.root.buffer_views.get(index)?;
        let start = usize::try_from(view.byte_offset.unwrap_or_default().0).ok()?;
        let length = usize::try_from(view.byte_length.0).ok()?;
        self.buffers.get(view.buffer.value())?.get(start..start.checked_add(length)?)
    }
}

fn decode(bytes: &[u8]) -> Result<RgbaImage, PictureError> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(image::ImageError::from)?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)) {
        return Err(PictureError::Format);
    }
    let picture = reader.decode()?.into_rgba8();
    let (width, height) = picture.dimensions();
    if width == 0 || height == 0 {
        return Err(PictureError::Empty { width, height });
    }
    Ok(picture)
}
