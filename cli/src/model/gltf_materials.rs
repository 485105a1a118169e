//! The materials of a glTF document, as far as shadows go: what they cut out, and what they let through.

use std::{collections::HashMap, sync::Arc};

use gltf::json::{
    Root,
    material::{AlphaMode, Material},
    texture::{Info, WrappingMode},
    validation::Checked,
};
use image::RgbaImage;
use umbra4_core::{
    glam::Vec3,
    texture::{TextureSize, Wrap},
};

use super::{
    InMaterial, MaterialError, Surface, Texture, TextureError, TextureName, gltf::called,
    gltf_coordinates::Coordinates, gltf_pictures::Pictures,
};
use crate::srgb;

/// Cutoff of a material that names none.
const CUTOFF: f32 = 0.5;
const BASE_COLOR: &str = "baseColorTexture";
const TRANSMISSION: &str = "transmissionTexture";

/// A material, as shadows see it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Finish {
    /// What it does to light.
    pub(super) surface: Surface,
    /// Whether only its front is seen.
    pub(super) one_sided: bool,
    /// The texture coordinates that it needs.
    pub(super) coordinates: Option<Coordinates>,
}

/// All materials that were asked for, each read once.
pub(super) struct Materials<'a> {
    root: &'a Root,
    pictures: Pictures<'a>,
    read: HashMap<usize, Finish>,
}

/// Makes sure that every texture, picture and sampler that a material names exists, before anything follows these names.
///
/// # Errors
/// The first that does not, with the material's name.
pub(super) fn check_names(root: &Root) -> Result<(), InMaterial> {
    let names = root.materials.iter().enumerate().map(|(index, material)| (label(index, material), material));
    for (label, material) in names {
        for (field, texture) in textures(material) {
            check_texture(root, field, texture.index.value()).map_err(InMaterial::at(label.clone()))?;
        }
    }
    Ok(())
}

fn label(index: usize, material: &Material) -> String {
    called("material", index, material.name.as_deref())
}

fn textures(material: &Material) -> impl Iterator<Item = (&'static str, &Info)> {
    let base = material.pbr_metallic_roughness.base_color_texture.as_ref().map(|info| (BASE_COLOR, info));
    base.into_iter().chain(transmission(material).1.map(|info| (TRANSMISSION, info)))
}

/// Factor and texture of KHR_materials_transmission.
fn transmission(material: &Material) -> (f32, Option<&Info>) {
    let of = material.extensions.as_ref().and_then(|extensions| extensions.transmission.as_ref());
    of.map_or((0.0, None), |of| (of.transmission_factor.0, of.transmission_texture.as_ref()))
}

fn check_texture(root: &Root, field: &'static str, index: usize) -> Result<(), MaterialError> {
    let textures = root.textures.len();
    let texture = root.textures.get(index).ok_or(MaterialError::NoTexture { field, texture: index, textures })?;
    let wrong = |reason| Err(MaterialError::Texture { texture: texture_name(root, index), reason });
    let (image, images) = (texture.source.value(), root.images.len());
    let sampler = texture.sampler.as_ref().map_or(0, |sampler| sampler.value());
    let samplers = root.samplers.len();
    match () {
        // How the crate says that there is none.
        () if image == u32::MAX as usize => wrong(TextureError::NoSource),
        () if image >= images => wrong(TextureError::NoImage { image, images }),
        () if texture.sampler.is_some() && sampler >= samplers => wrong(TextureError::NoSampler { sampler, samplers }),
        () => Ok(()),
    }
}

fn texture_name(root: &Root, index: usize) -> TextureName {
    TextureName { index, name: root.textures.get(index).and_then(|texture| texture.name.clone()) }
}

impl<'a> Materials<'a> {
    /// Those of a document.
    pub(super) fn new(root: &'a Root, pictures: Pictures<'a>) -> Self {
        Self { root, pictures, read: HashMap::new() }
    }

