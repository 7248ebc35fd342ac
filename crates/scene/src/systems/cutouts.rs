//! Cut-outs: connects shapes with the images whose alpha gives their holes, each decoded once, by
//! the first ray that meets it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Mat3;
use hecs::World;
use image::DynamicImage;

use super::geometry::{Output, ShapeOutput};
use super::textures::{Head, decoding, name, placing};
use crate::components::{CutOut, TextureSource};
use crate::query::json_path;
use wavecrest_base::error::Result;
use wavecrest_core::geometry::cutouts::{Cutout, Cutouts, MeshUvs};
use wavecrest_core::geometry::{Geometry, Primitive};
use wavecrest_core::kernels::texture::{Image, LazyImage, Texels, UvMap};
use wavecrest_core::plan::{Effect, Plan};

/// Adds the cut-outs to the geometry, if the plan has any, and returns their images. `file` is the
/// scene's, for messages.
pub fn run(
    world: &World,
    file: &Path,
    plan: &Plan,
    extracted: &mut Output,
) -> Result<Vec<Arc<LazyImage>>> {
    if !plan.has(Effect::CutOuts) {
        return Ok(Vec::new());
    }
    let mut images = Images { file, known: Vec::new() };
    let (mut own, mut of_prototypes) =
        (Vec::new(), vec![None; extracted.geometry.prototypes.len()]);
    for shape in extracted.shapes.iter().filter(|shape| shape.shape.emission.is_none()) {
        let Ok(found) = world.get::<&CutOut>(shape.entity) else { continue };
        let place = json_path(world, shape.entity);
        let Some(image) = images.of(&found, &place)? else { continue };
        let cutout = cutout(shape, &found, image, extracted);
        match prototype(&extracted.geometry, shape) {
            None => own.push(cutout),
            // All instances of a prototype have the same cut-out.
            Some((number, triangles)) => {
                of_prototypes[number] = Some(Cutout { primitives: 0..triangles, ..cutout });
            }
        }
    }
    extracted.geometry.cutouts = Cutouts::new(own);
    for (prototype, cutout) in extracted.geometry.prototypes.iter_mut().zip(of_prototypes) {
        prototype.cutouts = Cutouts::new(cutout.into_iter().collect());
    }
    Ok(images.known.into_iter().filter_map(|(_, image)| image).collect())
}

fn cutout(shape: &ShapeOutput, found: &CutOut, image: Arc<LazyImage>, from: &Output) -> Cutout {
    let attributes = shape.shape.mesh.and_then(|mesh| from.meshes.get(mesh as usize));
    let mesh = attributes.and_then(|attributes| {
        Some(MeshUvs {
            first_triangle: attributes.first_triangle,
            first_position: attributes.first_position,
            uvs: Arc::clone(attributes.uvs.as_ref()?),
        })
    });
    Cutout {
        primitives: shape.shape.primitives.clone(),
        threshold: found.threshold as f32,
        image,
        filter: found.filter,
        wrap: found.wrap,
        map: shape.uv_map.unwrap_or(UvMap::Sphere(Mat3::IDENTITY)),
        placing: found.placing.map(placing),
        mesh,
    }
}

/// The prototype of an instance, and its number of triangles.
fn prototype(geometry: &Geometry, shape: &ShapeOutput) -> Option<(usize, u32)> {
    let Primitive::Instanced(instanced) = geometry.primitive(shape.shape.primitives.start) else {
        return None;
    };
    let (instance, prototype) = geometry.instance(instanced);
    Some((instance.prototype(), prototype.triangles.len() as u32))
}

/// The key of an image: its source, and whether brightness stands for alpha.
type Key = (TextureSource, bool);

/// The images looked up so far.
struct Images<'a> {
    file: &'a Path,
    /// `None` for images without alpha.
    known: Vec<(Key, Option<Arc<LazyImage>>)>,
}

impl Images<'_> {
    /// The image of a cut-out, after checking the header of its file; `None` if it has no alpha.
    fn of(&mut self, found: &CutOut, place: &str) -> Result<Option<Arc<LazyImage>>> {
        let key = (found.source.clone(), found.is_mask);
        if let Some((_, image)) = self.known.iter().find(|(known, _)| *known == key) {
            return Ok(image.clone());
        }
        let head = Head::of(&found.source).map_err(|error| error.in_file(self.file).at(place))?;
        let image = (head.has_alpha || found.is_mask).then(|| {
            let (source, file, place) =
                (found.source.clone(), self.file.to_owned(), place.to_owned());
            let decode = move || decode(&source, file, place);
            Arc::new(LazyImage::new(name(&found.source), head.mask_bytes(), decode))
        });
        self.known.push((key, image.clone()));
        Ok(image)
    }
}

/// The alpha of an image in each channel, or its brightness if it has none.
fn decode(source: &TextureSource, file: PathBuf, place: String) -> Result<Image> {
    let decoded = decoding(source, |decoder| DynamicImage::from_decoder(decoder));
    let decoded = decoded.map_err(|error| error.in_file(file).at(place))?;
    let (width, height) = (decoded.width(), decoded.height());
    let alpha: Vec<[u8; 4]> = match decoded.color().has_alpha() {
        true => decoded.into_rgba8().pixels().map(|pixel| [pixel.0[3]; 4]).collect(),
        false => decoded.into_luma8().pixels().map(|pixel| [pixel.0[0]; 4]).collect(),
    };
    Ok(Image::new(width, height, Texels::Bytes(alpha)))
}
