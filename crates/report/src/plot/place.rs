//! An axis in place: which values it shows, where, and how it is marked. plotters asks it.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use super::ticks::{Tick, Ticks, linear, logarithmic};
use super::{Axis, Scale};

/// Room beyond the outermost values, as a share of what they span.
const MARGIN: f64 = 0.04;

/// Linear values that span less than this share of their size are shown as if they spanned that:
/// closer numbers have no round ones between them.
const NARROWEST: f64 = 1e-6;

/// Linear values no larger than this are shown as 0: so close to it numbers have fewer digits.
const NOTHING: f64 = 1e-300;

/// As many decades an axis shows at least: one, about a single value.
const FEWEST_DECADES: f64 = 0.02;

/// Values become positions, and positions places. A position is the value, its decimal logarithm on
/// a logarithmic axis, or the place of its name, counted downward.
#[derive(Clone, Debug)]
pub(super) struct Place<'a> {
    scale: &'a Scale,
    low: f64,
    high: f64,
    ticks: Ticks,
}

impl<'a> Place<'a> {
    /// A place for all of `values` that have one.
    pub(super) fn new(axis: &'a Axis, values: impl Iterator<Item = f64>) -> Self {
        let scale = &axis.scale;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for position in values.filter_map(|value| position(scale, value)) {
            (low, high) = (low.min(position), high.max(position));
        }
        let (low, high) = match scale {
            Scale::Names(names) => (0.5 - names.len().max(1) as f64, 0.5),
            _ if low > high => (0.0, 1.0),
            Scale::Log => logarithmic_range(low, high),
            Scale::Linear => linear_range(low, high),
            Scale::FromZero => from_zero(low, high),
        };
        Self { scale, low, high, ticks: Ticks::default() }
    }

    /// The position of a value; `None` where the axis has no place for it.
    pub(super) fn position(&self, value: f64) -> Option<f64> {
        position(self.scale, value)
    }

    /// The positions of the two ends.
    pub(super) fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Chooses marks with at most `most` labels.
    pub(super) fn mark(&mut self, most: usize) {
        self.ticks = match self.scale {
            Scale::Log => logarithmic(self.low, self.high, most),
            Scale::Linear | Scale::FromZero => linear(self.low, self.high, most),
            Scale::Names(names) => {
                let tick =
                    |(n, name): (usize, &String)| Tick { at: -(n as f64), label: name.clone() };
                Ticks { major: names.iter().enumerate().map(tick).collect(), minor: Vec::new() }
            }
        };
    }

    /// The labels chosen.
    pub(super) fn labels(&mut self) -> impl Iterator<Item = &mut String> {
        self.ticks.major.iter_mut().map(|tick| &mut tick.label)
    }
}

/// The position of a value on such a scale; `None` where there is none.
pub(super) fn position(scale: &Scale, value: f64) -> Option<f64> {
    match scale {
        Scale::Log => (value > 0.0 && value.is_finite()).then(|| libm::log10(value)),
        Scale::Linear | Scale::FromZero => value.is_finite().then_some(value),
        Scale::Names(names) => {
            (0..names.len()).contains(&(value as usize)).then_some(-value).filter(|_| value >= 0.0)
        }
    }
}

/// The ends of a logarithmic axis for positions from `low` to `high`.
fn logarithmic_range(low: f64, high: f64) -> (f64, f64) {
    let margin = match high - low {
        ..FEWEST_DECADES => 0.5,
        span => span * MARGIN,
    };
    (low - margin, high + margin)
}

/// The ends of a linear axis for values from `low` to `high`.
fn linear_range(low: f64, high: f64) -> (f64, f64) {
    // Halves, as the span of the largest numbers is none.
    let (half, size) = (high / 2.0 - low / 2.0, low.abs().max(high.abs()));
    let margin = match half {
        _ if size <= NOTHING => 1.0,
        _ if half < NARROWEST / 2.0 * size => 0.1 * size,
        half => 2.0 * MARGIN * half,
    };
    ((low - margin).max(-f64::MAX), (high + margin).min(f64::MAX))
}