    /// Material `index`; glTF's own where there is none. An error comes with the material's name.
    pub(super) fn get(&mut self, index: Option<usize>) -> Result<Finish, InMaterial> {
        let Some((index, material)) = index.and_then(|index| Some((index, self.root.materials.get(index)?))) else {
            return Ok(Finish { one_sided: true, ..Finish::default() });
        };
        if let Some(finish) = self.read.get(&index) {
            return Ok(finish.clone());
        }
        let finish = self.finish(material).map_err(InMaterial::at(label(index, material)))?;
        Ok(self.read.entry(index).or_insert(finish).clone())
    }

    fn finish(&mut self, material: &Material) -> Result<Finish, MaterialError> {
        let Some(cover) = Cover::of(material)? else {
            return Ok(Finish { one_sided: !material.double_sided, ..Finish::default() });
        };
        if let (_, Some(info)) = transmission(material)
            && cover.transmission > 0.0
        {
            let texture = texture_name(self.root, info.index.value());
            return Err(MaterialError::Unsupported { field: TRANSMISSION, texture });
        }
        let base = &material.pbr_metallic_roughness.base_color_texture;
        let surface = match base {
            Some(info) => self.textured(&cover, info.index.value())?,
            None => cover.even(),
        };
        let coordinates = base.as_ref().filter(|_| surface.is_textured()).map(Coordinates::of);
        Ok(Finish { surface, one_sided: !material.double_sided, coordinates })
    }

    fn textured(&mut self, cover: &Cover, index: usize) -> Result<Surface, MaterialError> {
        let wrong = |reason| MaterialError::Texture { texture: texture_name(self.root, index), reason };
        let textures = self.root.textures.len();
        let texture = self.root.textures.get(index).ok_or(MaterialError::NoTexture {
            field: BASE_COLOR,
            texture: index,
            textures,
        })?;
        let sampler = texture.sampler.as_ref().and_then(|sampler| self.root.samplers.get(sampler.value()));
        let wrap = match sampler {
            Some(sampler) => [wrap(sampler.wrap_s, "wrapS"), wrap(sampler.wrap_t, "wrapT")],
            None => [Ok(Wrap::Repeat), Ok(Wrap::Repeat)],
        };
        let [s, t] = wrap.map(|axis| axis.map_err(wrong));
        let (image, images) = (texture.source.value(), self.root.images.len());
        let picture = self.pictures.get(image).ok_or_else(|| wrong(TextureError::NoImage { image, images }))?;
        let picture = picture.map_err(|reason| wrong(TextureError::Picture { image, reason }))?;
        Ok(cover.on(&picture, [s?, t?]))
    }
}

fn wrap(mode: Checked<WrappingMode>, axis: &'static str) -> Result<Wrap, TextureError> {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Ok(Wrap::Clamp),
        Checked::Valid(WrappingMode::MirroredRepeat) => Err(TextureError::Mirrored { axis }),
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Ok(Wrap::Repeat),
    }
}

/// What a material makes of the texels of its picture.
struct Cover {
    mode: AlphaMode,
    cutoff: f32,
    /// Red, green, blue and alpha, each `0.0..=1.0`.
    factor: [f32; 4],
    /// The fraction of the base colour that goes through what is covered.
    transmission: f32,
}

impl Cover {
    /// That of a material; `None` where it blocks all light. Factors are looked at where they have a say.
    fn of(material: &Material) -> Result<Option<Self>, MaterialError> {
        let mode = match material.alpha_mode {
            Checked::Valid(mode) => mode,
            Checked::Invalid => AlphaMode::Opaque,
        };
        let transmission = fraction("transmissionFactor", transmission(material).0)?;
        if mode == AlphaMode::Opaque && transmission == 0.0 {
            return Ok(None);
        }
        let factor = material.pbr_metallic_roughness.base_color_factor.0;
        for (field, value) in ["baseColorFactor[0]", "baseColorFactor[1]", "baseColorFactor[2]", "baseColorFactor[3]"]
            .into_iter()
            .zip(factor)
        {
            fraction(field, value)?;
        }
        let cutoff = material.alpha_cutoff.map_or(CUTOFF, |cutoff| cutoff.0);
        if !(cutoff >= 0.0 && cutoff.is_finite()) {
            return Err(MaterialError::Cutoff(cutoff));
        }
        Ok(Some(Self { mode, cutoff, factor, transmission }))
    }

