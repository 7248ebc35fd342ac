//! The outlines of turned bodies and the sections of mouldings, as tables.

/// A path of points, each a radius and a height in centimetres for a turned body, or an inset and a
/// height in metres for a moulding. A point of a turned body given twice is a sharp corner.
pub(super) type Profile = &'static [[f64; 2]];

macro_rules! profile {
    ($($radius:literal $height:literal),+) => { &[$([$radius, $height]),+] };
}

pub(super) const CUP: Profile = profile![
    0.1 0.3, 2.0 0.3, 2.1 0.0, 2.4 0.0, 2.5 0.5, 4.0 2.5, 4.2 7.2, 4.3 7.5, 4.0 7.5,
    3.8 3.0, 2.4 0.7, 0.1 0.6
];
pub(super) const PLATE: Profile = profile![
    0.1 0.2, 6.0 0.2, 6.1 0.0, 6.6 0.0, 6.8 0.4, 9.0 1.4, 12.8 2.0, 13.0 2.3,
    12.6 2.4, 9.0 1.9, 7.6 0.6, 0.1 0.5
];
pub(super) const BOWL: Profile = profile![
    0.1 0.4, 3.0 0.4, 3.2 0.0, 3.6 0.0, 3.8 0.8, 8.0 2.5, 9.4 7.0, 9.4 7.4, 9.0 7.2,
    7.0 2.0, 0.1 0.9
];
pub(super) const VASE: Profile = profile![
    0.1 0.2, 3.8 0.2, 4.0 0.0, 4.4 0.2, 4.6 3.0, 9.5 9.0, 7.0 18.0, 3.0 20.0,
    3.4 24.0, 5.2 26.0, 4.8 26.2, 2.6 20.5, 7.0 14.0, 0.1 2.0
];
pub(super) const POT_OF_TEA: Profile = profile![
    0.1 0.3, 4.5 0.3, 4.7 0.0, 5.2 0.0, 5.4 0.8, 9.6 3.0, 9.6 10.0, 5.0 12.4,
    4.8 12.4, 4.8 12.4, 4.4 12.8, 1.4 13.8, 0.7 14.0, 0.7 14.6, 1.5 15.2, 1.2 16.2,
    0.1 16.4
];
pub(super) const GLASS: Profile = profile![
    0.1 0.0, 3.2 0.0, 3.4 0.2, 0.5 0.6, 0.4 2.0, 0.4 7.0, 1.2 8.0, 4.2 10.0, 3.4 17.0,
    3.3 17.1, 3.2 17.0, 4.0 10.2, 0.1 8.6
];
pub(super) const KNOB: Profile = profile![
    0.7 0.0, 0.8 0.0, 0.5 0.5, 0.6 1.2, 1.6 1.6, 1.3 2.4, 0.1 2.5
];
pub(super) const CANDLESTICK: Profile = profile![
    0.1 0.0, 4.4 0.0, 4.6 0.3, 4.0 1.0, 1.2 1.4, 0.8 3.0, 1.8 4.2, 0.7 5.4, 0.7 12.0,
    1.5 13.0, 0.8 14.0, 2.0 16.0, 2.0 16.4, 1.2 16.4, 0.1 16.0
];
pub(super) const CANDLE: Profile = profile![
    0.1 0.0, 1.1 0.0, 1.1 0.0, 1.1 18.0, 1.0 18.2, 0.5 17.8, 0.1 17.9, 0.05 18.8
];
pub(super) const POT: Profile = profile![
    0.1 0.0, 12.0 0.0, 12.4 0.4, 16.0 22.0, 16.0 22.0, 17.6 22.4, 18.2 26.0,
    17.6 28.0, 16.4 28.0, 15.6 24.0, 15.4 20.0, 0.1 20.0
];
pub(super) const SOIL: Profile = profile![0.1 21.0, 15.0 21.0, 15.4 24.0, 0.1 25.5];
pub(super) const LEG: Profile = profile![
    0.1 0.0, 1.6 0.0, 2.2 2.0, 1.4 5.0, 2.0 6.0, 2.0 6.0, 2.6 20.0, 3.2 34.0,
    2.0 37.0, 3.4 39.0, 2.0 41.0, 3.0 42.5, 3.0 42.5, 3.0 56.0, 3.0 56.0, 2.6 64.0,
    0.1 64.0
];
pub(super) const HANGING_SHADE: Profile = profile![
    0.6 19.5, 3.0 19.5, 10.0 18.0, 22.0 9.0, 25.6 -0.2, 26.2 -0.4, 26.0 0.0, 23.0 9.0,
    10.0 19.0, 3.0 21.0, 2.0 25.0, 0.6 26.0
];
pub(super) const SHADE: Profile = profile![
    12.9 26.8, 13.1 26.6, 20.7 0.0, 21.0 -0.3, 21.0 0.0, 13.4 27.0, 13.2 27.2,
    13.0 27.0
];
pub(super) const STAND: Profile = profile![
    0.1 0.0, 15.0 0.0, 15.5 0.6, 14.0 1.6, 3.0 2.4, 1.2 6.0, 1.2 60.0, 2.6 62.0,
    1.2 64.0, 1.2 120.0, 2.8 123.0, 1.2 126.0, 1.0 140.0, 2.2 142.0, 0.2 148.0
];

/// The front of a cupboard's door: a frame with a raised field, on a leaf 20 mm thick.
pub(super) const DOOR: Profile = profile![
    0.0 0.0, 0.0 0.017, 0.003 0.02, 0.055 0.02, 0.06 0.016, 0.066 0.011, 0.078 0.011,
    0.1 0.018
];
/// The front of a drawer: bevelled, with a groove.
pub(super) const DRAWER: Profile = profile![
    0.0 0.0, 0.0 0.017, 0.003 0.02, 0.022 0.02, 0.025 0.017, 0.028 0.017, 0.031 0.02
];
pub(super) const WINDOW_FRAME: Profile = profile![
    0.0 0.0, 0.0 0.02, 0.045 0.02, 0.055 0.012, 0.055 -0.03
];
/// The moulding around an opening.
pub(super) const ARCHITRAVE: Profile = profile![
    0.0 0.0, 0.0 0.014, 0.005 0.02, 0.02 0.02, 0.024 0.014,
    0.062 0.014, 0.07 0.008, 0.07 0.0
];
pub(super) const PICTURE_FRAME: Profile = profile![
    0.0 0.0, 0.0 0.02, 0.006 0.026, 0.02 0.02, 0.03 0.022, 0.034 0.015, 0.036 0.008
];
/// The mount of a picture, within its frame; and the print.
pub(super) const MOUNT: Profile = profile![0.03 0.008, 0.11 0.008, 0.113 0.006];
pub(super) const PRINT: Profile = profile![0.113 0.006];
/// A plain face.
pub(super) const PLAIN: Profile = profile![0.0 0.0];
