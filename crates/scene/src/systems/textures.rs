//! Textures: the images of shapes, each decoded once, at its first look-up. A scene without visible
//! textures opens no image.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec2, Vec3};
use image::DynamicImage;

use crate::components::{self, Channels, Encoding, LookUp, TextureRef, TextureSource};
use crate::image_file::{self, Head, content, decoded, of_texture, range, reading};
use wavecrest_base::error::Result;
use wavecrest_core::kernels::texture::{Filter, Image};
use wavecrest_core::prepared::{Coordinates, LazyImage, Placing, Texture, UvMap};

/// The images of a scene, each once.
pub(crate) struct Images {
    /// The scene's file, for messages.
    file: PathBuf,
    /// Each with the place in the scene file that names it first.
    all: Vec<(TextureRef, String)>,
    /// Their numbers.
    numbers: HashMap<TexelSource, u32>,
    /// Those that are decoded already, and whether their first channel is 1 in every texel.
    decoded: HashMap<TexelSource, (Image, bool)>,
}

/// What decides the texels of an image; the tint in bits.
type TexelSource = (TextureSource, Encoding, [u64; 3], Channels);

fn texel_source(TextureRef { look_up, encoding, tint, channels }: &TextureRef) -> TexelSource {
    (look_up.source.clone(), *encoding, tint.to_array().map(f64::to_bits), *channels)
}

impl Images {
    /// No images yet, of the scene in `file`.
    pub(crate) fn of_scene(file: &Path) -> Self {
        let (numbers, decoded) = (HashMap::new(), HashMap::new());
        Self { file: file.to_owned(), all: Vec::new(), numbers, decoded }
    }

    /// The texture of a `reference`, which is under a `key` of the shape at `place`, with texture
    /// coordinates from `map`.
    pub(crate) fn texture(
        &mut self,
        reference: &TextureRef,
        (place, key): (&str, &str),
        map: UvMap,
    ) -> Texture {
        let LookUp { wrap, placing: change, .. } = &reference.look_up;
        let filter = self.filter(reference);
        let number = *self.numbers.entry(texel_source(reference)).or_insert_with(|| {
            self.all.push((reference.clone(), format!("{place}.{key}")));
            self.all.len() as u32 - 1
        });
        if filter == Filter::Trilinear {
            self.all[number as usize].0.look_up.filter = filter;
        }
        let (wrap, placing) = (*wrap, change.map(placing));
        Texture { image: number, filter, wrap, coordinates: Coordinates { map, placing } }
    }

    /// The filter of a texture; the simplest where it is known to have one colour.
    pub(super) fn filter(&mut self, texture: &TextureRef) -> Filter {
        match texture.look_up.filter {
            Filter::Trilinear if self.only_color(texture, ("", "")).is_some() => Filter::Nearest,
            filter => filter,
        }
    }

    /// Whether the texture's first channel is 1 in every texel. It is decoded for that, and kept; if `color` is
    /// of the same file, both are decoded at once. It is under a `key` of the object at `place`.
    pub(super) fn is_one(
        &mut self,
        texture: &TextureRef,
        color: Option<&TextureRef>,
        place: (&str, &str),
    ) -> Result<bool> {
        Ok(self.decoded(texture, color, place)?.1)
    }

    /// The colour of a texture, if it is small and the same in every texel.
    pub(crate) fn only_color(
        &mut self,
        texture: &TextureRef,
        place: (&str, &str),
    ) -> Option<DVec3> {
        // An image that cannot be decoded is an error at its first look-up.
        Head::of(&texture.look_up.source).ok().filter(Head::is_small)?;
        let (image, _) = self.decoded(texture, None, place).ok()?;
        let ranges = [0, 1, 2].map(|channel| range(image, channel));
        let is_even = image.invalid == 0 && ranges.iter().all(|[low, high]| low == high);
        is_even.then(|| Vec3::from(ranges.map(|[value, _]| value)).as_dvec3())
    }

