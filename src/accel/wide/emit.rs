//! Writing nodes and leaves as they were decided.

use bytemuck::Zeroable;

use super::{Converter, Owner, TOO_MANY, Vertices, Wide};
use crate::accel::arena::{Kind, NODE_UNITS, Node, Patch, Soup, Unit, list_units, relative};
use crate::accel::geometry::Geometry;
use crate::math::simd::LANES;

/// Writes what was decided.
pub(super) struct Emitter<'a, F> {
    pub(super) geometry: &'a Geometry,
    pub(super) converter: &'a Converter,
    pub(super) owner: F,
    pub(super) first_number: u32,
    pub(super) wide: Wide,
}

impl<'b, F: Fn(u32) -> Owner<'b>> Emitter<'_, F> {
    /// Writes the whole subtree.
    pub(super) fn emit(&mut self) {
        self.wide.bounds = Some(self.converter.order[0].bounds);
        self.wide.root = Some(self.kind(0));
        if self.wide.root != Some(Kind::Node) {
            self.leaf(0);
            return;
        }
        // Inner nodes that wait, and where their parent's entry is.
        let mut waiting = vec![(0_usize, None::<(usize, usize)>)];
        let mut children = Vec::with_capacity(LANES);
        while let Some((place, parent)) = waiting.pop() {
            let unit = self.wide.units.len();
            self.wide.units.resize(unit + NODE_UNITS, Unit::zeroed());
            if let Some((parent, lane)) = parent {
                let node = self.node_mut(parent);
                node.children[lane] = relative(parent, unit, Kind::Node);
            }
            children.clear();
            let left = self.converter.best[place].left[0] as usize;
            self.gather(place + 1, left, &mut children);
            let right = self.converter.order[place].right as usize;
            self.gather(right, LANES - left, &mut children);
            self.node(unit, &children, &mut waiting);
        }
    }

    /// Fills the node at `unit`, writes its leaves behind it, and lets its inner children wait.
    fn node(
        &mut self,
        unit: usize,
        children: &[usize],
        waiting: &mut Vec<(usize, Option<(usize, usize)>)>,
    ) {
        let mut node = Node { count: children.len() as u32, ..Node::EMPTY };
        for (lane, &child) in children.iter().enumerate() {
            let bounds = self.converter.order[child].bounds;
            for axis in 0..3 {
                node.planes[axis][0][lane] = bounds.low[axis];
                node.planes[axis][1][lane] = bounds.high[axis];
            }
            let kind = self.kind(child);
            if kind == Kind::Node {
                waiting.push((child, Some((unit, lane))));
            } else {
                node.children[lane] = relative(unit, self.wide.units.len(), kind);
                self.leaf(child);
            }
        }
        *self.node_mut(unit) = node;
    }

    fn node_mut(&mut self, unit: usize) -> &mut Node {
        let units = &mut self.wide.units[unit..unit + NODE_UNITS];
        bytemuck::from_bytes_mut(bytemuck::cast_slice_mut(units))
    }

    /// Appends the children that the subtree at `place` becomes in `slots`.
    fn gather(&self, place: usize, slots: usize, children: &mut Vec<usize>) {
        let best = &self.converter.best[place];
        let mut slots = slots;
        while slots > 1 && best.left[slots - 1] == 0 {
            slots -= 1;
        }
        if slots == 1 {
            children.push(place);
            return;
        }
        let left = best.left[slots - 1] as usize;
        self.gather(place + 1, left, children);
        self.gather(self.converter.order[place].right as usize, slots - left, children);
    }

    /// What the subtree at `place` becomes in one slot.
    fn kind(&self, place: usize) -> Kind {
        let node = &self.converter.order[place];
        if node.right != 0 && self.converter.best[place].left[0] != 0 {
            return Kind::Node;
        }
        if self.converter.vertices[place].count != TOO_MANY {
            return Kind::Patch;
        }
        match (self.owner)(self.converter.owners[node.first as usize]) {
            Owner::Single(n) if (n as usize) < self.geometry.triangles.len() => Kind::Soup,
            _ => Kind::List,
        }
    }

    fn leaf(&mut self, place: usize) {
        let node = self.converter.order[place];
        let range = node.first as usize..(node.first + node.leaves) as usize;
        let mut numbers: Vec<u32> = Vec::with_capacity(range.len());
        for &owner in &self.converter.owners[range] {
            match (self.owner)(owner) {
                Owner::Single(number) => numbers.push(number),
                Owner::Heap(all) => numbers.extend_from_slice(all),
            }
        }
        match self.kind(place) {
            Kind::Patch => self.patch(&self.converter.vertices[place], &numbers),
            Kind::Soup => self.soup(&numbers),
            Kind::List | Kind::Node => self.list(&numbers),
        }
    }

    fn patch(&mut self, vertices: &Vertices, numbers: &[u32]) {
        let mut positions = [[0.0; LANES]; 3];
        let known = &vertices.all[..vertices.count as usize];
        for lane in 0..LANES {
            // Unused lanes repeat the first.
            let vertex = known.get(lane).unwrap_or(&known[0]);
            let v = self.geometry.positions[*vertex as usize];
            positions.iter_mut().zip(v.to_array()).for_each(|(row, x)| row[lane] = x);
        }
        let mut corners = [0_u32; 3];
        for (lane, &number) in numbers.iter().enumerate() {
            for (corner, &v) in self.geometry.triangles[number as usize].iter().enumerate() {
                let local = known.iter().position(|&k| k == v).unwrap_or(0) as u32;
                corners[corner] |= local << (4 * lane);
            }
        }
        let first = self.append(numbers);
        let counts = [numbers.len() as u32, u32::from(vertices.count)];
        self.wide.units.push(bytemuck::cast(Patch::new(positions, corners, first, counts)));
    }

    fn soup(&mut self, numbers: &[u32]) {
        let mut corners = [[[0.0; LANES]; 3]; 3];
        for (lane, &number) in numbers.iter().enumerate() {
            for (corner, v) in self.geometry.triangle(number as usize).iter().enumerate() {
                for axis in 0..3 {
                    corners[corner][axis][lane] = v[axis];
                }
            }
        }
        let first = self.append(numbers);
        let leaf = Soup::new(corners, first, numbers.len() as u32);
        self.wide.units.extend(bytemuck::cast::<_, [Unit; 3]>(leaf));
    }

    fn list(&mut self, numbers: &[u32]) {
        let start = self.wide.units.len();
        self.wide.units.resize(start + list_units(numbers.len()), Unit::zeroed());
        let words: &mut [u32] = bytemuck::cast_slice_mut(&mut self.wide.units[start..]);
        words[0] = numbers.len() as u32;
        words[1..=numbers.len()].copy_from_slice(numbers);
    }

    fn append(&mut self, numbers: &[u32]) -> u32 {
        let first = self.first_number + self.wide.numbers.len() as u32;
        self.wide.numbers.extend_from_slice(numbers);
        first
    }
}
