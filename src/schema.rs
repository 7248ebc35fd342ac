//! `schema`: the scene format as a JSON Schema.

use super::common::{print, to_json};
use wavecrest_base::error::Result;
use wavecrest_scene::json_schema;

/// Print the JSON Schema of scene files, for editors.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct SchemaArgs {}

/// Prints the schema.
///
/// # Errors
/// If standard output cannot be written to.
pub(crate) fn run(_: &SchemaArgs) -> Result<()> {
    print(&to_json(&json_schema())?)
}
