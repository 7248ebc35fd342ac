//! Splits a mesh: each triangle goes to one part with its own vertices.

use super::data::{Attribute, MeshData, NO_VALUE};

impl MeshData {
    /// The parts, at most `count`, without empty ones; `part` assigns each triangle. Triangles and
    /// vertices keep their order. Each part comes with its number.
    pub(crate) fn split(self, part: &[u32], count: usize) -> Vec<(u32, Self)> {
        let mut triangles: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (triangle, &part) in (0..).zip(part) {
            triangles[part as usize].push(triangle);
        }
        let whole = |of: &Vec<u32>| of.len() == self.triangles.len();
        if let Some(only) = triangles.iter().position(whole) {
            return vec![(only as u32, self)];
        }
        let mut numbers = NewIndices::default();
        let used = (0..).zip(&triangles).filter(|(_, of)| !of.is_empty());
        used.map(|(number, of)| (number, self.part(of, &mut numbers))).collect()
    }

    /// The part with these triangles.
    fn part(&self, which: &[u32], numbers: &mut NewIndices) -> Self {
        let (triangles, used) = numbers.renumbered(which, &self.triangles, self.positions.len());
        Self {
            positions: picked(&self.positions, &used),
            origin: self.origin,
            colors: self.colors.as_ref().map(|colors| picked(colors, &used)),
            alphas: self.alphas.as_ref().map(|alphas| picked(alphas, &used)),
            triangles,
            normals: self.normals.as_ref().map(|all| numbers.attribute(all, which, &used)),
            uvs: self.uvs.as_ref().map(|all| numbers.attribute(all, which, &used)),
        }
    }
}

fn picked<T: Copy>(values: &[T], which: &[u32]) -> Vec<T> {
    which.iter().map(|&i| values[i as usize]).collect()
}

/// The new indices of values in a part; the memory is reused for the next.
#[derive(Default)]
struct NewIndices(Vec<u32>);

impl NewIndices {
    /// The corners of the triangles in `which` with new indices, and the old indices, of `count`,
    /// in rising order.
    fn renumbered(
        &mut self,
        which: &[u32],
        corners: &[[u32; 3]],
        count: usize,
    ) -> (Vec<[u32; 3]>, Vec<u32>) {
        let of_part = || which.iter().map(|&triangle| corners[triangle as usize]);
        let mut used: Vec<u32> = of_part().flatten().filter(|&i| i != NO_VALUE).collect();
        used.sort_unstable();
        used.dedup();
        self.0.resize(self.0.len().max(count), NO_VALUE);
        for (number, &old) in (0..).zip(&used) {
            self.0[old as usize] = number;
        }
        let renumber = |i: u32| self.0.get(i as usize).copied().unwrap_or(NO_VALUE);
        (of_part().map(|corner| corner.map(renumber)).collect(), used)
    }

    /// The attribute of the triangles in `which`, given the positions that they have `used`.
    fn attribute<T: Copy>(
        &mut self,
        Attribute { values, indices }: &Attribute<T>,
        which: &[u32],
        used: &[u32],
    ) -> Attribute<T> {
        let Some(indices) = indices else {
            return Attribute { values: picked(values, used), indices: None };
        };
        let (indices, used) = self.renumbered(which, indices, values.len());
        Attribute { values: picked(values, &used), indices: Some(indices) }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec2, Vec3};

    use super::*;

    /// A row of squares, with a normal for each triangle and coordinates and colours for each position.
    fn strip(count: u32) -> MeshData {
        let positions: Vec<Vec3> =
            (0..count + 2).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.5)).collect();
        let normals = (0..count).map(|i| Vec3::new(0.0, i as f32, 1.0)).collect();
        let indices = (0..count).map(|i| [i, NO_VALUE, i]).collect();
        MeshData {
            uvs: Some(Attribute {
                values: positions.iter().map(|p| Vec2::new(p.x, p.y)).collect(),
                indices: None,
            }),
            colors: Some(positions.iter().map(|p| *p + 1.0).collect()),
            alphas: Some(positions.iter().map(|p| p.x).collect()),
            normals: Some(Attribute { values: normals, indices: Some(indices) }),
            triangles: (0..count).map(|i| [i, i + 1, i + 2]).collect(),
            positions,
            origin: DVec3::X,
        }
    }

    /// The attributes of a triangle's corners.
    fn corners(mesh: &MeshData, t: usize) -> Vec<(Vec3, Option<Vec3>, Vec2, Vec3)> {
        let normals = mesh.normals.as_ref().unwrap();
        let at = |k: usize| {
            let i = mesh.triangles[t][k] as usize;
            let normal = normals.indices.as_ref().unwrap()[t][k] as usize;
            let uv = mesh.uvs.as_ref().unwrap().values[i];
            let color = mesh.colors.as_ref().unwrap()[i] + mesh.alphas.as_ref().unwrap()[i];
            (mesh.positions[i], normals.values.get(normal).copied(), uv, color)
        };
        (0..3).map(at).collect()
    }

    #[test]
    fn each_triangle_keeps_all_that_it_has_in_its_part() {
        let mesh = strip(7);
        let part = [3, 0, 3, 1, 1, 0, 3];
        let parts = mesh.clone().split(&part, 5);
        assert_eq!(parts.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [0, 1, 3]);
        for (number, own) in &parts {
            super::super::validate(own, std::path::Path::new("m")).unwrap();
            let which = (0..7).filter(|&t| part[t] == *number);
            for (t, old) in which.enumerate() {
                assert_eq!(corners(own, t), corners(&mesh, old));
            }
        }
        assert_eq!(parts.iter().map(|(_, own)| own.triangles.len()).sum::<usize>(), 7);
        // Only the vertices of its triangles.
        assert_eq!(parts[1].1.positions.len(), 4);
        assert_eq!(parts[1].1.origin, DVec3::X);
    }

    #[test]
    fn a_mesh_of_one_part_stays_as_it_is() {
        let mesh = strip(3);
        assert_eq!(mesh.clone().split(&[1; 3], 2), [(1, mesh)]);
    }
}
