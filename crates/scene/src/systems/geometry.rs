//! Geometry: shapes become primitives in world space, in one set of arrays.
//!
//! Shapes keep the order of the file within their kind, and shapes of lights come after the rest.
//! Meshes are moved, not copied: the first one's arrays become the scene's, are lengthened once, and
//! take the others in, each of which is dropped before the next is looked at. A mesh that is shown more than
//! once stays by itself, for instances ([`prototypes`]).

mod meshes;
mod prototypes;

use glam::{DAffine3, DVec3, Mat3, Vec3};
use hecs::{Entity, World};

use crate::components::{
    AreaLight, Facing, JsonPath, Quad, Shading, Sides, Sphere, TextureRef, Transform, Triangle,
};
use crate::corners;
use crate::mesh::{Attribute, MeshData};
use meshes::{Room, append, transform_mesh};
use prototypes::{Occurrence, Occurrences};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_core::accel::geometry::Geometry;
use wavecrest_core::kernels::texture::PlanarMap;
use wavecrest_core::math::float::MAX_COORDINATE;
use wavecrest_core::plan::schedule::{Schedule, Step};
use wavecrest_core::prepared::{CornerValues, MeshAttributes, Shape, UvMap};

/// Numbers of primitives and vertices stay below this, so that they fit 32 bits and leave one
/// value for "none".
const MAX_NUMBER: usize = u32::MAX as usize - 1;

/// A shape, and the entity it was.
#[derive(Debug)]
pub struct ShapeOutput {
    /// The entity.
    pub entity: Entity,
    /// The shape.
    pub shape: Shape,
    /// How its points become texture coordinates, should it wear a texture.
    pub uv_map: Option<UvMap>,
}

/// What this system makes.
#[derive(Debug)]
pub struct Output {
    /// The primitives.
    pub geometry: Geometry,
    /// The shapes, by the number of their first primitive.
    pub shapes: Vec<ShapeOutput>,
    /// Attributes of meshes.
    pub meshes: Vec<MeshAttributes>,
}

impl Output {
    /// Drops what the schedule has nobody look at: normals, and texture coordinates of shapes whose
    /// texture was not decoded.
    pub(super) fn drop_unused(&mut self, schedule: Schedule) {
        let normals = schedule.runs(Step::Normals);
        let mut textured = vec![false; self.meshes.len()];
        for ShapeOutput { shape, .. } in &mut self.shapes {
            shape.smooth &= normals;
            if let Some(mesh) = shape.mesh.and_then(|i| textured.get_mut(i as usize)) {
                *mesh |= shape.texture.is_some();
            }
        }
        for (mesh, textured) in self.meshes.iter_mut().zip(textured) {
            mesh.normals = mesh.normals.take().filter(|_| normals);
            mesh.uvs = mesh.uvs.take().filter(|_| textured);
        }
    }
}

/// Turns every shape into primitives, and moves all by `-origin`. Meshes that are shown more than once are
/// held once, unless all is to be `flat`.
pub fn run(world: &mut World, origin: DVec3, flat: bool) -> Result<Output> {
    let mut occurrences = Occurrences::of(world, flat);
    let room = Room::of(world, &occurrences);
    let mut builder = Builder { origin, room, ..Builder::default() };
    for occurrence in occurrences.triangles(world) {
        builder.add_triangles(world, occurrence, &mut occurrences)?;
    }
    for occurrence in occurrences.quads(world) {
        builder.add_quad(world, occurrence)?;
    }
    for occurrence in occurrences.spheres(world) {
        builder.add_sphere(world, occurrence)?;
    }
    builder.add_instances(world, &mut occurrences)?;
    Ok(builder.finish())
}

#[derive(Default)]
struct Builder {
    origin: DVec3,
    room: Room,
    geometry: Geometry,
    shapes: Vec<ShapeOutput>,
    meshes: Vec<MeshAttributes>,
}

/// What every kind of shape is asked for.
struct Common {
    transform: DAffine3,
    facing: Option<Facing>,
    sides: Sides,
    smooth: bool,
    textured: bool,
    emission: Option<Vec3>,
    place: String,
}

impl Common {
    fn of(world: &World, Occurrence { entity, prototype, .. }: Occurrence, origin: DVec3) -> Self {
        let light = world.get::<&AreaLight>(entity).ok();
        let is_shape = light.is_none();
        let mut transform = world.get::<&Transform>(entity).map_or(DAffine3::IDENTITY, |t| t.0);
        transform.translation -= origin;
        Self {
            transform,
            facing: world.get::<&Facing>(prototype).ok().map(|f| *f),
            sides: world.get::<&Sides>(entity).map_or(Sides::Both, |s| *s),
            smooth: is_shape && world.get::<&Shading>(entity).is_ok_and(|s| *s == Shading::Smooth),
            textured: is_shape && world.get::<&TextureRef>(entity).is_ok(),
            emission: light.map(|l| super::single(l.color)),
            place: world.get::<&JsonPath>(entity).map_or_else(|_| String::new(), |p| p.0.clone()),
        }
    }