/// As [`linear_range`], with 0 at the end or in between.
fn from_zero(low: f64, high: f64) -> (f64, f64) {
    if low.abs().max(high.abs()) <= NOTHING {
        return (0.0, 1.0);
    }
    let (below, above) = linear_range(low.min(0.0), high.max(0.0));
    (if low < 0.0 { below } else { 0.0 }, if high > 0.0 { above } else { 0.0 })
}

impl Ranged for Place<'_> {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, position: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (position / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0);
        from + libm::round(f64::from(to - from) * share) as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            return self.ticks.minor.clone();
        }
        self.ticks.major.iter().map(|tick| tick.at).collect()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Place<'_> {
    fn format_ext(&self, position: &f64) -> String {
        let found = self.ticks.major.iter().find(|tick| tick.at == *position);
        found.map(|tick| tick.label.clone()).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(scale: Scale, values: &[f64]) -> [f64; 2] {
        Place::new(&Axis::new("", "", scale), values.iter().copied()).ends()
    }

    #[test]
    fn every_value_lies_between_ends_that_are_apart() {
        for values in [
            &[][..],
            &[0.0],
            &[7.0],
            &[-7.0],
            &[1.25, 1.25 + f64::EPSILON],
            &[0.0, 1.0],
            &[-f64::MAX, f64::MAX],
            &[5e-324],
            &[1e300, f64::NAN, 1e-300, f64::INFINITY],
        ] {
            for scale in [Scale::Linear, Scale::FromZero, Scale::Log] {
                let axis = Axis::new("", "", scale);
                let place = Place::new(&axis, values.iter().copied());
                let [low, high] = place.ends();
                assert!(low < high && low.is_finite() && high.is_finite(), "{axis:?} {values:?}");
                for position in values.iter().filter_map(|value| place.position(*value)) {
                    let at = place.map(&position, (0, 1000));
                    assert!((0..=1000).contains(&at), "{axis:?} {values:?}: {at}");
                }
                assert_eq!((place.map(&low, (9, 50)), place.map(&high, (9, 50))), (9, 50));
            }
        }
    }

    #[test]
    fn zero_is_in_sight_where_it_is_to_be() {
        assert_eq!(place(Scale::FromZero, &[3.0, 4.0])[0], 0.0);
        assert_eq!(place(Scale::FromZero, &[-3.0, -4.0])[1], 0.0);
        assert_eq!(place(Scale::FromZero, &[0.0]), [0.0, 1.0]);
        assert!(place(Scale::Linear, &[3.0, 4.0])[0] > 2.0);
    }

    #[test]
    fn a_logarithmic_axis_has_no_place_for_zero() {
        let axis = Axis::new("", "", Scale::Log);
        let place = Place::new(&axis, [0.0, -1.0, 10.0, 1000.0].into_iter());
        assert_eq!(place.ends(), [1.0 - 0.08, 3.0 + 0.08]);
        assert_eq!([0.0, -1.0, f64::NAN].map(|value| place.position(value)), [None; 3]);
        assert_eq!(place.position(100.0), Some(2.0));
    }

    #[test]
    fn names_run_downward() {
        let axis = Axis::new("", "", Scale::Names(vec!["a".to_owned(), "b".to_owned()]));
        let mut place = Place::new(&axis, std::iter::empty());
        place.mark(1);
        assert_eq!(place.labels().map(|name| name.clone()).collect::<String>(), "ab");
        let at = |value| place.map(&place.position(value).unwrap(), (100, 0));
        assert_eq!((at(0.0), at(1.0)), (25, 75));
        assert_eq!([2.0, -1.0, f64::NAN].map(|value| place.position(value)), [None; 3]);
    }
}
