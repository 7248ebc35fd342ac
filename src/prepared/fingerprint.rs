//! A number that tells scenes apart.

use std::fmt::{self, Write as _};

use xxhash_rust::xxh3::Xxh3;

use super::PreparedScene;
use crate::kernels::texture::Texels;

/// What is written is hashed.
struct Hasher(Xxh3);

impl fmt::Write for Hasher {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

impl PreparedScene {
    /// A hash (XXH3) of all that its image follows from: primitives, attributes, textures, materials,
    /// lights, camera. Scenes that differ in any of it have different ones, but for a chance of 2^-64; the
    /// order of a file's keys and the folder that it lies in do not count. It is no protection against
    /// someone who looks for a collision.
    pub fn fingerprint(&self) -> u128 {
        let mut hasher = Hasher(Xxh3::new());
        let geometry = &self.accel.geometry;
        hasher.0.update(bytemuck::cast_slice(&geometry.positions));
        hasher.0.update(bytemuck::cast_slice(&geometry.triangles));
        hasher.0.update(bytemuck::cast_slice(&geometry.quads));
        for form in &geometry.forms {
            hasher.0.update(bytemuck::cast_slice(&form.positions));
            hasher.0.update(bytemuck::cast_slice(&form.triangles));
            let _ = write!(hasher, "{} {}", form.positions.len(), form.triangles.len());
        }
        for instance in &geometry.instances {
            let _ = write!(hasher, "{} {:?}", instance.form(), instance.to_world());
        }
        for mesh in &self.looks.meshes {
            if let Some(normals) = &mesh.normals {
                hasher.0.update(bytemuck::cast_slice(&normals.values));
                hasher.0.update(bytemuck::cast_slice(normals.indices.as_deref().unwrap_or(&[])));
            }
            if let Some(uvs) = &mesh.uvs {
                hasher.0.update(bytemuck::cast_slice(&uvs.values));
                hasher.0.update(bytemuck::cast_slice(uvs.indices.as_deref().unwrap_or(&[])));
            }
        }
        for image in &self.looks.images {
            match &image.texels {
                Texels::Bytes(texels) => hasher.0.update(bytemuck::cast_slice(texels)),
                Texels::Levels(texels, values) => {
                    hasher.0.update(bytemuck::cast_slice(texels));
                    hasher.0.update(bytemuck::cast_slice(values.as_slice()));
                }
                Texels::Floats(texels) => hasher.0.update(bytemuck::cast_slice(texels)),
            }
        }
        // Numbers as text are the shortest that read back as the same: as good as their bits. A hasher
        // takes all that is written.
        let _ = write!(hasher, "{:?}{:?}", geometry.spheres, geometry.lights);
        let _ = write!(hasher, "{:?}{:?}", self.looks.shapes, self.looks.materials);
        let _ = write!(hasher, "{:?}{:?}{:?}", self.camera, self.lights, self.origin);
        let _ = write!(hasher, "{:?}{}{}", self.background, self.ambient, self.bounces);
        let lengths = [geometry.positions.len(), geometry.triangles.len(), geometry.quads.len()];
        let _ = write!(hasher, "{lengths:?}");
        hasher.0.digest128()
    }

    /// Bytes held by geometry, tree, attributes and images.
    pub fn bytes(&self) -> u64 {
        self.accel.geometry.bytes() + self.accel.tree_bytes() + self.looks.bytes()
    }
}