    fn alpha(&self, texel: u8) -> f32 {
        f32::from(texel) / 255.0 * self.factor[3]
    }

    /// What goes through a texel: all of it where nothing is covered, and where something is, what is transmitted.
    fn lets_through(&self, [r, g, b, a]: [u8; 4]) -> Vec3 {
        let covered = match self.mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask if self.alpha(a) >= self.cutoff => 1.0,
            AlphaMode::Mask => 0.0,
            AlphaMode::Blend => self.alpha(a),
        };
        let through = if self.transmission > 0.0 {
            let color = Vec3::from([r, g, b].map(|value| srgb::linear(f32::from(value) / 255.0)));
            color * Vec3::from_slice(&self.factor[..3]) * self.transmission
        } else {
            Vec3::ZERO
        };
        (Vec3::ONE - covered * (Vec3::ONE - through)).clamp(Vec3::ZERO, Vec3::ONE)
    }

    /// The surface where there is no picture.
    fn even(&self) -> Surface {
        plain(self.lets_through([255; 4]))
    }

    /// The surface with a picture; where all texels do the same, none is needed.
    fn on(&self, picture: &RgbaImage, wrap: [Wrap; 2]) -> Surface {
        let (width, height) = picture.dimensions();
        let size = TextureSize { width, height, wrap };
        if self.mode == AlphaMode::Mask && self.transmission == 0.0 {
            let texels: Vec<u8> = picture.pixels().map(|texel| texel.0[3]).collect();
            // More alpha is never less opaque.
            let opaque = |alpha: u8| self.alpha(alpha) >= self.cutoff;
            let Some(threshold) = (0..=u8::MAX).find(|alpha| opaque(*alpha)) else { return Surface::Absent };
            return match texels.iter().filter(|alpha| **alpha >= threshold).count() {
                0 => Surface::Absent,
                all if all == texels.len() => Surface::Opaque,
                _ => Surface::Cutout { alphas: Arc::new(Texture { size, texels }), threshold },
            };
        }
        let texels: Vec<[f32; 3]> = picture.pixels().map(|texel| self.lets_through(texel.0).to_array()).collect();
        match texels.first() {
            Some(first) if texels.iter().all(|texel| texel == first) => plain(Vec3::from(*first)),
            _ => Surface::Stained(Arc::new(Texture { size, texels })),
        }
    }
}

/// A surface that lets through the same everywhere.
fn plain(tint: Vec3) -> Surface {
    match tint {
        Vec3::ZERO => Surface::Opaque,
        Vec3::ONE => Surface::Absent,
        tint => Surface::Tinted(tint),
    }
}

fn fraction(field: &'static str, value: f32) -> Result<f32, MaterialError> {
    if (0.0..=1.0).contains(&value) { Ok(value) } else { Err(MaterialError::Factor { field, value }) }
}

#[cfg(test)]
mod tests {
    use image::Rgba;

    use super::*;

    fn cover(text: &str) -> Result<Option<Cover>, String> {
        Cover::of(&gltf::json::deserialize::from_str(text).unwrap()).map_err(|e| e.to_string())
    }

    fn some(text: &str) -> Cover {
        cover(text).unwrap().unwrap()
    }

    fn picture(texels: [[u8; 4]; 2]) -> RgbaImage {
        RgbaImage::from_fn(2, 1, |x, _| Rgba(texels[x as usize]))
    }

    const CLAMP: [Wrap; 2] = [Wrap::Clamp; 2];

