//! Surveys the contents of a mesh file without reading it into memory.
//!
//! For a binary PLY they follow from its header and its length. A text is scanned once, block by
//! block, and its words are counted but not parsed: they are checked when the mesh is loaded. An
//! invalid file has a survey too, limited by its size.

/// The contents of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Survey {
    /// Positions.
    pub positions: u64,
    /// Triangles, after triangulation.
    pub triangles: u64,
    /// Normals.
    pub normals: u64,
    /// Texture coordinates.
    pub uvs: u64,
    /// Colours of vertices.
    pub colors: u64,
    /// Whether it may have materials of its own.
    pub materials: bool,
    /// Whether corners have separate indices of normals.
    pub normal_indices: bool,
    /// Whether corners have separate indices of texture coordinates.
    pub uv_indices: bool,
}

/// Bytes of a position, a normal, a colour or the three indices of a triangle.
const TRIPLE: u64 = size_of::<[u32; 3]>() as u64;

/// Bytes of a pair of texture coordinates.
const PAIR: u64 = size_of::<[f32; 2]>() as u64;

impl Survey {
    /// The contents of two parts.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            positions: self.positions + other.positions,
            triangles: self.triangles + other.triangles,
            normals: self.normals + other.normals,
            uvs: self.uvs + other.uvs,
            colors: self.colors + other.colors,
            materials: self.materials || other.materials,
            normal_indices: self.normal_indices || other.normal_indices,
            uv_indices: self.uv_indices || other.uv_indices,
        }
    }

    /// Bytes of positions and triangles.
    pub fn prototype_bytes(&self) -> u64 {
        TRIPLE.saturating_mul(self.positions.saturating_add(self.triangles))
    }

    /// Bytes of normals.
    pub fn normal_bytes(&self) -> u64 {
        let indices = if self.normal_indices { self.triangles } else { 0 };
        TRIPLE.saturating_mul(self.normals.saturating_add(indices))
    }

    /// Bytes of texture coordinates.
    pub fn uv_bytes(&self) -> u64 {
        let indices = if self.uv_indices { self.triangles } else { 0 };
        PAIR.saturating_mul(self.uvs).saturating_add(TRIPLE.saturating_mul(indices))
    }

    /// Bytes of colours.
    pub fn color_bytes(&self) -> u64 {
        TRIPLE.saturating_mul(self.colors)
    }

    /// Bytes of the whole mesh after reading.
    pub fn bytes(&self) -> u64 {
        let others = [self.normal_bytes(), self.uv_bytes(), self.color_bytes()];
        others.into_iter().fold(self.prototype_bytes(), u64::saturating_add)
    }
}
