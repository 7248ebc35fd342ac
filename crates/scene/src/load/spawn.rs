//! Creates the entities of a scene.

use std::path::Path;

use glam::DVec3;
use hecs::{Entity, EntityBuilder, World};

use wavecrest_base::error::{Error, ErrorKind, Result};

use super::materials::parts;
use crate::components::{
    AreaLight, CutOut, Hidden, InstanceOf, JsonPath, Maps, Material, Materials, Mesh, Order,
    Pinhole, Shading, Sides, TextureRef, Transform, VertexColors,
};
use crate::mesh::{LoadedMesh, MeshData, NamedMaterials};
use crate::reader::Notes;
use crate::schema::{Camera, Geometry, Instance, Light, SceneFile, Shape};

/// The world of `scene`, with mesh files read by `read_mesh`.
pub(super) fn world(
    scene: SceneFile,
    notes: &Notes<'_>,
    read_mesh: impl Fn(&Path) -> Result<LoadedMesh>,
) -> Result<World> {
    notes.whole(|| Spawner { world: World::new(), notes, read_mesh }.spawn(scene))
}

/// Creates entities from the parts of a scene.
struct Spawner<'a, R> {
    world: World,
    notes: &'a Notes<'a>,
    read_mesh: R,
}

impl<R: Fn(&Path) -> Result<LoadedMesh>> Spawner<'_, R> {
    fn spawn(mut self, scene: SceneFile) -> Result<World> {
        self.world.spawn((scene.settings,));
        self.camera(scene.camera);
        let notes = self.notes;
        let mut sound = Ok(());
        for (order, light) in (0..).zip(scene.lights) {
            sound = notes.part(|| self.light(Order(order), light)).and(sound);
        }
        let mut order = (0..).map(Order);
        let mut shapes = Vec::with_capacity(scene.shapes.len());
        let unseen = self.unseen(&scene.shapes, &scene.instances);
        for (shape, is_unseen) in scene.shapes.into_iter().zip(unseen) {
            if is_unseen {
                shape.files().for_each(|file| notes.reads(file));
                shapes.push(Vec::new());
                continue;
            }
            match notes.part(|| self.shape(&mut order, shape)) {
                Ok(parts) => shapes.push(parts),
                Err(error) => sound = Err(error),
            }
        }
        sound?;
        for instance in &scene.instances {
            for (&part, order) in shapes[instance.shape].iter().zip(&mut order) {
                self.instance(order, part, instance);
            }
        }
        Ok(self.world)
    }

    /// Which of the shapes are hidden and have no instance: they are not read. Warns of them.
    fn unseen(&self, shapes: &[Shape], instances: &[Instance]) -> Vec<bool> {
        let mut has_instance = vec![false; shapes.len()];
        instances.iter().for_each(|instance| has_instance[instance.shape] = true);
        let unseen: Vec<bool> =
            shapes.iter().zip(has_instance).map(|(shape, has)| shape.hidden && !has).collect();
        for (shape, _) in shapes.iter().zip(&unseen).filter(|(_, unseen)| **unseen) {
            let error = self.error(&shape.path, "the shape is hidden and has no instance");
            self.notes.warn(&error.remedy("add an instance, or remove \"hidden\""));
        }
        unseen
    }

    /// Creates an instance of the shape entity `of`.
    fn instance(&mut self, order: Order, of: Entity, instance: &Instance) {
        let Instance { path, name, transform, material, .. } = instance;
        let mut entity = EntityBuilder::new();
        entity.add_bundle((order, JsonPath(path.clone()), InstanceOf(of), Transform(*transform)));
        add_some(&mut entity, name.clone());
        let shape = &self.world;
        add_some(&mut entity, material.or(shape.get::<&Material>(of).ok().map(|m| *m)));
        add_some(&mut entity, shape.get::<&Sides>(of).ok().map(|sides| *sides));
        add_some(&mut entity, shape.get::<&Shading>(of).ok().map(|shading| *shading));
        add_some(&mut entity, shape.get::<&CutOut>(of).ok().map(|cutout| (*cutout).clone()));
        add_some(&mut entity, shape.get::<&TextureRef>(of).ok().map(|texture| (*texture).clone()));
        add_some(&mut entity, shape.get::<&Maps>(of).ok().map(|maps| (*maps).clone()));
        self.world.spawn(entity.build());
    }

    fn camera(&mut self, Camera { view, lens, path }: Camera) {
        let mut entity = EntityBuilder::new();
        entity.add(view);
        match lens {
            Some(lens) => entity.add(lens),
            None => entity.add(Pinhole),
        };
        add_some(&mut entity, path);
        self.world.spawn(entity.build());
    }

    fn light(&mut self, order: Order, light: Light) -> Result<()> {
        match light {
            Light::Point { path, light } => {
                self.world.spawn((order, JsonPath(path), light));
            }
            Light::Spot { path, light, spot } => {
                self.world.spawn((order, JsonPath(path), light, spot));
            }
            Light::Directional { path, light } => {
                self.world.spawn((order, JsonPath(path), light));
            }
            Light::Area { path, light, shape } => self.area_light(order, path, light, *shape)?,
        }
        Ok(())
    }

    fn area_light(
        &mut self,
        order: Order,
        path: String,
        light: AreaLight,
        shape: Shape,
    ) -> Result<()> {
        let mut entity = EntityBuilder::new();
        entity.add_bundle((order, JsonPath(path), light));
        let (geometry, _) = self.read_mesh_file(&shape.path, shape.geometry, VertexColors::None)?;
        if let Geometry::Mesh(mesh) = &geometry
            && !has_area(mesh)
        {
            return Err(self.error(&shape.path, "a light must have an area"));
        }
        add_geometry(&mut entity, geometry);
        add_some(&mut entity, shape.name);
        add_some(&mut entity, shape.facing);
        add_some(&mut entity, shape.transform);
        self.world.spawn(entity.build());
        Ok(())
    }

    /// Creates a shape, or several if its faces have the materials of its file.
    fn shape(
        &mut self,
        order: &mut impl Iterator<Item = Order>,
        mut shape: Shape,
    ) -> Result<Vec<Entity>> {
        let nothing = Geometry::Mesh(Mesh::default());
        let geometry = std::mem::replace(&mut shape.geometry, nothing);
        let (geometry, named) = self.read_mesh_file(&shape.path, geometry, shape.vertex_colors)?;
        let parts = match geometry {
            Geometry::Mesh(Mesh { data, file: Some(file), .. })
                if shape.materials == Materials::File =>
            {
                parts(&shape, data, &named, &file, self.notes)
            }
            geometry => vec![Shape { geometry, ..shape }],
        };
        parts.into_iter().zip(order).map(|(part, order)| self.part(order, part)).collect()
    }

    fn part(&mut self, order: Order, shape: Shape) -> Result<Entity> {
        let key = shape.textures().next().map(|(key, _)| key);
        let key = key.or(shape.cutout.as_ref().map(|_| "alpha"));
        let geometry = shape.geometry;
        let mut shading = shape.shading;
        if let Geometry::Mesh(mesh) = &geometry {
            self.check_uvs(&shape.path, key, &mesh.data)?;
            shading = self.possible_shading(&shape.path, shading, &mesh.data);
        }
        let mut entity = EntityBuilder::new();
        entity.add_bundle((order, JsonPath(shape.path), shape.sides, shading));
        add_geometry(&mut entity, geometry);
        add_some(&mut entity, shape.name);
        add_some(&mut entity, shape.facing);
        add_some(&mut entity, shape.transform);
        add_some(&mut entity, shape.material);
        add_some(&mut entity, shape.texture);
        add_some(&mut entity, shape.cutout);
        add_some(&mut entity, Some(shape.maps).filter(|maps| *maps != Maps::default()));
        if shape.hidden {
            entity.add(Hidden);
        }
        Ok(self.world.spawn(entity.build()))
    }

    /// The geometry, with its mesh file read, if any; and the file's materials.
    fn read_mesh_file(
        &self,
        path: &str,
        geometry: Geometry,
        colors: VertexColors,
    ) -> Result<(Geometry, NamedMaterials)> {
        let Geometry::MeshFile(file) = geometry else { return Ok((geometry, Default::default())) };
        self.notes.reads(&file);
        let mut loaded = (self.read_mesh)(&file).map_err(|e| self.mesh_error(path, e))?;
        self.notes.pass_on(loaded.warnings);
        loaded.mesh.decode_colors(colors);
        let mesh = Mesh { data: loaded.mesh, file: Some(file), ..Mesh::default() };
        Ok((Geometry::Mesh(mesh), loaded.materials))
    }

    /// The error of a mesh reader, prefixed with the place in the scene that names the mesh.
    fn mesh_error(&self, path: &str, cause: Error) -> Error {
        let message = format!("cannot read the mesh: {cause}");
        self.notes.error(cause.kind(), &format!("{path}.file"), message).because(cause)
    }

    fn error(&self, place: &str, message: &str) -> Error {
        self.notes.error(ErrorKind::Scene, place, message.to_owned())
    }

    /// Checks that a mesh has the texture coordinates that the `key` of its shape needs, if any.
    fn check_uvs(&self, path: &str, key: Option<&str>, mesh: &MeshData) -> Result<()> {
        let Some(key) = key.filter(|_| mesh.uvs.is_none()) else { return Ok(()) };
        let message = "the mesh has no texture coordinates";
        let error = self.error(&format!("{path}.{key}"), message);
        Err(error.remedy("add \"uvs\", or remove the texture"))
    }

    /// The requested shading, if the mesh has the normals for it.
    fn possible_shading(&self, path: &str, asked: Shading, mesh: &MeshData) -> Shading {
        if asked == Shading::Smooth && mesh.normals.is_none() {
            let message = "the mesh has no normals for smooth shading";
            let error = self.error(&format!("{path}.shading"), message);
            self.notes.warn(&error.remedy("flat shading is used"));
            return Shading::Flat;
        }
        asked
    }
}

/// Adds the geometry component.
fn add_geometry(entity: &mut EntityBuilder, geometry: Geometry) {
    match geometry {
        Geometry::Sphere(sphere) => entity.add(sphere),
        Geometry::Quad(quad) => entity.add(quad),
        Geometry::Triangle(triangle) => entity.add(triangle),
        Geometry::Mesh(mesh) => entity.add(mesh),
        // It is read already.
        Geometry::MeshFile(_) => entity,
    };
}

fn add_some<C: hecs::Component>(entity: &mut EntityBuilder, component: Option<C>) {
    if let Some(component) = component {
        entity.add(component);
    }
}

/// Whether any triangle of a mesh has an area.
pub(crate) fn has_area(mesh: &Mesh) -> bool {
    let position = |i: u32| match &mesh.points {
        Some(points) => points[i as usize],
        None => mesh.data.positions[i as usize].as_dvec3(),
    };
    mesh.data.triangles.iter().any(|triangle| {
        let [a, b, c] = triangle.map(position);
        (b - a).cross(c - a) != DVec3::ZERO
    })
}
