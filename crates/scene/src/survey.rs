//! What is known of a scene before a mesh or a texture is read, for the memory estimate: sizes of files, headers, counts.

use std::collections::{HashMap, HashSet};

use hecs::{Entity, EntityRef, World};

use super::components::{
    AreaLight, Channels, Filter, Hidden, InstanceOf, Materials, Mesh, MeshFile, TextureSource, View,
};
use super::format::Notes;
use super::image_file;
use super::mesh;
use super::options::LoadOptions;
use super::query::{self, Pictured, textures_of};
use super::staging;
use super::surface::{SurfaceColumns, SurfaceComponents};
use super::systems::placement;
use wavecrest_base::error::Result;

/// The contents of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    /// Bytes in memory while the scene is read, beside its meshes: its files and their values.
    pub reading: u64,
    /// All meshes, as often as they are stored. A sphere or a quad counts as a triangle.
    pub meshes: mesh::MeshSurvey,
    /// Bytes of each image, and the additional bytes while it is decoded.
    pub images: Vec<[u64; 2]>,
    /// The size of the image in pixels.
    pub size: [u32; 2],
    /// Largest number of bounces after the camera ray, from which rays wait; 0 if none do.
    pub bounces: u32,
}

/// Measured bytes that a comma, a colon or the start of a list or an object in JSON stands for while it is read.
const JSON_BYTES: u64 = 110;

impl Survey {
    /// The survey of a scene without contents.
    pub(super) fn new(view: &View, bounces: u32) -> Self {
        Self { size: [view.width, view.height], bounces, ..Self::default() }
    }

    /// Adds the JSON of the scene.
    pub(super) fn add_json(&mut self, text: &[u8]) {
        let values = text.iter().filter(|byte| b",:[{".contains(byte)).count();
        self.reading += text.len() as u64 + JSON_BYTES * values as u64;
    }

    /// Adds a shape of which so many are seen, each copied if the scene will be `flat`.
    pub(super) fn add(&mut self, holds: mesh::MeshSurvey, uses: u64, flat: bool) {
        self.meshes = self.meshes.plus(holds, if flat { uses } else { uses.min(1) });
    }

    /// Adds images, of which these channels are looked up.
    pub(super) fn add_images(&mut self, images: impl Iterator<Item = Pictures>) {
        self.images
            .extend(images.map(|(source, filter, of)| image_file::survey(&source, filter, of)));
    }
}

/// The source of an image, and how it is looked up.
type Pictures = (TextureSource, Filter, Channels);

/// Surveys a standalone mesh, which may get normals.
pub(super) fn standalone(holds: mesh::MeshSurvey, options: &LoadOptions) -> Result<Survey> {
    let mut survey = Survey::new(&staging::view(options, None)?, staging::GLASS_BOUNCES);
    let attributes = holds.attributes + mesh::TRIPLE * holds.positions;
    survey.add(mesh::MeshSurvey { attributes, ..holds }, 1, false);
    Ok(survey)
}

/// Surveys a world whose mesh files are not read yet, with the text of its scene file.
pub(super) fn of(world: &World, text: &str, flat: bool, notes: &Notes<'_>) -> Result<Survey> {
    let surfaces = world.view::<SurfaceColumns<'_>>();
    let may_be_transparent = |entity: EntityRef<'_>| {
        let brings = |file: &MeshFile| file.materials == Materials::File;
        entity.get::<&MeshFile>().is_some_and(|file| brings(&file))
            || placement::may_be_transparent(&SurfaceComponents::of(&surfaces, entity.entity()))
    };
    // Rays wait at transparent surfaces alone.
    let is_transparent = world.iter().any(may_be_transparent);
    let bounces = if is_transparent { query::settings(world)?.bounces } else { 0 };
    let mut survey = Survey::new(&query::view(world)?, bounces);
    survey.add_json(text.as_bytes());
    let mut instances: HashMap<Entity, u64> = HashMap::new();
    world.query::<&InstanceOf>().iter().for_each(|of| *instances.entry(of.0).or_default() += 1);
    for shape in query::shapes(world).into_iter().chain(query::ordered::<&AreaLight>(world)) {
        let own = u64::from(!shape.has::<Hidden>());
        let uses = own + instances.get(&shape.entity()).unwrap_or(&0);
        // The mesh of a hidden shape without instances is not read.
        if uses > 0 {
            survey.add(holds(shape, notes)?, uses, flat);
        }
    }
    let mut pictured = world.query::<Pictured<'_>>();
    let images: HashSet<_> = pictured.iter().flat_map(pictures).collect();
    survey.add_images(images.into_iter());
    Ok(survey)
}

/// The contents of a shape.
fn holds(shape: EntityRef<'_>, notes: &Notes<'_>) -> Result<mesh::MeshSurvey> {
    match (shape.get::<&Mesh>(), shape.get::<&MeshFile>()) {
        (Some(mesh), _) => Ok(mesh::MeshSurvey::of(&mesh.data)),
        (None, Some(file)) => mesh::survey(&file.file)
            .map_err(|cause| notes.mesh_error(cause, &query::place_of(shape))),
        (None, None) => Ok(mesh::MeshSurvey { triangles: 1, ..mesh::MeshSurvey::default() }),
    }
}

/// The images of a shape or the environment.
fn pictures(of: Pictured<'_>) -> Vec<Pictures> {
    let textures = textures_of(of).map(|texture| (&texture.look_up, Channels::Color));
    let cut_out = of.3.and_then(|cutout| cutout.look_up.as_ref());
    let all = textures.chain(cut_out.map(|look_up| (look_up, Channels::Alpha)));
    all.map(|(look_up, channels)| (look_up.source.clone(), look_up.filter, channels)).collect()
}
