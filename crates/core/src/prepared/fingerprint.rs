//! A hash that distinguishes scenes.

use std::fmt::{self, Write as _};

use xxhash_rust::xxh3::Xxh3;

use super::{CornerValues, PreparedScene};
use crate::geometry::cutouts::Cutout;

/// Hashes everything written to it.
struct Hasher(Xxh3);

impl Hasher {
    /// Hashes a list: its length, so that it does not merge with the next, and its bytes.
    fn list<T: bytemuck::NoUninit>(&mut self, values: &[T]) {
        self.0.update(&(values.len() as u64).to_le_bytes());
        self.0.update(bytemuck::cast_slice(values));
    }

    /// Hashes values at corners, and which corners have them.
    fn corners<T: bytemuck::NoUninit>(&mut self, corners: &CornerValues<T>) {
        self.list(&corners.values);
        self.list(corners.indices.as_ref().map_or(&[], |indices| indices.as_slice()));
    }

    /// Hashes a cut-out: its primitives, mapping and image.
    fn cutout(&mut self, cutout: &Cutout) {
        let Cutout { primitives, threshold, filter, wrap, map, placing, mesh, image } = cutout;
        let _ = write!(self, "{primitives:?}{threshold}{filter:?}{wrap:?}{map:?}{placing:?}");
        if let Some(mesh) = mesh {
            self.corners(&mesh.uvs);
            self.list(mesh.alphas.as_ref().map_or(&[], |alphas| &alphas.values));
        }
        self.list(&[image.as_ref().map_or(0, |image| image.fingerprint())]);
    }
}

impl fmt::Write for Hasher {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

impl PreparedScene {
    /// A hash (XXH3) of all inputs of the image: primitives, attributes, textures, materials,
    /// lights, camera. Scenes that differ in any of these have different hashes, except with a
    /// probability of 2^-64; the order of keys in the file and its folder do not count. It gives no
    /// protection against deliberate collisions. The files of all images are read for it, and none is
    /// decoded.
    pub fn fingerprint(&self) -> u128 {
        let mut hasher = Hasher(Xxh3::new());
        self.hash_geometry(&mut hasher);
        self.appearance.images.iter().for_each(|image| hasher.list(&[image.fingerprint()]));
        // Numbers as text are the shortest that read back to the same value: as good as their bits.
        // A hasher never fails.
        let _ = write!(hasher, "{:?}{:?}", self.camera, self.origin);
        let _ = write!(hasher, "{:?}{:?}", self.appearance.shapes, self.appearance.classes);
        let _ = write!(hasher, "{:?}{:?}", self.lights, self.background);
        let _ = write!(hasher, "{:?} {:?}", self.ambient, self.bounces);
        let _ = write!(hasher, "{:?}{:?}", self.hemisphere, self.environment);
        if self.plan.schedule().has_transmission() {
            let _ = write!(hasher, "{:?}", self.visible);
        }
        hasher.0.digest128()
    }

    fn hash_geometry(&self, hasher: &mut Hasher) {
        let geometry = self.accel.geometry();
        hasher.list(&geometry.positions);
        hasher.list(&geometry.triangles);
        hasher.list(&geometry.quads);
        let _ = write!(hasher, "{:?}{:?}", geometry.quadrics, geometry.passed);
        for prototype in &geometry.prototypes {
            hasher.list(&prototype.positions);
            hasher.list(&prototype.triangles);
        }
        for instance in &geometry.instances {
            let _ = write!(hasher, "{} {:?}", instance.prototype(), instance.to_world());
        }
        for own in geometry.prototypes.iter().chain([geometry]) {
            own.cutouts.iter().for_each(|cutout| hasher.cutout(cutout));
        }
        for mesh in &self.appearance.meshes {
            let _ = write!(hasher, "{:?}", [mesh.first_triangle, mesh.first_position]);
            mesh.normals.iter().for_each(|normals| hasher.corners(normals));
            mesh.uvs.iter().for_each(|uvs| hasher.corners(uvs));
            mesh.colors.iter().for_each(|colors| hasher.list(&colors.values));
            mesh.alphas.iter().for_each(|alphas| hasher.list(&alphas.values));
            mesh.tangents.iter().for_each(|tangents| hasher.corners(tangents));
        }
    }

    /// Bytes held by geometry, tree, attributes and images.
    pub fn bytes(&self) -> u64 {
        self.accel.geometry().bytes() + self.accel.tree_bytes() + self.appearance.bytes()
    }
}
