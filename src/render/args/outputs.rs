//! The output files and their contents.

use std::path::PathBuf;

use crate::metadata::MetadataOptions;
use wavecrest_base::choice::Choice as _;
use wavecrest_base::error::did_you_mean;
use wavecrest_image::aov::Layer;

/// Options on what is written.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct OutputOptions {
    /// Also write the image to this file; can be given several times
    #[arg(long, value_name = "FILE")]
    pub(crate) also: Vec<PathBuf>,
    /// Layers to add to .exr outputs, comma-separated: depth, normal, albedo, position, object, material, samples,
    /// invalid, all (these), or alpha (colours then count as premultiplied)
    #[arg(long, value_name = "LAYERS", value_parser = layers)]
    pub(crate) aov: Option<Layers>,
    /// Metadata
    #[command(flatten)]
    pub(crate) metadata: MetadataOptions,
}

/// The requested layers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Layers(pub Vec<Layer>);

/// `depth,normal`, or `all`.
fn layers(text: &str) -> std::result::Result<Layers, String> {
    if text == "all" {
        // Alpha changes the colours: they are premultiplied by it.
        let all = Layer::ALL.into_iter().filter(|layer| *layer != Layer::Alpha);
        return Ok(Layers(all.collect()));
    }
    let names = || Layer::ALL.map(Layer::name).into_iter();
    let layer = |word: &str| {
        Layer::by_name(word).ok_or_else(|| match did_you_mean(word, names()) {
            Some(near) => format!("there is no layer {word:?}; did you mean {near}?"),
            None => {
                format!(
                    "there is no layer {word:?}; use all, {}",
                    names().collect::<Vec<_>>().join(", ")
                )
            }
        })
    };
    text.split(',')
        .map(|word| layer(word.trim()))
        .collect::<std::result::Result<_, _>>()
        .map(Layers)
}
