//! What EXR files hold beside pixels.

use wavecrest_base::error::Result;
use wavecrest_core::film::Film;
use wavecrest_image::metadata::{Channel, Entry, Extras, Values};
use wavecrest_image::write::{Transfer, write_with};

use super::write::film;
use crate::support::{bytes, folder};

fn encode(film: &Film, extras: &Extras<'_>) -> Result<Vec<u8>> {
    let folder = folder();
    write_with(film, &folder.path().join("a.exr"), Transfer::Linear, extras)?;
    Ok(bytes(folder.path(), "a.exr"))
}

#[test]
fn the_bytes_follow_from_the_entries_and_not_from_chance() {
    let names = ["software", "seed", "scene", "crop", "command", "samples", "precision"];
    let entries = names.map(|name| Entry { name, text: format!("of {name}: \u{434}") });
    let film = film();
    let extras = Extras { entries: &entries, ..Extras::default() };
    let first = encode(&film, &extras).unwrap();
    for _ in 0..20 {
        assert!(encode(&film, &extras).unwrap() == first);
    }
    let place = |text: &str| first.windows(text.len()).position(|w| w == text.as_bytes());
    assert!(place("wavecrest.command") < place("wavecrest.crop"));
    assert!(place("of seed: \u{434}").is_some() && place("software\0string\0").is_some());
}

#[test]
fn a_channel_of_another_size_is_refused() {
    let channel = Channel { name: "a".into(), values: Values::Integers(vec![1; 3]) };
    let extras = Extras { channels: &[channel], ..Extras::default() };
    let told = encode(&film(), &extras).unwrap_err().to_string();
    assert!(told.contains("a has another size"), "{told}");
}