    /// Whether the front of a flat shape is where its corners run clockwise in world space, given
    /// the normal on its front in its own space.
    fn flipped(&self, front: DVec3) -> bool {
        let chosen = match self.facing {
            None => true,
            Some(Facing::Flipped) => false,
            Some(Facing::Toward(side)) => front.dot(side) >= 0.0,
        };
        chosen != self.mirrors()
    }

    /// Whether the transform turns clockwise into counter-clockwise.
    fn mirrors(&self) -> bool {
        self.transform.matrix3.determinant() < 0.0
    }

    fn shape(&self, primitives: std::ops::Range<u32>, flipped: bool) -> Shape {
        Shape {
            primitives,
            emission: self.emission,
            flipped,
            two_sided: self.sides == Sides::Both,
            smooth: false,
            texture: None,
            mesh: None,
        }
    }
}

impl Builder {
    fn common(&self, world: &World, occurrence: Occurrence) -> Common {
        Common::of(world, occurrence, self.origin)
    }

    fn add_triangles(
        &mut self,
        world: &World,
        occurrence: Occurrence,
        occurrences: &mut Occurrences,
    ) -> Result<()> {
        let common = self.common(world, occurrence);
        if let Ok(triangle) = world.get::<&Triangle>(occurrence.prototype) {
            return self.add_triangle(occurrence.entity, &common, &triangle.points);
        }
        self.add_mesh(occurrence.entity, &common, occurrences.take(world, occurrence.prototype))
    }

    fn add_triangle(&mut self, entity: Entity, common: &Common, points: &[DVec3; 3]) -> Result<()> {
        let start = self.geometry.triangles.len() as u32;
        let first = self.add_points(common, points)?;
        let [p0, p1, p2] = self.geometry.positions[first as usize..] else { return Ok(()) };
        self.geometry.triangles.push([first, first + 1, first + 2]);
        let flipped = common.flipped(corners::triangle_normal(points));
        self.shapes.push(ShapeOutput {
            entity,
            shape: common.shape(start..start + 1, flipped),
            uv_map: Some(UvMap::Planar(PlanarMap::new(p0, p2 - p0, p1 - p0))),
        });
        Ok(())
    }

    fn add_mesh(&mut self, entity: Entity, common: &Common, mut mesh: MeshData) -> Result<()> {
        // What nothing will read is dropped before there is more to hold.
        mesh.normals = mesh.normals.filter(|_| common.smooth);
        mesh.uvs = mesh.uvs.filter(|_| common.textured);
        transform_mesh(&mut mesh, common)?;
        let geometry = &mut self.geometry;
        let first_position = geometry.positions.len();
        let first_triangle = geometry.triangles.len();
        check_count(common, first_position + mesh.positions.len(), "vertices")?;
        check_count(common, first_triangle + mesh.triangles.len(), "triangles")?;
        // As just checked, all numbers fit.
        let before = first_position as u32;
        let Room { positions, triangles } = self.room;
        append(&mut geometry.positions, mesh.positions, positions, before, |p, _| p);
        append(&mut geometry.triangles, mesh.triangles, triangles, before, |t, before| {
            t.map(|v| v + before)
        });
        let smooth = mesh.normals.is_some();
        let range = first_triangle as u32..self.geometry.triangles.len() as u32;
        let mut shape = Shape { smooth, ..common.shape(range, common.mirrors()) };
        if smooth || common.textured {
            shape.mesh = Some(self.meshes.len() as u32);
            self.meshes.push(MeshAttributes {
                first_triangle: first_triangle as u32,
                first_position: first_position as u32,
                normals: mesh.normals.map(corner_values),
                uvs: mesh.uvs.map(corner_values),
            });
        }
        self.shapes.push(ShapeOutput { entity, shape, uv_map: Some(UvMap::Mesh) });
        Ok(())
    }

