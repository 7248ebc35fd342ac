//! Finds stray parts: a few triangles far from all the rest, as scans have them. A view of everything
//! would show the rest as a dot.

use glam::DVec3;

use super::{MeshInstance, Scenery, shown};
use crate::systems::bounds::{EMPTY, Ends, joined};
use wavecrest_base::parallel;

/// Largest share of the number and of the area of triangles that stray parts have.
const FEW: f64 = 0.01;
const SMALL: f64 = 0.05;
/// Smallest length of everything, in lengths of the rest.
const LONGER: f64 = 2.0;
/// Share of the points beyond each end that does not tell where most of them are.
const OUTERMOST: f64 = 0.01;
/// Number of points that tell it.
const SAMPLES: usize = 1 << 14;
/// Width of the free space around most points and what is near them, in lengths.
const GAP: f64 = 0.5;
/// Most steps from what is near to what is near to that.
const STEPS: usize = 16;

/// A number of triangles with their area and the ends of the box around them.
#[derive(Clone, Copy)]
struct Part {
    count: usize,
    area: f64,
    ends: Ends,
}

impl Part {
    const NONE: Self = Self { count: 0, area: 0.0, ends: EMPTY };

    fn with(self, other: Self) -> Self {
        let (count, area) = (self.count + other.count, self.area + other.area);
        Self { count, area, ends: joined(self.ends, other.ends) }
    }

    /// The visible triangles of these contents that `is` holds for.
    fn of(contents: &Scenery<'_>, is: impl Fn(&[DVec3; 3]) -> bool + Sync) -> Self {
        let one = |corners: [DVec3; 3]| {
            let [a, b, c] = corners;
            let area = (b - a).cross(c - a).length();
            match area > 0.0 && is(&corners) {
                true => Self { count: 1, area, ends: ends_of(&corners) },
                false => Self::NONE,
            }
        };
        let of = |instance: &MeshInstance<'_>| {
            let of = |i: usize| one(instance.corners(instance.triangles[i]));
            parallel::reduce(instance.triangles.len(), Self::NONE, of, Self::with)
        };
        contents.all.iter().map(of).fold(Self::NONE, Self::with)
    }
}

/// Hides the stray parts of the `contents`; returns the number of their triangles.
pub(super) fn hide(contents: &mut Scenery<'_>) -> usize {
    let Some(most) = most(contents) else { return 0 };
    let mut near = grown(most);
    let mut rest = Part::NONE;
    for _ in 0..STEPS {
        if joined(near, contents.ends) == near {
            return 0;
        }
        rest = Part::of(contents, |corners| touches(corners, &near));
        let wider = joined(near, grown(rest.ends));
        if wider == std::mem::replace(&mut near, wider) {
            break;
        }
    }
    let strays = Part::of(contents, |corners| !touches(corners, &near));
    let are_few = strays.count as f64 <= FEW * rest.count as f64;
    let is_far = length(&contents.ends) >= LONGER * length(&rest.ends);
    if strays.count == 0 || !are_few || strays.area > SMALL * rest.area || !is_far {
        return 0;
    }
    for instance in &mut contents.all {
        instance.seen = shown(instance.points, instance.triangles, |triangle| {
            touches(&instance.corners(triangle), &near)
        });
    }
    strays.count
}

/// The ends of the box around most points. `None` where not all of them have triangles.
fn most(contents: &Scenery<'_>) -> Option<Ends> {
    if contents.all.iter().any(|instance| instance.triangles.is_empty()) {
        return None;
    }
    let count: usize = contents.all.iter().map(|instance| instance.triangles.len()).sum();
    let step = count.div_ceil(SAMPLES).max(1);
    let of = |instance: &MeshInstance<'_>| -> Vec<DVec3> {
        instance.triangles.iter().step_by(step).map(|one| instance.corners(*one)[0]).collect()
    };
    let points: Vec<DVec3> = contents.all.iter().flat_map(of).collect();
    let skipped = (points.len() as f64 * OUTERMOST) as usize;
    let mut ends = EMPTY;
    for axis in 0..3 {
        let mut along: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        along.sort_by(f64::total_cmp);
        ends[0][axis] = *along.get(skipped)?;
        ends[1][axis] = *along.get(along.len() - 1 - skipped)?;
    }
    Some(ends)
}

fn ends_of(corners: &[DVec3; 3]) -> Ends {
    corners.iter().fold(EMPTY, |ends, &corner| joined(ends, [corner; 2]))
}

/// The longest side of a box.
fn length([low, high]: &Ends) -> f64 {
    (*high - *low).max_element()
}

/// The box with free space around it.
fn grown(ends: Ends) -> Ends {
    let gap = DVec3::splat(GAP * length(&ends));
    [ends[0] - gap, ends[1] + gap]
}

/// Whether the box around a triangle touches another.
fn touches(corners: &[DVec3; 3], [low, high]: &Ends) -> bool {
    let [from, to] = ends_of(corners);
    from.cmple(*high).all() && to.cmpge(*low).all()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{boxes, contents};
    use super::*;

    /// The length of what is framed, of 400 blocks in a row of 20 and others; and the number of
    /// triangles left out.
    fn framed(others: &[([f32; 3], [f32; 3])]) -> (f64, usize) {
        let block = |i: u16| {
            let at = f32::from(i) / 20.0;
            ([at, 0.0, 0.0], [at + 0.04, 1.0, 1.0])
        };
        let mut all: Vec<_> = (0..400).map(block).collect();
        all.extend(others);
        let mesh = boxes(&all);
        let found = contents(&mesh);
        (length(&found.ends).ceil(), found.strays)
    }

    #[test]
    fn a_few_small_parts_far_away_are_left_out() {
        let small = |at: f32| ([at, 0.0, 0.0], [at + 0.1, 0.1, 0.1]);
        assert_eq!(framed(&[small(200.0), small(-90.0)]), (20.0, 24));
        assert_eq!(framed(&[small(30.0)]).1, 0, "not far");
        assert_eq!(framed(&[([200.0, 0.0, 0.0], [220.0, 20.0, 20.0])]).1, 0, "not small");
        let many: Vec<_> = (0..10_u8).map(|i| small(200.0 + f32::from(i))).collect();
        assert_eq!(framed(&many).1, 0, "not few");
        assert_eq!(framed(&[([10.0, 0.0, 0.0], [200.0, 0.1, 0.1])]).1, 0, "connected");
    }
}