    /// A bound on the colours of a texture: of values that are no bytes, infinity, or if it is under a key of the
    /// object at a place, their largest.
    pub(super) fn brightest(
        &mut self,
        texture: &TextureRef,
        place: Option<(&str, &str)>,
    ) -> Result<DVec3> {
        if Head::of(&texture.look_up.source).is_ok_and(|head| head.is_bytes) {
            return Ok(texture.tint);
        }
        let Some(place) = place else { return Ok(DVec3::INFINITY) };
        let (image, _) = self.decoded(texture, None, place)?;
        Ok(Vec3::from([0, 1, 2].map(|channel| range(image, channel)[1])).as_dvec3())
    }

    /// The decoded image of a texture, and whether its first channel is 1 in every texel.
    fn decoded(
        &mut self,
        texture: &TextureRef,
        color: Option<&TextureRef>,
        (place, key): (&str, &str),
    ) -> Result<&(Image, bool)> {
        if !self.decoded.contains_key(&texel_source(texture)) {
            let source = &texture.look_up.source;
            let _reading = reading(source);
            let at = format!("{place}.{key}");
            let read = decoded(source).map_err(|error| error.in_file(&self.file).at(at))?;
            let mut keep = |texture: &TextureRef, read: DynamicImage| {
                let image = of_texture(read, texture, false);
                let is_one = range(&image, 0) == [1.0; 2];
                self.decoded.insert(texel_source(texture), (image, is_one));
            };
            if let Some(color) = color.filter(|color| color.look_up.source == *source) {
                keep(color, read.clone());
            }
            keep(texture, read);
        }
        Ok(&self.decoded[&texel_source(texture)])
    }

    /// Reads the headers of all images: each is decoded at its first look-up, with a pyramid if any
    /// shape uses it with the trilinear filter.
    pub(super) fn prepare(self) -> Result<Vec<LazyImage>> {
        let Self { file, all, mut decoded, .. } = self;
        let image = |(texture, place): (TextureRef, String)| {
            Head::of(&texture.look_up.source).map_err(|e| e.in_file(&file).at(&place))?;
            let known = decoded.remove(&texel_source(&texture)).map(|(image, _)| image);
            Ok(lazy(texture, false, known, (file.clone(), place)))
        };
        all.into_iter().map(image).collect()
    }
}

/// A change of coordinates in single precision.
pub(super) fn placing(components::Placing([u, v]): components::Placing) -> Placing {
    let vec2 = |x: f64, y: f64| Vec2::new(x as f32, y as f32);
    Placing { turned: [vec2(u[0], u[1]), vec2(v[0], v[1])], moved: vec2(u[2], v[2]) }
}

/// The image of a texture whose header has been checked, unless it is `decoded` already; in a mask, brightness
/// replaces missing alpha.
pub(super) fn lazy(
    texture: TextureRef,
    is_mask: bool,
    decoded: Option<Image>,
    (file, place): (PathBuf, String),
) -> LazyImage {
    let TextureRef { look_up: LookUp { source, filter, .. }, encoding, tint, channels } =
        texture.clone();
    let read = match channels {
        Channels::Color => format!("{encoding:?}{tint:?}{filter:?}"),
        Channels::Alpha => format!("{channels:?}{filter:?}"),
    };
    let name = source.name();
    let made_of = move || [content(&source), read.into()].concat();
    let decode = move || {
        let source = &texture.look_up.source;
        let _reading = reading(source);
        let read = || image_file::decoded(source).map(|read| of_texture(read, &texture, is_mask));
        let mut image = match decoded {
            Some(image) => image,
            None => read().map_err(|e| e.in_file(file).at(place))?,
        };
        if filter == Filter::Trilinear {
            image.build_pyramid();
        }
        Ok(image)
    };
    LazyImage::new(name, made_of, decode)
}
