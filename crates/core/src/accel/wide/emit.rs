//! Writes the nodes and leaves chosen by [`Converter::evaluate`].

use bytemuck::Zeroable;
use obvhs::bvh2::Bvh2;

use super::{Converter, Output, Owner, SLOTS, SharedVertices};
use crate::accel::arena::{LeafHead, NODE_UNITS, extent, relative};
use crate::accel::{Kind, Node, Patch, Soup, Unit};
use crate::geometry::Geometry;
use crate::math::LANES;

impl Converter {
    /// Appends the evaluated subtree of `root` to `output`, its root first, and returns its part.
    pub(crate) fn emit<'a>(
        &self,
        geometry: &Geometry,
        tree: &Bvh2,
        owner: impl Fn(u32) -> Owner<'a>,
        root: u32,
        output: &mut Output,
    ) -> Kind {
        let mut emitter = UnitWriter { geometry, converter: self, tree, owner, output };
        if self.is_leaf(root) {
            return emitter.leaf(root).1;
        }
        emitter.nodes(root);
        Kind::Node
    }

    /// Lists the children of the wide node at `place`, the largest last: any-hit queries visit it first.
    /// Each is the place of a binary node, with its area above.
    pub(crate) fn children(&self, tree: &Bvh2, place: u32, children: &mut Vec<u64>) {
        children.clear();
        self.share(tree, place, LANES, children);
        children.sort_unstable();
    }

    /// Divides `slots` between both sides of a binary node in the cheapest way, and appends the
    /// resulting children.
    fn share(&self, tree: &Bvh2, place: u32, slots: usize, children: &mut Vec<u64>) {
        let left = tree.nodes[place as usize].first_index;
        let (l, r) = (&self.best[left as usize].cost, &self.best[left as usize + 1].cost);
        let cost = |k: usize| l[k - 1] + r[slots - k - 1];
        let cheapest = |a: usize, b: usize| if cost(b) < cost(a) { b } else { a };
        let least = slots.saturating_sub(SLOTS).max(1);
        let of_left = (least..slots.min(SLOTS + 1)).fold(least, cheapest);
        self.gather(tree, left, of_left, children);
        self.gather(tree, left + 1, slots - of_left, children);
    }

    /// Appends the children that the subtree at `place` becomes in `slots`.
    fn gather(&self, tree: &Bvh2, place: u32, slots: usize, children: &mut Vec<u64>) {
        let cost = &self.best[place as usize].cost;
        let mut slots = slots;
        while slots > 1 && cost[slots - 1] >= cost[slots - 2] {
            slots -= 1;
        }
        if slots == 1 {
            // The bits of positive floats have the order of their values.
            let area = tree.nodes[place as usize].aabb().half_area();
            children.push(u64::from(area.to_bits()) << 32 | u64::from(place));
        } else {
            self.share(tree, place, slots, children);
        }
    }
}

/// Writes nodes and leaves to an output.
struct UnitWriter<'a, F> {
    geometry: &'a Geometry,
    converter: &'a Converter,
    tree: &'a Bvh2,
    owner: F,
    output: &'a mut Output,
}

