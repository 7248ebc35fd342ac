//! Merges vertices at the same position, so that triangles with repeated positions, as in STL
//! files, share a leaf's vertices like those with shared indices.

use glam::Vec3;

/// A free slot.
const FREE: u32 = u32::MAX;

/// Replaces each vertex of the `triangles`, at most `most`, by the first with the same bits. `table` is
/// memory for this.
pub(super) fn weld<'a>(
    positions: &[Vec3],
    triangles: impl Iterator<Item = &'a mut [u32; 3]>,
    most: usize,
    table: &mut Vec<u32>,
) {
    // Open addressing: the vertex in each taken slot. Half of the slots stay free.
    let size = (6 * most).next_power_of_two();
    table.clear();
    table.resize(size, FREE);
    let bits = |v: u32| positions[v as usize].to_array().map(f32::to_bits);
    for vertex in triangles.flatten() {
        let own = bits(*vertex);
        let mut place = hash(own) as usize & (size - 1);
        while table[place] != FREE && bits(table[place]) != own {
            place = (place + 1) & (size - 1);
        }
        if table[place] == FREE {
            table[place] = *vertex;
        }
        *vertex = table[place];
    }
}

fn hash(bits: [u32; 3]) -> u64 {
    let mix =
        |h: u64, &x: &u32| (h ^ u64::from(x)).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29);
    bits.iter().fold(0, mix)
}
