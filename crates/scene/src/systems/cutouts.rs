//! Cut-outs: connects shapes with the images whose alpha gives their holes, each decoded once.
//!
//! They are decoded before the first ray, and only those of shapes that rays may meet: an image
//! without a transparent texel cuts nothing out, and its shapes are like any others.

use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec2};
use hecs::World;
use rayon::prelude::*;

use super::geometry::Arrays;
use super::surface::{SurfaceColumns, SurfaceComponents};
use super::textures::{lazy, placing};
use super::visibility::{Source, Visibility};
use crate::components::{Channels, CutOut, Encoding, LookUp, TextureRef, TextureSource};
use crate::image_file::{Head, range};
use crate::mesh::MeshData;
use wavecrest_base::error::Result;
use wavecrest_base::parallel;
use wavecrest_core::geometry::cutouts::{Cutout, MeshUvs};
use wavecrest_core::geometry::{Geometry, Primitive};
use wavecrest_core::kernels::texture::{Filter, LazyImage, Wrap};
use wavecrest_core::math::float::UNIT_ROUNDOFF;
use wavecrest_core::prepared::{MeshAttributes, Shape, UvMap};

/// Adds the cut-outs that rays may meet and that remove anything, as alphas of vertices below 1 may, to the
/// geometry, and returns their images, of the scene in `file`.
pub(super) fn run(
    world: &World,
    file: &Path,
    Arrays { geometry, meshes }: &mut Arrays,
) -> Result<Vec<Arc<LazyImage>>> {
    let mut images = Masks::of_scene(file);
    let surfaces = world.view::<SurfaceColumns<'_>>();
    let mut shapes = world.query::<(&Source, &Shape, &UvMap, &mut Visibility)>();
    let met = shapes.iter().filter(|(.., visibility)| visibility.is_surface_met());
    let mut met_cut_outs = Vec::new();
    for (source, shape, uv_map, visibility) in met {
        let SurfaceComponents { cut_out, place, .. } = SurfaceComponents::of(&surfaces, source.0);
        let Some(cut_out) = cut_out else { continue };
        images.add(cut_out, place)?;
        met_cut_outs.push((cut_out, shape, *uv_map, &mut visibility.has_holes));
    }
    images.decode()?;
    let (mut own, mut of_prototypes) = (Vec::new(), vec![None; geometry.prototypes.len()]);
    let mut used: Vec<Arc<LazyImage>> = Vec::new();
    for (cut_out, shape, uv_map, has_holes) in met_cut_outs {
        let attributes = shape.mesh.and_then(|mesh| meshes.get(mesh as usize));
        let has_alphas = attributes.is_some_and(|mesh| mesh.alphas.is_some());
        *has_holes = has_alphas || images.has_holes(cut_out);
        if !*has_holes {
            continue;
        }
        let image = images.of(cut_out).map(|found| Arc::clone(&found.image));
        let is_known = |image| used.iter().any(|known| Arc::ptr_eq(known, image));
        used.extend(image.as_ref().filter(|image| !is_known(image)).map(Arc::clone));
        let cutout = cutout(shape, uv_map, cut_out, image, attributes);
        match prototype(geometry, shape) {
            None => own.push(cutout),
            // All instances of a prototype have the same cut-out.
            Some((number, triangles)) => {
                of_prototypes[number] = Some(Cutout { primitives: 0..triangles, ..cutout });
            }
        }
    }
    own.sort_unstable_by_key(|cutout| cutout.primitives.start);
    geometry.cutouts = own;
    for (prototype, cutout) in geometry.prototypes.iter_mut().zip(of_prototypes) {
        prototype.cutouts = cutout.into_iter().collect();
    }
    Ok(used)
}

fn cutout(
    shape: &Shape,
    map: UvMap,
    found: &CutOut,
    image: Option<Arc<LazyImage>>,
    attributes: Option<&MeshAttributes>,
) -> Cutout {
    let mesh = attributes.and_then(|mesh| {
        let &MeshAttributes { first_triangle, first_position, ref uvs, ref alphas, .. } = mesh;
        let none = || alphas.as_ref().map(|_| Default::default());
        let uvs = uvs.clone().or_else(none)?;
        Some(MeshUvs { first_triangle, first_position, uvs, alphas: alphas.clone() })
    });
    Cutout {
        primitives: shape.primitives.clone(),
        threshold: found.threshold as f32,
        image,
        filter: found.look_up.as_ref().map_or(Filter::Nearest, |look_up| look_up.filter),
        wrap: found.look_up.as_ref().map_or(Wrap::Repeat, |look_up| look_up.wrap),
        map,
        placing: found.look_up.as_ref().and_then(|look_up| look_up.placing).map(placing),
        mesh,
    }
}

/// Points along each side of a triangle at which cut-outs are tried: leaves are not much smaller.
const TRIED: u32 = 32;

