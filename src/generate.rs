//! `wavecrest generate`: writes a generated mesh to a PLY file.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::common::{choice, output, tell, whole, with_bar};
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::words::Size;
use wavecrest_scene::generate::{Model, Recipe, Written, write_ply};

/// Generate a large mesh as binary PLY, with the same bytes on every machine.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct GenerateArgs {
    /// Shape to generate
    #[arg(value_parser = choice::<Model>())]
    pub(crate) model: Model,

    /// PLY file to write
    #[arg(value_name = "OUTPUT", required_unless_present = "output")]
    pub(crate) file: Option<PathBuf>,

    /// PLY file to write, as an option
    #[arg(short, long, value_name = "OUTPUT", conflicts_with = "file")]
    pub(crate) output: Option<PathBuf>,

    /// Least number of triangles, such as 1000000, 18k or 2.5M
    #[arg(short = 'n', long, value_name = "COUNT", default_value = "1M", value_parser = count)]
    pub(crate) triangles: u64,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(0..=u64::MAX))]
    pub(crate) seed: u64,

    /// Displacement: a share of the radius (sphere, knot), or a height (terrain)
    #[arg(long, value_name = "NUMBER")]
    pub(crate) displacement: Option<f64>,

    /// Also write vertex normals
    #[arg(long)]
    pub(crate) normals: bool,

    /// Print no progress and no summary
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

impl GenerateArgs {
    /// The file to write, which must end in .ply: readers recognise the format by it.
    fn path(&self) -> Result<&Path> {
        let path = output(&self.output, &self.file, "mesh.ply")?;
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply")) {
            return Ok(path);
        }
        Err(Error::new(ErrorKind::Usage, "the name of the mesh must end in .ply")
            .in_file(path)
            .remedy(format!("name it {}", path.with_extension("ply").display())))
    }
}

/// Writes the requested mesh.
///
/// # Errors
/// If the recipe is invalid, or the file cannot be written.
pub(crate) fn run(args: &GenerateArgs) -> Result<()> {
    let GenerateArgs { model, triangles, seed, displacement, normals, .. } = *args;
    let usual = Recipe::new(model, triangles);
    let displacement = displacement.unwrap_or(usual.displacement);
    let (recipe, path) = (Recipe { seed, displacement, normals, ..usual }, args.path()?);
    let start = Instant::now();
    let template = "{wide_bar} {bytes} of {total_bytes}, {eta} left";
    let written = with_bar(args.quiet, template, |progress| write_ply(&recipe, path, progress));
    let Written { vertices, triangles, bytes } = written?;
    if !args.quiet {
        let (name, seconds, size) = (path.display(), start.elapsed().as_secs_f64(), Size(bytes));
        tell(&format!(
            "{name}: {vertices} vertices, {triangles} triangles, {bytes} bytes ({size}), {seconds:.2} s"
        ));
    }
    Ok(())
}

/// An integer, which may have `_` between digits, a decimal point, and `k`, `M` or `G` for
/// thousands, millions or thousands of millions.
fn count(text: &str) -> std::result::Result<u64, String> {
    let wrong = || "write a whole number, such as 1000000, 18k or 2.5M".to_owned();
    let (number, zeros) = match text.char_indices().last() {
        Some((at, 'k' | 'K')) => (&text[..at], 3),
        Some((at, 'm' | 'M')) => (&text[..at], 6),
        Some((at, 'g' | 'G')) => (&text[..at], 9),
        _ => (text, 0),
    };
    let (whole, part) = number.split_once('.').unwrap_or((number, ""));
    let part = part.trim_end_matches('0');
    if part.len() > zeros || whole.is_empty() {
        return Err(wrong());
    }
    // In digits, not in floats, so that the number is exact.
    let digits: String = whole.chars().filter(|c| *c != '_').chain(part.chars()).collect();
    let padded = format!("{digits}{}", "0".repeat(zeros - part.len()));
    if !padded.bytes().all(|b| b.is_ascii_digit()) {
        return Err(wrong());
    }
    padded.parse().map_err(|_| wrong())
}
