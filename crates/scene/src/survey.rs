//! Surveys the contents of a scene before anything large is read, for the memory estimate.

use std::collections::{HashMap, HashSet};

use hecs::{Entity, EntityRef, World};

use super::components::{
    AreaLight, DirectionalLight, Environment, Filter, Hidden, InstanceOf, LookUp, Materials, Mesh,
    MeshFile, PointLight, Shading, Sky, TextureSource, ThinLens,
};
use super::format::Notes;
use super::lights::points;
use super::mesh::{self, MeshData};
use super::options::LoadOptions;
use super::query::{self, Pictured, textures_of};
use super::staging;
use wavecrest_base::error::{Error, Result};

/// The mesh of a shape.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SurveyedMesh {
    /// Its contents.
    pub holds: mesh::Survey,
    /// Whether normals are kept for smooth shading.
    pub normals: bool,
    /// Whether texture coordinates are kept for a texture.
    pub uvs: bool,
    /// Whether tangents are computed for a normal map.
    pub tangents: bool,
    /// The number of its places in the scene: its own, and its instances.
    pub uses: u64,
}

/// The contents of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    /// Bytes of the scene file.
    pub text: u64,
    /// Bytes of raw file content in memory while the scene is read.
    pub raw: u64,
    /// Its meshes, by shape, including those of lights.
    pub meshes: Vec<SurveyedMesh>,
    /// Triangles, quads and spheres inline in the scene file.
    pub others: u64,
    /// The images of its textures, trilinear if any use of it is.
    pub textures: HashMap<TextureSource, Filter>,
    /// The images of cut-outs.
    pub masks: HashSet<TextureSource>,
    /// For each image in use of a glTF file its bytes, and the additional bytes while it is
    /// decoded.
    pub embedded: Vec<[u64; 2]>,
    /// Additional bytes while normals are computed for a mesh without any.
    pub creasing: u64,
    /// Entries of `scene.instances`.
    pub instances: u64,
    /// The size of the image in pixels.
    pub size: [u32; 2],
    /// Camera rays for each pixel.
    pub rays_per_pixel: u64,
    /// Largest number of shadow rays for each hit.
    pub light_samples: u64,
    /// Largest number of bounces after the camera ray.
    pub bounces: u32,
}

/// The survey of a file that gets a camera and lights, and may have glass: without its contents.
pub(super) fn staged(options: &LoadOptions) -> Result<Survey> {
    let view = staging::view(options, None)?;
    Ok(Survey {
        size: [view.width, view.height],
        rays_per_pixel: view.rays(None),
        light_samples: staging::samples(),
        bounces: staging::GLASS_BOUNCES,
        ..Survey::default()
    })
}

/// Surveys a standalone mesh.
pub(super) fn standalone(mut holds: mesh::Survey, options: &LoadOptions) -> Result<Survey> {
    let mut survey = staged(options)?;
    if options.lighting.crease_degrees > 0.0 && holds.normals == 0 {
        // About as many as positions, unless every edge is a crease.
        (holds.normals, holds.normal_indices) = (holds.positions, true);
        survey.creasing = mesh::crease::bytes(holds.positions, holds.triangles);
    }
    // Only glass has rays wait, two at each bounce.
    if !holds.materials {
        survey.bounces = 0;
    }
    let mesh = SurveyedMesh { holds, normals: true, uvs: true, tangents: false, uses: 1 };
    survey.meshes.push(mesh);
    Ok(survey)
}

