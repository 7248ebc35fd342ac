//! Surveys the contents of a scene before anything large is read, for the memory estimate.

use super::components::{CutOut, Filter, Materials, Sampling, Shading, TextureRef, TextureSource};
use super::load::staging;
use super::mesh::{self, MeshData};
use super::reader::Notes;
use super::schema::{Geometry, Light, SceneFile, Shape};
use wavecrest_base::error::Result;

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
    /// Its textures, each once, trilinear if any use of it is.
    pub textures: Vec<TextureRef>,
    /// The images of cut-outs, each once.
    pub masks: Vec<TextureSource>,
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
    /// Whether there are mirror bounces.
    pub bounces: bool,
}

/// Surveys a standalone mesh, for an image of this size; `is_smoothed` if it gets normals when it
/// has none.
pub(super) fn standalone(mut holds: mesh::Survey, size: [u32; 2], is_smoothed: bool) -> Survey {
    let mut creasing = 0;
    if is_smoothed && holds.normals == 0 {
        // About as many as positions, unless every edge is a crease.
        (holds.normals, holds.normal_indices) = (holds.positions, true);
        creasing = mesh::crease::bytes(holds.positions, holds.triangles);
    }
    let mesh = SurveyedMesh { holds, normals: true, uvs: true, tangents: false, uses: 1 };
    let (rays_per_pixel, light_samples) = (staging::rays_per_pixel(), staging::samples());
    let meshes = vec![mesh];
    Survey { meshes, size, rays_per_pixel, light_samples, creasing, ..Survey::default() }
}

/// Surveys `scene`, whose file has `text` bytes.
pub(super) fn of(scene: SceneFile, text: u64, notes: &Notes<'_>) -> Result<Survey> {
    let view = scene.camera.view;
    let on_lens = scene.camera.lens.map_or(1, |l| u64::from(l.samples_x) * u64::from(l.samples_y));
    let mut survey = Survey {
        text,
        instances: scene.instances.len() as u64,
        size: [view.width, view.height],
        rays_per_pixel: u64::from(view.antialias).pow(2).saturating_mul(on_lens),
        bounces: scene.settings.bounces > 0,
        ..Survey::default()
    };
    let mut uses: Vec<u64> = scene.shapes.iter().map(|shape| u64::from(!shape.hidden)).collect();
    scene.instances.iter().for_each(|instance| uses[instance.shape] += 1);
    for (shape, uses) in scene.shapes.iter().zip(uses).filter(|(_, uses)| *uses > 0) {
        survey.add(shape, uses, notes)?;
    }
    for light in &scene.lights {
        match light {
            Light::Point { .. } | Light::Spot { .. } => survey.light_samples += 1,
            Light::Directional { light, .. } => {
                survey.light_samples += points(light.sampling, light.samples);
            }
            Light::Area { light, shape, .. } => {
                survey.light_samples += points(light.sampling, light.samples);
                survey.add(shape, 1, notes)?;
            }
        }
    }
    Ok(survey)
}

/// Number of points on a light with this value of `samples`.
fn points(sampling: Sampling, samples: u32) -> u64 {
    let side = u64::from(samples);
    if sampling == Sampling::Jittered { side * side } else { side }
}

impl Survey {
    fn add(&mut self, shape: &Shape, uses: u64, notes: &Notes<'_>) -> Result<()> {
        let holds = match &shape.geometry {
            Geometry::Sphere(_) | Geometry::Quad(_) | Geometry::Triangle(_) => {
                self.others += uses;
                self.add_texture(shape);
                return Ok(());
            }
            Geometry::Mesh(mesh) => of_mesh(&mesh.data),
            Geometry::MeshFile(file) => mesh::survey(file).map_err(|cause| {
                let message = format!("cannot read the mesh: {cause}");
                notes.error(cause.kind(), &format!("{}.file", shape.path), message).because(cause)
            })?,
        };
        let wears_some = shape.textures().next().is_some()
            || shape.cutout.is_some()
            || shape.materials == Materials::File;
        let (normals, uvs) = (shape.shading == Shading::Smooth, wears_some);
        let tangents = shape.maps.normal.is_some();
        self.meshes.push(SurveyedMesh { holds, normals, uvs, tangents, uses });
        self.add_texture(shape);
        Ok(())
    }

    fn add_texture(&mut self, shape: &Shape) {
        for (_, texture) in shape.textures() {
            match self.textures.iter_mut().find(|known| known.source == texture.source) {
                Some(known) if texture.filter == Filter::Trilinear => known.filter = texture.filter,
                Some(_) => {}
                None => self.textures.push(texture.clone()),
            }
        }
        if let Some(CutOut { source, .. }) = &shape.cutout
            && !self.masks.contains(source)
        {
            self.masks.push(source.clone());
        }
    }
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
    }
}