    fn add_quad(&mut self, world: &World, occurrence: Occurrence) -> Result<()> {
        let common = self.common(world, occurrence);
        let Ok(points) = world.get::<&Quad>(occurrence.prototype).map(|q| q.points) else {
            return Ok(());
        };
        let number = (self.geometry.triangles.len() + self.geometry.quads.len()) as u32;
        let first = self.add_points(&common, &points)?;
        let [p0, p1, _, p3] = self.geometry.positions[first as usize..] else { return Ok(()) };
        let turn = first_of_diagonal(&points);
        self.geometry.quads.push([0, 1, 2, 3].map(|k| first + (k + turn) % 4));
        let flipped = common.flipped(corners::quad_normal(&points));
        self.shapes.push(ShapeOutput {
            entity: occurrence.entity,
            shape: common.shape(number..number + 1, flipped),
            uv_map: Some(UvMap::Planar(PlanarMap::new(p0, p3 - p0, p1 - p0))),
        });
        Ok(())
    }

    fn add_sphere(&mut self, world: &World, occurrence: Occurrence) -> Result<()> {
        let common = self.common(world, occurrence);
        let Ok(sphere) = world.get::<&Sphere>(occurrence.prototype).map(|s| *s) else {
            return Ok(());
        };
        let center = common.transform.transform_point3(sphere.center);
        let turn = common.transform.matrix3;
        let scale = turn.x_axis.length();
        let radius = (sphere.radius * scale) as f32;
        check_point(&common, center)?;
        check_radius(&common, sphere.radius * scale)?;
        if radius == 0.0 {
            return Err(Error::new(ErrorKind::Scene, "the radius is 0 once it is rounded")
                .at(format!("{}.radius", common.place))
                .value(sphere.radius * scale)
                .remedy("give the scene another unit of length"));
        }
        let number = self.geometry.own() as u32;
        self.geometry.spheres.push((center.as_vec3(), radius));
        let to_own = (turn * (1.0 / scale)).transpose();
        self.shapes.push(ShapeOutput {
            entity: occurrence.entity,
            shape: common.shape(number..number + 1, false),
            uv_map: Some(UvMap::Sphere(Mat3::from_cols(
                to_own.x_axis.as_vec3(),
                to_own.y_axis.as_vec3(),
                to_own.z_axis.as_vec3(),
            ))),
        });
        Ok(())
    }

    /// Appends the points in world space; returns the number of the first.
    fn add_points(&mut self, common: &Common, points: &[DVec3]) -> Result<u32> {
        let first = self.geometry.positions.len();
        check_count(common, first + points.len(), "vertices")?;
        for &point in points {
            let point = common.transform.transform_point3(point);
            check_point(common, point)?;
            self.geometry.positions.push(point.as_vec3());
        }
        Ok(first as u32)
    }

    fn finish(mut self) -> Output {
        self.shapes.sort_by_key(|s| s.shape.primitives.start);
        let lights = self.shapes.iter().filter(|s| s.shape.emission.is_some());
        self.geometry.lights = lights.map(|s| s.shape.primitives.clone()).collect();
        let Self { geometry, shapes, meshes, .. } = self;
        Output { geometry, shapes, meshes }
    }
}

/// 0 where the diagonal from the first corner to the third lies in the quad, else 1. They differ
/// only in quads with a corner that points inward.
fn first_of_diagonal(&[a, b, c, d]: &[DVec3; 4]) -> u32 {
    let normal = (c - a).cross(d - b);
    let within = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).dot(normal) > 0.0;
    u32::from(!(within(a, b, c) && within(a, c, d)))
}

fn corner_values<T>(attribute: Attribute<T>) -> CornerValues<T> {
    CornerValues { values: attribute.values, indices: attribute.indices }
}

fn in_range(point: DVec3) -> bool {
    point.abs().max_element() <= f64::from(MAX_COORDINATE)
}

fn check_point(common: &Common, point: DVec3) -> Result<()> {
    if in_range(point) {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Scene, "the transform takes the shape too far out")
        .at(format!("{}.transform", common.place))
        .value(format!("a coordinate of {:e}", point.abs().max_element()))
        .remedy(format!("keep coordinates within {MAX_COORDINATE:e}")))
}

/// A sphere that is larger has boxes of infinite area, which say nothing of a tree's cost.
fn check_radius(common: &Common, radius: f64) -> Result<()> {
    if radius <= f64::from(MAX_COORDINATE) {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Scene, "the transform makes the sphere too large")
        .at(format!("{}.transform", common.place))
        .value(format!("a radius of {radius:e}"))
        .remedy(format!("keep it within {MAX_COORDINATE:e}")))
}

fn check_count(common: &Common, count: usize, what: &str) -> Result<()> {
    if count <= MAX_NUMBER {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Limit, format!("the scene has too many {what}"))
        .at(&common.place)
        .value(count)
        .remedy(format!("at most {MAX_NUMBER} are allowed")))
}