impl<'b, F: Fn(u32) -> Owner<'b>> UnitWriter<'_, F> {
    /// Writes an inner node and everything below.
    fn nodes(&mut self, root: u32) {
        let mut children = Vec::with_capacity(LANES);
        // Waiting inner nodes, and the place of their parent's entry.
        let mut waiting = vec![(root, None::<(usize, usize)>)];
        while let Some((place, parent)) = waiting.pop() {
            let unit = self.output.units.len();
            self.output.units.extend([Unit::zeroed(); NODE_UNITS]);
            if let Some((parent, lane)) = parent {
                self.node_mut(parent).children[lane] = relative(parent, unit, Kind::Node);
            }
            self.converter.children(self.tree, place, &mut children);
            let mut node = Node { count: children.len() as u32, ..Node::EMPTY };
            // Leaves are written behind it, inner children wait.
            for (lane, child) in children.iter().map(|&child| child as u32).enumerate() {
                let bounds = &self.tree.nodes[child as usize];
                for axis in 0..3 {
                    node.planes[axis][0][lane] = bounds.min[axis];
                    node.planes[axis][1][lane] = bounds.max[axis];
                }
                if self.converter.is_leaf(child) {
                    let (place, kind) = self.leaf(child);
                    node.children[lane] = relative(unit, place, kind);
                } else {
                    waiting.push((child, Some((unit, lane))));
                }
            }
            *self.node_mut(unit) = node;
        }
    }

    fn node_mut(&mut self, unit: usize) -> &mut Node {
        let units = &mut self.output.units[unit..unit + NODE_UNITS];
        bytemuck::from_bytes_mut(bytemuck::cast_slice_mut(units))
    }

    /// Writes the leaf that the subtree at `place` becomes, and returns its place and kind.
    fn leaf(&mut self, place: u32) -> (usize, Kind) {
        let start = self.output.units.len();
        // Triangles, or else primitives of other kinds.
        let (mut numbers, mut corners) = ([0; LANES], [[0; 3]; LANES]);
        let (mut count, mut is_list) = (0, false);
        // At most eight leaves are below, or this one alone.
        let mut waiting = [place; LANES + 1];
        let mut height = 1;
        while height > 0 {
            height -= 1;
            let node = &self.tree.nodes[waiting[height] as usize];
            if !node.is_leaf() {
                waiting[height] = node.first_index + 1;
                waiting[height + 1] = node.first_index;
                height += 2;
                continue;
            }
            match (self.owner)(self.tree.primitive_indices[node.first_index as usize]) {
                Owner::Triangle(number, own) => {
                    (numbers[count], corners[count]) = (number, own);
                    count += 1;
                }
                Owner::Patch(shared, numbers) => {
                    self.patch(shared, numbers);
                    return (start, Kind::Patch);
                }
                Owner::Other(number) => {
                    (numbers[count], is_list) = (number, true);
                    count += 1;
                }
                Owner::Part(part) => return (part.unit, part.kind),
            }
        }
        let numbers = &numbers[..count];
        if !is_list {
            return (start, self.triangles(numbers, &corners[..count]));
        }
        self.output.list(numbers);
        (start, Kind::List)
    }

    /// A patch if the triangles have few vertices, else a soup.
    fn triangles(&mut self, numbers: &[u32], triangles: &[[u32; 3]]) -> Kind {
        let mut shared = SharedVertices::default();
        for (lane, &corners) in triangles.iter().enumerate() {
            if !shared.add(lane, corners) {
                self.soup(numbers, triangles);
                return Kind::Soup;
            }
        }
        self.patch(&shared, numbers);
        Kind::Patch
    }

    fn patch(&mut self, shared: &SharedVertices, numbers: &[u32]) {
        let SharedVertices { vertices, count, corners } = *shared;
        let mut positions = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            // Unused lanes repeat the first.
            let vertex = vertices[if lane < count as usize { lane } else { 0 }];
            let v = self.geometry.positions[vertex as usize];
            positions.iter_mut().zip(v.to_array()).for_each(|(row, x)| row[lane] = x);
        }
        let head = self.head(numbers, extent(&[positions], LANES));
        self.output.units.push(bytemuck::cast(Patch { positions, corners, spare: 0, head }));
    }

    fn soup(&mut self, numbers: &[u32], triangles: &[[u32; 3]]) {
        let mut corners = [[[0.0; LANES]; 3]; 3];
        for (lane, triangle) in triangles.iter().enumerate() {
            for (corner, &v) in triangle.iter().enumerate() {
                let v = self.geometry.positions[v as usize];
                for axis in 0..3 {
                    corners[corner][axis][lane] = v[axis];
                }
            }
        }
        let head = self.head(numbers, extent(&corners, triangles.len()));
        let leaf = Soup { corners, head, spare: [0; 20] };
        self.output.units.extend(bytemuck::cast::<_, [Unit; 3]>(leaf));
    }

    /// The head of a leaf of triangles with these numbers, which it appends.
    fn head(&mut self, numbers: &[u32], extent: f32) -> LeafHead {
        let first = self.output.first_number + self.output.numbers.len() as u32;
        self.output.numbers.extend_from_slice(numbers);
        let first_quad = self.geometry.triangles.len() as u32;
        let quads = numbers.iter().map(|&number| u32::from(number >= first_quad)).sum();
        LeafHead { first, count: numbers.len() as u32, quads, extent }
    }
}