/// The triangles of a mesh of which a cut-out with one of these `images` leaves something, if not all.
/// Errors are reported when the scene is prepared.
pub(crate) fn left(mesh: &MeshData, found: &CutOut, images: &mut Masks) -> Option<Vec<[u32; 3]>> {
    images.add(found, "").ok()?;
    let image = images.of(found)?.image.get().ok()?;
    let &LookUp { filter, wrap, placing: change, .. } = found.look_up.as_ref()?;
    let shows = |uv: Vec2| {
        let uv = uv.to_array();
        let uv = change.map_or(uv, |change| placing(change).apply(uv));
        image.look_up(uv, filter, wrap).x >= found.threshold as f32
    };
    let uvs = mesh.uvs.as_ref()?;
    let is_left = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|i| uvs.values.get(i as usize).copied().unwrap_or_default());
        let share = |i: u32| i as f32 / TRIED as f32;
        let uv = |i, j| a + (b - a) * share(i) + (c - a) * share(j);
        (0..=TRIED).any(|i| (0..=TRIED - i).any(|j| shows(uv(i, j))))
    };
    let all =
        mesh.triangles.par_iter().zip(uvs.indices.as_ref().unwrap_or(&mesh.triangles).par_iter());
    let left: Vec<_> = all.filter(|(_, at)| is_left(at)).map(|(triangle, _)| *triangle).collect();
    (left.len() < mesh.triangles.len()).then_some(left)
}

/// The prototype of an instance, and its number of triangles.
fn prototype(geometry: &Geometry, shape: &Shape) -> Option<(usize, u32)> {
    let Primitive::Instanced(instanced) = geometry.primitive(shape.primitives.start) else {
        return None;
    };
    let (instance, prototype) = geometry.instance(instanced);
    Some((instance.prototype(), prototype.triangles.len() as u32))
}

/// The key of an image: its source, and whether brightness stands for alpha.
type ImageKey = (TextureSource, bool);

/// The images of cut-outs.
pub(crate) struct Masks<'a> {
    /// The scene's file, for messages.
    file: &'a Path,
    /// `None` for images without alpha.
    known: Vec<(ImageKey, Option<AlphaImage>)>,
}

struct AlphaImage {
    image: Arc<LazyImage>,
    /// The lowest and the highest alpha of its texels, from 0 to 1, once it is decoded.
    range: [f32; 2],
}

impl<'a> Masks<'a> {
    /// No images, of the scene in `file`.
    pub(crate) fn of_scene(file: &'a Path) -> Self {
        Self { file, known: Vec::new() }
    }

    /// Adds the image of a cut-out, after checking the header of its file.
    fn add(&mut self, found: &CutOut, place: &str) -> Result<()> {
        let Some(look_up) = found.look_up.clone() else { return Ok(()) };
        let look_up = LookUp { filter: Filter::Bilinear, ..look_up };
        let key = (look_up.source.clone(), found.is_mask);
        if self.known.iter().any(|(known, _)| *known == key) {
            return Ok(());
        }
        let head = Head::of(&look_up.source).map_err(|error| error.in_file(self.file).at(place))?;
        let mask = (head.has_alpha || found.is_mask).then(|| {
            let (encoding, channels) = (Encoding::Linear, Channels::Alpha);
            let texture = TextureRef { look_up, encoding, tint: DVec3::ONE, channels };
            let place = (self.file.to_owned(), place.to_owned());
            let image = lazy(texture, found.is_mask, None, place);
            AlphaImage { image: Arc::new(image), range: [0.0; 2] }
        });
        self.known.push((key, mask));
        Ok(())
    }

    /// Decodes all images, and finds their lowest and highest alpha.
    fn decode(&mut self) -> Result<()> {
        let masks = self.known.iter_mut().filter_map(|(_, m)| m.as_mut());
        let ranges = parallel::map(masks, |mask| {
            mask.range = range(mask.image.get()?, 0);
            Ok(())
        });
        // The first error in the order of the file.
        ranges.into_iter().collect()
    }

    fn of(&self, found: &CutOut) -> Option<&AlphaImage> {
        let wanted = &found.look_up.as_ref()?.source;
        let is_it = |(source, is_mask): &ImageKey| source == wanted && *is_mask == found.is_mask;
        self.known.iter().find(|(key, _)| is_it(key))?.1.as_ref()
    }

    /// Whether any look-up may give less alpha than the threshold.
    fn has_holes(&self, found: &CutOut) -> bool {
        let Some(AlphaImage { range: [lowest, highest], .. }) = self.of(found) else {
            return false;
        };
        // Between equal texels alpha is theirs. Between others three weighted means, with fewer
        // than 4 roundings each, may give less than the lowest.
        let rounding = if lowest == highest { 0.0 } else { 12.0 * UNIT_ROUNDOFF };
        lowest - rounding < found.threshold as f32
    }
}
