//! Furnishes a dining room: a mesh with what scans lack, triangles of all sizes.
//!
//! `cargo run --release --example room -- FILE --triangles COUNT` writes it as PLY, with normals and
//! colours. It has exactly this number of triangles, such as 1400000, 20k or 1.4M.
//! `scenes/large/room.json` is a scene with it.

mod furniture;
mod solids;

use std::io::{Write, stderr};
use std::process::ExitCode;

use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::replace::{replace_file, write_error};
use wavecrest_scene::write::write_ply;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let Err(error) = run(&words) else { return ExitCode::SUCCESS };
    // If it cannot be told, the code is left.
    let _ = writeln!(stderr(), "error: {error}");
    ExitCode::from(2)
}

fn run(words: &[String]) -> Result<()> {
    let [path, option, count] = words else { return Err(misunderstood(&words.join(" "))) };
    let (digits, unit) = match count.char_indices().last() {
        Some((at, 'k')) => (&count[..at], 1e3),
        Some((at, 'M')) => (&count[..at], 1e6),
        _ => (&count[..], 1.0),
    };
    let number = digits.parse::<f64>().map(|number| (number * unit).round());
    // Readers of the file may count vertices, of which leaves have three, in 32 bits.
    let Some(triangles) = number.ok().filter(|n| option == "--triangles" && (1.0..1e9).contains(n))
    else {
        return Err(misunderstood(&words.join(" ")));
    };
    let (path, mesh) = (path.as_ref(), furniture::room(triangles as usize)?);
    replace_file(path, |sink| write_ply(&mesh, sink).map_err(|e| write_error(path, e)))
}

fn misunderstood(line: &str) -> Error {
    Error::new(ErrorKind::Usage, "the command line is not understood")
        .value(line)
        .remedy("write FILE --triangles COUNT, such as room.ply --triangles 1.4M")
}
