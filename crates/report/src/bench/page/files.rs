//! The charts of a page as files.

use std::path::Path;

use crate::files::write_text;
use crate::page::{Block, Page};
use crate::plot::figure::Figure;
use wavecrest_base::error::{Error, Result};

/// Width of charts in pixels, as files.
const CHART_WIDTH: u32 = 1440;

/// Writes every chart of the `page` to `folder`, which is made, as SVG, PNG and CSV. Names begin
/// with that of the scene.
///
/// # Errors
/// If a file cannot be written.
pub fn write_figures(page: &Page, folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::io("cannot create the folder", folder, e))?;
    for section in &page.sections {
        let scene = Path::new(section.title.trim_matches('`')).file_stem().unwrap_or_default();
        let mut heading = "";
        for block in &section.blocks {
            match block {
                Block::Heading(words) => heading = words,
                Block::Chart(chart) => {
                    figure_file(chart, folder, &[&scene.to_string_lossy(), &chart.title])?
                }
                Block::Bars(bars) => {
                    let names = [&scene.to_string_lossy(), heading, &bars.title];
                    figure_file(bars, folder, &names)?;
                }
                _ => {}
            }
        }
    }
    Ok(())
}

fn figure_file(figure: &impl Figure, folder: &Path, names: &[&str]) -> Result<()> {
    let name = names.join(" ");
    let words = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let stem = folder.join(words.collect::<Vec<_>>().join("-").to_lowercase());
    write_text(&stem.with_extension("svg"), &figure.svg())?;
    write_text(&stem.with_extension("csv"), &figure.csv())?;
    figure.png(&stem.with_extension("png"), CHART_WIDTH)
}
