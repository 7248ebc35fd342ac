//! Merges vertices at the same position, so that triangles with repeated positions, as in STL
//! files, share a leaf's vertices like those with shared indices.

use glam::Vec3;

/// Merges the vertices of a few triangles at a time, and reuses its memory.
#[derive(Debug, Default)]
pub(super) struct Welder {
    /// Open addressing: the vertex in each taken slot.
    table: Vec<u32>,
}

/// A free slot.
const FREE: u32 = u32::MAX;

impl Welder {
    /// Replaces each vertex of the `triangles`, at most `most`, by the first with the same bits.
    pub(super) fn weld<'a>(
        &mut self,
        positions: &[Vec3],
        triangles: impl Iterator<Item = &'a mut [u32; 3]>,
        most: usize,
    ) {
        // Half of the slots stay free.
        let size = (6 * most).next_power_of_two();
        self.table.clear();
        self.table.resize(size, FREE);
        let bits = |v: u32| positions[v as usize].to_array().map(f32::to_bits);
        for vertex in triangles.flatten() {
            let own = bits(*vertex);
            let mut place = hash(own) as usize & (size - 1);
            while self.table[place] != FREE && bits(self.table[place]) != own {
                place = (place + 1) & (size - 1);
            }
            if self.table[place] == FREE {
                self.table[place] = *vertex;
            }
            *vertex = self.table[place];
        }
    }
}

fn hash(bits: [u32; 3]) -> u64 {
    let mix =
        |h: u64, &x: &u32| (h ^ u64::from(x)).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29);
    bits.iter().fold(0, mix)
}
