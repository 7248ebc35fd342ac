//! Placement: shapes where they are shown, of their own or as instances of another's.

use glam::{DAffine3, DMat3, DVec3, Vec3};
use hecs::{Entity, Satisfies, World};

use super::surface::{SurfaceColumns, SurfaceComponents};
use super::visibility::{Shows, Visibility};
use crate::components::{
    Channels, Disk, Facing, Hidden, InstanceOf, Map, Material, Mesh, Order, Quad, Shading, Sides,
    Sphere, TextureRef, Transform, Transparency, Triangle,
};
use crate::corners::{quad_normal, triangle_normal};
use crate::image_file::Head;
use crate::mesh::MAX_COUNT;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::kernels::slab::Aabb;
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_core::prepared::Shape;

/// The geometry of a shape in its own space.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ShapeGeometry {
    Sphere(Sphere),
    Disk(Disk),
    Quad(Quad),
    Triangle(Triangle),
    /// The mesh is the prototype's entity's.
    Mesh,
}

impl ShapeGeometry {
    /// The number of its kind in the order of primitives: triangles, quads, and quadrics.
    pub(super) fn kind(&self) -> u8 {
        match self {
            Self::Triangle(_) | Self::Mesh => 0,
            Self::Quad(_) => 1,
            Self::Sphere(_) | Self::Disk(_) => 2,
        }
    }
}

/// A shape, possibly of a light, as it is shown.
#[derive(Clone, Debug)]
pub(crate) struct ShapeInstance {
    /// The shape, or the instance.
    pub(crate) entity: Entity,
    /// The entity with the geometry: the same except for instances.
    pub(crate) prototype: Entity,
    pub(crate) geometry: ShapeGeometry,
    /// The shape in the arrays, without primitives yet.
    pub(crate) shape: Shape,
    pub(crate) visibility: Visibility,
    /// Whether it may have holes.
    pub(crate) is_cut_out: bool,
    pub(crate) transform: DAffine3,
    /// The box around it, with the factor on the error of rays near it, once it is found.
    pub(crate) bounds: Aabb,
    pub(crate) widening: f32,
    /// Whether it asks for the normals of its mesh, and for texture coordinates.
    pub(super) smooth: bool,
    pub(super) textured: bool,
    /// Whether it has a normal map.
    pub(crate) normal_mapped: bool,
    pub(crate) place: String,
}

/// What a shape or an instance has of its own, besides its surface.
type InstanceComponents<'w> = (
    Entity,
    Option<&'w Order>,
    Option<&'w InstanceOf>,
    Satisfies<&'w Hidden>,
    Option<&'w Transform>,
    Option<&'w Sides>,
    Option<&'w Shading>,
);

/// The geometry of a prototype.
type PrototypeComponents<'w> = (
    Option<&'w Sphere>,
    Option<&'w Disk>,
    Option<&'w Quad>,
    Option<&'w Triangle>,
    Satisfies<&'w Mesh>,
    Option<&'w Transform>,
    Option<&'w Facing>,
);

/// What is shown, in the order of the file, shapes before those of lights, moved by `-origin`. Of what
/// all light passes nothing is shown.
pub(crate) fn run(world: &World, origin: DVec3) -> Vec<ShapeInstance> {
    let prototypes = world.view::<PrototypeComponents<'_>>();
    let mut all: Vec<(Order, ShapeInstance)> = Vec::new();
    let surfaces = world.view::<SurfaceColumns<'_>>();
    let has_media = world.query::<&Transparency>().iter().any(Transparency::is_medium);
    for (entity, order, of, is_hidden, own, sides, shading) in
        world.query::<InstanceComponents<'_>>().iter()
    {
        let surface = SurfaceComponents::of(&surfaces, entity);
        let SurfaceComponents { light, transparency, texture, maps, cut_out, place, .. } = surface;
        let is_clear = |through: &Transparency| through.is_clear(surface.is_black(), has_media);
        if transparency.is_some_and(is_clear) || is_hidden && of.is_none() {
            continue;
        }
        let prototype = of.map_or(entity, |InstanceOf(prototype)| *prototype);
        let (sphere, disk, quad, triangle, is_mesh, of_prototype, facing) =
            prototypes.get(prototype).unwrap_or_default();
        let geometry = (sphere.copied().map(ShapeGeometry::Sphere))
            .or(disk.copied().map(ShapeGeometry::Disk))
            .or(quad.copied().map(ShapeGeometry::Quad))
            .or(triangle.copied().map(ShapeGeometry::Triangle))
            .or(is_mesh.then_some(ShapeGeometry::Mesh));
        let Some(geometry) = geometry else { continue };
        let matrix = |transform: Option<&Transform>| transform.map_or(DAffine3::IDENTITY, |t| t.0);
        let mut transform = matrix(own);
        if of.is_some() {
            transform *= matrix(of_prototype);
        }
        transform.translation -= origin;
        let is_surface = light.is_none();
        let visibility = Visibility {
            is_seen: true,
            is_met: true,
            is_transparent: may_be_transparent(&surface),
            is_mirror: true,
            is_surface,
            faces: None,
            is_lit: false,
            shows: Shows::default(),
            is_trilinear: false,
            has_holes: false,
        };
        let instance = ShapeInstance {
            entity,
            prototype,
            geometry,
            shape: Shape {
                light: light.map(|light| light.color.as_vec3()),
                flipped: is_flipped(&geometry, facing, &transform),
                two_sided: sides.is_none_or(|sides| *sides == Sides::Both),
                ..Shape::default()
            },
            visibility,
            is_cut_out: cut_out.is_some(),
            transform,
            bounds: Aabb::EMPTY,
            widening: 1.0,
            smooth: is_surface && shading == Some(&Shading::Smooth),
            textured: texture.is_some() || cut_out.is_some() || maps.all().next().is_some(),
            normal_mapped: maps.normal.as_ref().is_some_and(Map::has_effect),
            place: place.to_owned(),
        };
        all.push((order.copied().unwrap_or(Order(u32::MAX)), instance));
    }
    all.sort_by_key(|(order, instance)| (instance.shape.light.is_some(), *order));
    all.into_iter().map(|(_, instance)| instance).collect()
}

