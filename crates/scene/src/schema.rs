//! The content of a scene file as plain typed values, with every check that needs no other file.
//!
//! Components of entities are used here too where they have the same meaning, so that there is one
//! definition.

use std::path::{Path, PathBuf};

use glam::DAffine3;

use super::components::{
    AreaLight, CameraPath, CutOut, DirectionalLight, Encoding, Facing, Maps, Material, Materials,
    Mesh, Name, PointLight, Quad, Settings, Shading, Sides, Sphere, Spot, TextureRef,
    TextureSource, ThinLens, Transform, Triangle, VertexColors, View,
};

/// A whole scene, from a file of any format.
pub(crate) struct SceneFile {
    pub(crate) settings: Settings,
    pub(crate) camera: Camera,
    pub(crate) lights: Vec<Light>,
    pub(crate) shapes: Vec<Shape>,
    pub(crate) instances: Vec<Instance>,
    /// The transfer curve of 8-bit images, unless one is requested.
    pub(crate) encoding: Encoding,
}

/// The camera.
pub(crate) struct Camera {
    pub(crate) view: View,
    /// `None` for a pinhole.
    pub(crate) lens: Option<ThinLens>,
    /// `None` if it does not move.
    pub(crate) path: Option<CameraPath>,
}

/// An element of `scene.lightsources`.
pub(crate) enum Light {
    Point {
        path: String,
        light: PointLight,
    },
    Spot {
        path: String,
        light: PointLight,
        spot: Spot,
    },
    Directional {
        path: String,
        light: DirectionalLight,
    },
    Area {
        path: String,
        light: AreaLight,
        /// The emitting shape; its material and texture are ignored.
        shape: Box<Shape>,
    },
}

/// An element of `scene.shapes`, or the shape of an area light.
pub(crate) struct Shape {
    /// Its JSON path.
    pub(crate) path: String,
    pub(crate) name: Option<Name>,
    pub(crate) geometry: Geometry,
    pub(crate) facing: Option<Facing>,
    pub(crate) transform: Option<Transform>,
    pub(crate) sides: Sides,
    pub(crate) shading: Shading,
    /// The encoding of vertex colours in a mesh that is not read yet.
    pub(crate) vertex_colors: VertexColors,
    /// The source of its faces' materials.
    pub(crate) materials: Materials,
    /// Whether only its instances are visible.
    pub(crate) hidden: bool,
    /// `None` for an area light's shape.
    pub(crate) material: Option<Material>,
    pub(crate) texture: Option<TextureRef>,
    pub(crate) cutout: Option<CutOut>,
    pub(crate) maps: Maps,
}

impl Shape {
    /// A plain mesh: flat shading, visible from both sides.
    pub(crate) fn of(path: String, name: Option<String>, mesh: Mesh) -> Self {
        Self {
            path,
            name: name.map(Name),
            geometry: Geometry::Mesh(mesh),
            facing: None,
            transform: None,
            sides: Sides::Both,
            shading: Shading::Flat,
            vertex_colors: VertexColors::default(),
            materials: Materials::default(),
            hidden: false,
            material: None,
            texture: None,
            cutout: None,
            maps: Maps::default(),
        }
    }
}

impl Shape {
    /// A part of it, with its own material.
    pub(crate) fn part(
        &self,
        geometry: Geometry,
        name: Option<Name>,
        (material, texture, cutout): (Option<Material>, Option<TextureRef>, Option<CutOut>),
    ) -> Self {
        let (path, maps) = (self.path.clone(), self.maps.clone());
        Self { path, name, geometry, material, texture, maps, cutout, ..*self }
    }

    /// The files that it names.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        let mesh = match &self.geometry {
            Geometry::MeshFile(file) => Some(file),
            _ => None,
        };
        let textures = self.textures().map(|(_, texture)| &texture.source);
        let images = textures.chain(self.cutout.iter().map(|cutout| &cutout.source));
        let images = images.filter_map(|source| match source {
            TextureSource::File(file) => Some(file),
            TextureSource::Embedded { .. } => None,
        });
        mesh.into_iter().chain(images).map(PathBuf::as_path)
    }

    /// All its textures, with their keys.
    pub(crate) fn textures(&self) -> impl Iterator<Item = (&'static str, &TextureRef)> {
        self.texture.iter().map(|texture| ("texture", texture)).chain(self.maps.all())
    }
}

/// An element of `scene.instances`.
pub(crate) struct Instance {
    /// Its JSON path.
    pub(crate) path: String,
    pub(crate) name: Option<Name>,
    /// The index of its prototype among the shapes of the file.
    pub(crate) shape: usize,
    /// The transform from the space of its prototype to the world.
    pub(crate) transform: DAffine3,
    /// `None` for the shape's own.
    pub(crate) material: Option<Material>,
}

/// The geometry of a shape.
pub(crate) enum Geometry {
    Sphere(Sphere),
    Quad(Quad),
    Triangle(Triangle),
    /// A mesh that is read already.
    Mesh(Mesh),
    /// A mesh in a separate file, not read yet.
    MeshFile(PathBuf),
}
