//! Options with named values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use wavecrest_base::choice::Choice;

/// A parser of named values; the help lists each with its meaning.
pub(crate) fn choice<T: Choice>() -> impl TypedValueParser<Value = T> {
    let listed = T::VALUES
        .iter()
        .map(|value| PossibleValue::new(value.name()).help(value.help().trim_end_matches('.')));
    PossibleValuesParser::new(listed)
        .try_map(|name| by_name(&name).ok_or("not one of the possible values"))
}

/// The value with that name.
pub(crate) fn by_name<T: Choice>(name: &str) -> Option<T> {
    T::VALUES.iter().copied().find(|value| value.name() == name)
}
