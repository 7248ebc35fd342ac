//! Options with named values.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use wavecrest_base::choice::Choice;

/// A parser of named values; the help lists each with its meaning.
pub(crate) fn choice<T: Choice>() -> impl TypedValueParser<Value = T> {
    let listed = T::VALUES.iter().map(|value| {
        let help = value.help().trim_end_matches('.');
        PossibleValue::new(value.name()).help(help).aliases(value.old_names())
    });
    PossibleValuesParser::new(listed)
        .try_map(|name| T::by_name(&name).ok_or("not one of the possible values"))
}
