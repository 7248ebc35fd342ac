//! Enumerations whose values a user selects by name.

/// A value selected by name, on the command line and in statistics.
pub trait Choice: Copy + Send + Sync + 'static {
    /// Every value, in the listed order.
    const VALUES: &'static [Self];

    /// The name of the value.
    fn name(self) -> &'static str;

    /// Names that files and commands of older versions may have for the value; nothing lists them.
    fn old_names(self) -> &'static [&'static str];

    /// Its meaning, in a line or two.
    fn help(self) -> &'static str;

    /// The value with this name, or once with it.
    fn by_name(name: &str) -> Option<Self> {
        let is_named = |value: &Self| value.name() == name || value.old_names().contains(&name);
        Self::VALUES.iter().copied().find(is_named)
    }
}

/// Declares an enumeration that implements [`Choice`], with a name for each value and its
/// documentation as help. Old names may follow: `X = "x" | "horizontal"`.
///
/// ```
/// wavecrest_base::choices! {
///     /// The side of the image across which the angle of view is measured.
///     #[derive(Clone, Copy, Debug, PartialEq)]
///     pub enum FovAxis {
///         /// The width.
///         X = "x" | "horizontal",
///         /// The height.
///         Y = "y",
///     }
/// }
/// use wavecrest_base::choice::Choice;
/// assert_eq!(FovAxis::ALL.map(FovAxis::name), ["x", "y"]);
/// assert_eq!(FovAxis::X.help(), "The width.");
/// assert_eq!(FovAxis::by_name("horizontal"), Some(FovAxis::X));
/// ```
#[macro_export]
macro_rules! choices {
    (
        $(#[$meta:meta])*
        $vis:vis enum $kind:ident {
            $(
                $(#[doc = $doc:literal])+ $(#[$other:meta])*
                $value:ident = $name:literal $(| $old:literal)*,
            )+
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

            fn old_names(self) -> &'static [&'static str] {
                match self {
                    $( Self::$value => &[$($old),*], )+
                }
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