    #[test]
    fn masks_cut_at_the_cutoff_itself() {
        let mask = some(r#"{"alphaMode":"MASK","alphaCutoff":0.5019608}"#);
        let Surface::Cutout { alphas, threshold } = mask.on(&picture([[0, 0, 0, 127], [0, 0, 0, 128]]), CLAMP) else {
            panic!("no cutout");
        };
        assert_eq!((threshold, alphas.texels.as_slice(), alphas.size.wrap), (128, [127, 128].as_slice(), CLAMP));
        let half = some(r#"{"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[9e-1,1,1,0.5]}}"#);
        let Surface::Cutout { threshold, .. } = half.on(&picture([[0; 4], [255; 4]]), CLAMP) else {
            panic!("no cutout");
        };
        assert_eq!(threshold, 255);
        assert_eq!(half.on(&picture([[0; 4], [254; 4]]), CLAMP), Surface::Absent);
        assert_eq!(half.on(&picture([[255; 4]; 2]), CLAMP), Surface::Opaque);
        assert_eq!(
            (half.even(), some(r#"{"alphaMode":"MASK","alphaCutoff":2}"#).even()),
            (Surface::Opaque, Surface::Absent)
        );
        let none = some(r#"{"alphaMode":"MASK","alphaCutoff":0}"#);
        assert_eq!(none.on(&picture([[0; 4]; 2]), CLAMP), Surface::Opaque);
    }

    #[test]
    fn blends_let_through_what_they_do_not_cover() {
        let blend = some(r#"{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,0,0,0.25]}}"#);
        assert_eq!(blend.even(), Surface::Tinted(Vec3::splat(0.75)));
        let Surface::Stained(tints) = blend.on(&picture([[0; 4], [255; 4]]), CLAMP) else { panic!("no tints") };
        assert_eq!(tints.texels, [[1.0; 3], [0.75; 3]]);
        assert_eq!(blend.on(&picture([[255; 4]; 2]), CLAMP), Surface::Tinted(Vec3::splat(0.75)));
        assert_eq!(some(r#"{"alphaMode":"BLEND"}"#).even(), Surface::Opaque);
    }

    #[test]
    fn transmission_is_tinted_by_the_base_colour() {
        let text = r#"{"extensions":{"KHR_materials_transmission":{"transmissionFactor":0.5}},
            "pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1]}}"#;
        assert_eq!(some(text).even(), Surface::Tinted(Vec3::new(0.5, 0.25, 0.0)));
        let Surface::Stained(tints) = some(text).on(&picture([[255; 4], [188, 255, 0, 9]]), CLAMP) else {
            panic!("no tints");
        };
        // 188 of sRGB is half the light.
        assert!((Vec3::from(tints.texels[1]) - Vec3::new(0.2515, 0.25, 0.0)).abs().max_element() < 1e-3);
        // Holes in it are holes.
        let masked = some(&text.replacen('{', r#"{"alphaMode":"MASK","#, 1));
        assert_eq!(masked.lets_through([255, 255, 255, 0]), Vec3::ONE);
        assert_eq!(masked.lets_through([255, 255, 255, 255]), Vec3::new(0.5, 0.25, 0.0));
    }

    #[test]
    fn what_blocks_all_light_is_not_looked_at() {
        assert!(cover(r#"{"pbrMetallicRoughness":{"baseColorFactor":[9,9,9,9]}}"#).unwrap().is_none());
    }

    #[test]
    fn errors_name_field_and_value() {
        for (text, words) in [
            (r#"{"alphaMode":"MASK","alphaCutoff":-0.5}"#, "field `alphaCutoff` is -0.5: not a number that is 0"),
            (r#"{"alphaMode":"MASK","alphaCutoff":1e39}"#, "field `alphaCutoff` is inf"),
            (
                r#"{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1.5]}}"#,
                "field `baseColorFactor[3]` is 1.5: not a number in 0..=1",
            ),
            (
                r#"{"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[1,-1,1,1]}}"#,
                "field `baseColorFactor[1]` is -1",
            ),
            (
                r#"{"extensions":{"KHR_materials_transmission":{"transmissionFactor":2}}}"#,
                "field `transmissionFactor` is 2",
            ),
        ] {
            let message = cover(text).err().unwrap();
            assert!(message.contains(words), "{text}: {message}");
        }
        let nan = Material { alpha_cutoff: Some(gltf::json::material::AlphaCutoff(f32::NAN)), ..some_material() };
        assert_eq!(
            Cover::of(&nan).err().unwrap().to_string(),
            "field `alphaCutoff` is NaN: not a number that is 0 at least"
        );
        assert!(fraction("transmissionFactor", f32::NAN).is_err());
    }

    fn some_material() -> Material {
        gltf::json::deserialize::from_str(r#"{"alphaMode":"MASK"}"#).unwrap()
    }
}
