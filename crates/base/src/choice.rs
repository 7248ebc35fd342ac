//! Enumerations whose values a user selects by name.

/// A value selected by name, on the command line and in statistics.
pub trait Choice: Copy + Send + Sync + 'static {
    /// Every value, in the listed order.
    const VALUES: &'static [Self];

    /// The name of the value.
    fn name(self) -> &'static str;

    /// Its meaning, in a line or two.
    fn help(self) -> &'static str;
}

/// Declares an enumeration that implements [`Choice`], with a name for each value and its
/// documentation as help.
///
/// ```
/// wavecrest_base::choices! {
///     /// The side of the image across which the angle of view is measured.
///     #[derive(Clone, Copy, Debug, PartialEq)]
///     pub enum FovAxis {
///         /// The width.
///         X = "x",
///         /// The height.
///         Y = "y",
///     }
/// }
/// use wavecrest_base::choice::Choice;
/// assert_eq!(FovAxis::ALL.map(FovAxis::name), ["x", "y"]);
/// assert_eq!(FovAxis::X.help(), "The width.");
/// ```
#[macro_export]
macro_rules! choices {
    (
        $(#[$meta:meta])*
        $vis:vis enum $kind:ident {
            $( $(#[doc = $doc:literal])+ $(#[$other:meta])* $value:ident = $name:literal, )+
        }
    ) => {
        $(#[$meta])*
        $vis enum $kind {
            $( $(#[doc = $doc])+ $(#[$other])* $value, )+
        }

        impl $kind {
            /// Every value, in the listed order.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$value),+];

            /// The name of the value.
            pub const fn name(self) -> &'static str {
                match self {
                    $( Self::$value => $name, )+
                }
            }
        }

        impl $crate::choice::Choice for $kind {
            const VALUES: &'static [Self] = &Self::ALL;

            fn name(self) -> &'static str {
                Self::name(self)
            }

            fn help(self) -> &'static str {
                match self {
                    $( Self::$value => concat!($($doc),+).trim_ascii(), )+
                }
            }
        }

        impl std::fmt::Display for $kind {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }
    };
}
