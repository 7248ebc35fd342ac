//! The proof: what it accepts, and what it must not.

use bytemuck::Zeroable;

use super::*;

fn node(children: &[u32]) -> [Unit; 2] {
    let mut node = Node { count: children.len() as u32, ..Node::EMPTY };
    node.children[..children.len()].copy_from_slice(children);
    bytemuck::cast(node)
}

fn list(numbers: &[u32]) -> Unit {
    let mut unit = Unit::zeroed();
    unit.0[0] = numbers.len() as u32;
    unit.0[1..=numbers.len()].copy_from_slice(numbers);
    unit
}

fn patch(first: u32, count: u32) -> Unit {
    let mut patch = Patch::zeroed();
    (patch.head.first, patch.head.count) = (first, count);
    bytemuck::cast(patch)
}

fn prove(units: &[Unit], numbers: usize) -> Option<TreeContents> {
    let numbers = (0..numbers).map(|_| AtomicU32::new(0)).collect();
    let mut all = Units::zeroed(units.len(), units.len());
    all.as_mut_slice().copy_from_slice(units);
    Some(Arena::new(all, numbers, root_of(Kind::Node))?.1)
}

#[test]
fn a_sound_tree_is_proved_and_counted() {
    let patch = patch(2, 3);
    let [a, b] = node(&[relative(0, 2, Kind::List), relative(0, 3, Kind::Patch)]);
    let census = prove(&[a, b, list(&[7, 8]), patch], 5).expect("it is sound");
    let expected = TreeContents {
        nodes: 1,
        children: 2,
        patches: 1,
        soups: 0,
        lists: 1,
        triangles: 3,
        depth: 1,
    };
    assert_eq!(census, expected);
}

#[test]
fn nothing_that_leads_astray_is_proved() {
    let under = |child: u32, rest: &[Unit]| {
        let [a, b] = node(&[child]);
        prove(&[&[a, b], rest].concat(), 4)
    };
    let leaf = relative(0, 2, Kind::Patch);
    assert!(under(leaf, &[patch(0, 4)]).is_some());
    assert!(under(leaf, &[]).is_none(), "beyond the end");
    assert!(under(leaf, &[patch(1, 4)]).is_none(), "numbers beyond the end");
    assert!(under(leaf, &[patch(u32::MAX, 4)]).is_none(), "numbers that overflow");
    assert!(under(leaf, &[patch(0, 9)]).is_none(), "more triangles than lanes");
    assert!(under(relative(0, 2, Kind::Soup), &[patch(0, 4)]).is_none(), "half a soup");
    assert!(under(relative(0, 2, Kind::Node), &[patch(0, 4)]).is_none(), "half a node");
    assert!(under(relative(0, 0, Kind::Node), &[]).is_none(), "a circle");
    assert!(under(relative(0, 1, Kind::Patch), &[]).is_none(), "within the node itself");
    assert!(under(u32::MAX, &[]).is_none(), "far away");
    let mut long = list(&[1]);
    long.0[0] = 32;
    assert!(under(relative(0, 2, Kind::List), &[long]).is_none(), "a list too long");
    let mut absent: Node = bytemuck::cast(node(&[leaf]));
    absent.children[5] = leaf;
    let [a, b]: [Unit; 2] = bytemuck::cast(absent);
    assert!(prove(&[a, b, patch(0, 4)], 4).is_none(), "an absent child leads somewhere");
}

/// A part is appended while others read: what they see does not change.
#[test]
fn parts_are_appended_where_there_is_room_and_where_they_are_sound() {
    let [a, b] = node(&[relative(0, 2, Kind::List)]);
    let mut all = Units::zeroed(4, 3);
    all.as_mut_slice().copy_from_slice(&[a, b, list(&[1])]);
    let numbers = (0..4).map(|_| AtomicU32::new(0)).collect();
    let (arena, _) = Arena::new(all, numbers, root_of(Kind::Node)).expect("it is sound");
    let before = arena.view();
    assert!(arena.extend(&[a, b], Kind::Node, 1).is_none(), "a child beyond the end");
    assert!(arena.extend(&[a, b, list(&[2])], Kind::Node, 1).is_none(), "no room");
    let (place, census) = arena.extend(&[list(&[2, 3])], Kind::List, 0).expect("it is sound");
    assert_eq!((place.kind(), census.lists), (Kind::List, 1));
    assert_eq!(before.list(place), [2, 3]);
    assert!(arena.extend(&[list(&[2])], Kind::List, 0).is_none(), "it is full");
}
