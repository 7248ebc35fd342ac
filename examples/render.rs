//! Renders a file until its error is small enough, or ten seconds are over: `cargo run --release --example render -- FILE out.png`.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program")]

use std::path::Path;
use std::time::Instant;

use wavecrest_api::SceneOptions;
use wavecrest_api::goal::{Goal, Reached};
use wavecrest_api::session::Session;
use wavecrest_api::{LoadOptions, RenderOptions, Transfer, write_image};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [file, image] = [1, 2].map(|index| std::env::args().nth(index));
    let (file, image) = file.zip(image).ok_or("name a scene or a mesh, and an image")?;
    let goal = Goal { error: Some(0.005), seconds: Some((10.0, Instant::now())), samples: None };
    let mut session =
        Session::open(Path::new(&file), &LoadOptions::default(), &SceneOptions::default())?;
    session.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    let Reached { rendered, samples, error, .. } =
        session.render(&goal, &RenderOptions::default(), &())?;
    println!("{samples} samples a pixel: error {}", error.unwrap_or(f64::NAN));
    write_image(&rendered.film, Path::new(&image), Transfer::Srgb)?;
    Ok(())
}