/// Surveys a world whose mesh files are not read yet, and whose scene file has `text` bytes.
pub(super) fn of(world: &World, text: u64, notes: &Notes<'_>) -> Result<Survey> {
    let (settings, view) = (query::settings(world)?, query::view(world)?);
    let mut uses: HashMap<Entity, u64> = HashMap::new();
    world.query::<&InstanceOf>().iter().for_each(|of| *uses.entry(of.0).or_default() += 1);
    let mut survey = Survey {
        text,
        instances: uses.values().sum(),
        size: [view.width, view.height],
        rays_per_pixel: view.rays(world.query::<&ThinLens>().iter().next()),
        bounces: settings.bounces,
        ..Survey::default()
    };
    for shape in query::shapes(world) {
        let own = u64::from(!shape.has::<Hidden>());
        survey.add(shape, own + uses.get(&shape.entity()).unwrap_or(&0), notes)?;
    }
    let mut around = world.query::<Pictured<'_>>().with::<&Environment>();
    around.iter().for_each(|pictured| survey.add_images(pictured));
    survey.light_samples = world.query::<&PointLight>().iter().count() as u64;
    let mut all = world.query::<&DirectionalLight>();
    survey.light_samples +=
        all.iter().map(|light| points(light.sampling, light.samples)).sum::<u64>();
    let mut all = world.query::<&Sky>();
    survey.light_samples += all.iter().map(|sky| points(sky.sampling, sky.samples)).sum::<u64>();
    for light in query::ordered::<&AreaLight>(world) {
        let points = light.get::<&AreaLight>().map(|l| points(l.sampling, l.samples));
        survey.light_samples += points.unwrap_or(0);
        survey.add(light, 1, notes)?;
    }
    Ok(survey)
}

/// What a survey looks at in a shape.
type Surveyed<'w> = (Option<&'w Mesh>, Option<&'w MeshFile>, Option<&'w Shading>, Pictured<'w>);

impl Survey {
    fn add(&mut self, shape: EntityRef<'_>, uses: u64, notes: &Notes<'_>) -> Result<()> {
        let mut found = shape.query::<Surveyed<'_>>();
        let Ok((mesh, file, shading, pictured)) = found.get() else { return Ok(()) };
        if uses == 0 {
            return Ok(());
        }
        self.add_images(pictured);
        let holds = match (mesh, file) {
            (Some(mesh), _) => of_mesh(&mesh.data),
            (None, Some(file)) => mesh::survey(&file.file)
                .map_err(|cause| error_of(cause, &query::place_of(shape), notes))?,
            (None, None) => {
                self.others += uses;
                return Ok(());
            }
        };
        let normals = shading.is_some_and(|shading| *shading == Shading::Smooth);
        let (texture, maps, _, cutout) = pictured;
        let uvs = texture.is_some()
            || maps.is_some()
            || cutout.is_some()
            || file.is_some_and(|file| file.materials == Materials::File);
        let tangents = maps.is_some_and(|maps| maps.normal.is_some());
        self.meshes.push(SurveyedMesh { holds, normals, uvs, tangents, uses });
        Ok(())
    }

    fn add_images(&mut self, pictured: Pictured<'_>) {
        for texture in textures_of(pictured) {
            let LookUp { source, filter, .. } = &texture.look_up;
            let known = self.textures.entry(source.clone()).or_insert(*filter);
            if *filter == Filter::Trilinear {
                *known = *filter;
            }
        }
        self.masks.extend(pictured.3.map(|cutout| cutout.look_up.source.clone()));
    }
}

/// The error of a mesh reader, prefixed with the place in the scene that names the mesh.
pub(crate) fn error_of(cause: Error, place: &str, notes: &Notes<'_>) -> Error {
    let message = format!("cannot read the mesh: {cause}");
    notes.error(cause.kind(), &format!("{place}.file"), message).because(cause)
}

/// The contents of a mesh in memory.
pub(super) fn of_mesh(data: &MeshData) -> mesh::Survey {
    mesh::Survey {
        positions: data.positions.len() as u64,
        triangles: data.triangles.len() as u64,
        normals: data.normals.as_ref().map_or(0, |n| n.values.len() as u64),
        uvs: data.uvs.as_ref().map_or(0, |uv| uv.values.len() as u64),
        normal_indices: data.normals.as_ref().is_some_and(|n| n.indices.is_some()),
        colors: data.colors.as_ref().map_or(0, |colors| colors.len() as u64),
        uv_indices: data.uvs.as_ref().is_some_and(|uv| uv.indices.is_some()),
        materials: false,
    }
}