/// Whether light may go through a surface, as far as the headers of images tell, or paths are split there all the
/// same: at a faint mirror.
pub(crate) fn may_be_transparent(surface: &SurfaceComponents<'_>) -> bool {
    // A header that cannot be read is reported when the scene is prepared.
    let may_vary = |texture: &TextureRef| {
        texture.channels == Channels::Color
            || Head::of(&texture.look_up.source).map_or(true, |head| head.has_alpha)
    };
    let opacity = surface.maps.opacity.as_ref().and_then(|map| map.texture.as_ref());
    surface.transparency.is_some_and(Transparency::has_effect)
        || surface.material.is_some_and(Material::is_faint_mirror)
        || opacity.is_some_and(may_vary)
}

/// Whether the front of a flat shape is where its corners run clockwise in world space. Meshes are flipped by
/// transforms that mirror them.
fn is_flipped(geometry: &ShapeGeometry, facing: Option<&Facing>, to_world: &DAffine3) -> bool {
    let mirrors = to_world.matrix3.determinant() < 0.0;
    let front = match geometry {
        ShapeGeometry::Sphere(_) | ShapeGeometry::Disk(_) => return false,
        ShapeGeometry::Mesh => return mirrors,
        ShapeGeometry::Quad(quad) => quad_normal(&quad.points),
        ShapeGeometry::Triangle(triangle) => triangle_normal(&triangle.points),
    };
    let chosen = match facing {
        None => true,
        Some(Facing::Flipped) => false,
        Some(Facing::Toward(side)) => front.dot(*side) >= 0.0,
    };
    chosen != mirrors
}

/// The circle around a sphere or a disk, in world space.
pub(crate) struct Circle {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
    /// The rotation, possibly with a reflection, from its own space.
    pub(crate) turn: DMat3,
}

impl ShapeInstance {
    pub(super) fn is_mesh(&self) -> bool {
        matches!(self.geometry, ShapeGeometry::Mesh)
    }

    pub(super) fn is_of_light(&self) -> bool {
        self.shape.light.is_some()
    }

    /// Whether shadow rays pass it, as a shape of a light or with less light.
    pub(super) fn is_passed(&self) -> bool {
        self.visibility.is_transparent || self.is_of_light()
    }

    /// A `shape` around `center` in world space.
    ///
    /// # Errors
    /// If it is too far away for single precision, or its radius is too small. Boxes of too large
    /// ones would have infinite area and make the tree's costs meaningless.
    pub(super) fn circle(&self, shape: &str, center: DVec3, radius: f64) -> Result<Circle> {
        let center = self.transform.transform_point3(center);
        let turn = self.transform.matrix3;
        let scale = turn.x_axis.length();
        let size = radius * scale;
        self.check_point(center)?;
        if size > f64::from(MAX_COORDINATE) {
            let message = format!("the transform makes the {shape} too large");
            return Err(Error::new(ErrorKind::Scene, message)
                .at(format!("{}.transform", self.place))
                .value(format!("a radius of {size:e}"))
                .remedy(format!("keep it within {MAX_COORDINATE:e}")));
        }
        if size as f32 == 0.0 {
            let message = "the radius is too small for single precision";
            return Err(Error::new(ErrorKind::Scene, message)
                .at(format!("{}.radius", self.place))
                .value(size)
                .remedy("use a larger unit of length"));
        }
        let turn = turn * (1.0 / scale);
        Ok(Circle { center: center.as_vec3(), radius: size as f32, turn })
    }

    pub(super) fn check_point(&self, point: DVec3) -> Result<()> {
        if in_range(point) {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Scene, "the transform moves the shape too far away")
            .at(format!("{}.transform", self.place))
            .value(format!("a coordinate of {:e}", point.abs().max_element()))
            .remedy(format!("keep coordinates within {MAX_COORDINATE:e}")))
    }

    pub(super) fn check_count(&self, count: usize, what: &str) -> Result<()> {
        if count as u64 <= MAX_COUNT {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Limit, format!("the scene has too many {what}"))
            .at(&self.place)
            .value(count)
            .remedy(format!("at most {MAX_COUNT} are allowed")))
    }
}

pub(super) fn in_range(point: DVec3) -> bool {
    point.abs().max_element() <= f64::from(MAX_COORDINATE)
}
