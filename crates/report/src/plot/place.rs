//! The position of an axis: its range of values, its pixels, and its ticks.

use super::ticks::{Tick, Ticks, linear, logarithmic};
use super::{Axis, Scale};

/// Margin beyond the outermost values, as a share of their span.
const MARGIN: f64 = 0.04;

/// Linear values that span less than this share of their size are shown as if they spanned that:
/// there are no round numbers between closer values.
const NARROWEST_SPAN: f64 = 1e-6;

/// Linear values up to this size are shown as 0: smaller numbers have fewer digits.
const SHOWN_AS_ZERO: f64 = 1e-300;

/// Positions on a logarithmic axis that span less than this are shown within a decade.
const NARROWEST_DECADES: f64 = 0.02;

/// Maps values to positions, and positions to pixels. A position is the value, its decimal
/// logarithm on a logarithmic axis, or the row of its name, counted downward.
#[derive(Clone, Debug)]
pub(super) struct Place<'a> {
    pub axis: &'a Axis,
    low: f64,
    high: f64,
    pub ticks: Ticks,
    /// The pixels of the two ends.
    pub pixels: [f64; 2],
}

impl<'a> Place<'a> {
    /// A range for all of `values` that can be shown.
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
        Self { axis, low, high, ticks: Ticks::default(), pixels: [0.0; 2] }
    }

    /// The pixel of a value; `None` if the axis cannot show it.
    pub(super) fn pixel(&self, value: f64) -> Option<f64> {
        Some(self.pixel_of(position(&self.axis.scale, value)?))
    }

    /// The pixel of an end of an interval: the end of the axis if it is infinite or cannot be
    /// shown.
    pub(super) fn pixel_of_end(&self, value: f64) -> Option<f64> {
        match value {
            _ if value.is_nan() => None,
            f64::INFINITY => Some(self.pixels[1]),
            _ => Some(self.pixel(value).unwrap_or(self.pixels[0])),
        }
    }

    /// The pixel of a position.
    pub(super) fn pixel_of(&self, position: f64) -> f64 {
        // Halved, as the span of the largest numbers would overflow.
        let share = (position / 2.0 - self.low / 2.0) / (self.high / 2.0 - self.low / 2.0);
        let [from, to] = self.pixels;
        from + (to - from) * share
    }

    /// Pixels per unit of position.
    pub(super) fn pixels_in_unit(&self) -> f64 {
        (self.pixels[1] - self.pixels[0]) / (self.high - self.low)
    }

    /// Chooses ticks with at most `most` labels.
    pub(super) fn mark(&mut self, most: usize) {
        self.ticks = match &self.axis.scale {
            Scale::Log => logarithmic(self.low, self.high, most),
            Scale::Linear | Scale::FromZero => linear(self.low, self.high, most),
            Scale::Names(names) => {
                let tick =
                    |(n, name): (usize, &String)| Tick { at: -(n as f64), label: name.clone() };
                Ticks { major: names.iter().enumerate().map(tick).collect(), minor: Vec::new() }
            }
        };
    }
}

/// The position of a value on this scale, if any.
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
        ..NARROWEST_DECADES => 0.5,
        span => span * MARGIN,
    };
    (low - margin, high + margin)
}

/// The ends of a linear axis for values from `low` to `high`.
fn linear_range(low: f64, high: f64) -> (f64, f64) {
    let (half, size) = (high / 2.0 - low / 2.0, low.abs().max(high.abs()));
    let margin = match half {
        _ if size <= SHOWN_AS_ZERO => 1.0,
        _ if half < NARROWEST_SPAN / 2.0 * size => 0.1 * size,
        half => 2.0 * MARGIN * half,
    };
    ((low - margin).max(-f64::MAX), (high + margin).min(f64::MAX))
}

/// As [`linear_range`], with 0 at the end or in between.
fn from_zero(low: f64, high: f64) -> (f64, f64) {
    if low.abs().max(high.abs()) <= SHOWN_AS_ZERO {
        return (0.0, 1.0);
    }
    let (below, above) = linear_range(low.min(0.0), high.max(0.0));
    (if low < 0.0 { below } else { 0.0 }, if high > 0.0 { above } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(scale: Scale, values: &[f64]) -> [f64; 2] {
        let axis = Axis::new("", "", scale);
        let place = Place::new(&axis, values.iter().copied());
        [place.low, place.high]
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
                let mut place = Place::new(&axis, values.iter().copied());
                let (low, high) = (place.low, place.high);
                assert!(low < high && low.is_finite() && high.is_finite(), "{axis:?} {values:?}");
                place.pixels = [9.0, 50.0];
                for at in values.iter().filter_map(|value| place.pixel(*value)) {
                    assert!((9.0..=50.0).contains(&at), "{axis:?} {values:?}: {at}");
                }
                assert_eq!((place.pixel_of(low), place.pixel_of(high)), (9.0, 50.0));
            }
        }
    }

    #[test]
    fn zero_is_in_sight_where_it_is_to_be() {
        assert_eq!(ends(Scale::FromZero, &[3.0, 4.0])[0], 0.0);
        assert_eq!(ends(Scale::FromZero, &[-3.0, -4.0])[1], 0.0);
        assert_eq!(ends(Scale::FromZero, &[0.0]), [0.0, 1.0]);
        assert!(ends(Scale::Linear, &[3.0, 4.0])[0] > 2.0);
    }

    #[test]
    fn a_logarithmic_axis_has_no_place_for_zero() {
        let values = [0.0, -1.0, 10.0, 1000.0];
        assert_eq!(ends(Scale::Log, &values), [1.0 - 0.08, 3.0 + 0.08]);
        assert_eq!([0.0, -1.0, f64::NAN].map(|value| position(&Scale::Log, value)), [None; 3]);
        assert_eq!(position(&Scale::Log, 100.0), Some(2.0));
    }

    #[test]
    fn ends_of_intervals_are_on_the_axis() {
        let axis = Axis::new("", "", Scale::Log);
        let mut place = Place::new(&axis, [1.0, 10.0].into_iter());
        place.pixels = [100.0, 0.0];
        let found = [0.0, f64::INFINITY, f64::NAN].map(|value| place.pixel_of_end(value));
        assert_eq!(found, [Some(100.0), Some(0.0), None]);
    }

    #[test]
    fn names_run_downward() {
        let axis = Axis::new("", "", Scale::Names(vec!["a".to_owned(), "b".to_owned()]));
        let mut place = Place::new(&axis, std::iter::empty());
        place.mark(1);
        assert_eq!(place.ticks.major.iter().map(|tick| &*tick.label).collect::<String>(), "ab");
        place.pixels = [100.0, 0.0];
        assert_eq!([0.0, 1.0].map(|value| place.pixel(value)), [Some(25.0), Some(75.0)]);
        assert_eq!([2.0, -1.0, f64::NAN].map(|value| place.pixel(value)), [None; 3]);
    }
}
