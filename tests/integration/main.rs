//! The integration tests: one binary, and this index of what it checks.
//!
//! `cargo test --test integration` runs them all, `cargo test --test integration parity` those of
//! one module. A test's name says what holds.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests fail as tests do; clippy knows only the test functions themselves"
)]

// Loading, rendering and running the command, and transcripts, seeds and approved texts, for all the modules below; no
// tests.
#[path = "../approved.rs"]
mod approved;
#[path = "../seeds.rs"]
mod seeds;
mod support;
mod transcript;

// Every scene has the image of its hash in tests/golden.txt. Tracer, threads, batches, instructions, kernels, trees, plans,
// crops and writing it do not change a bit.
mod parity;

// Random scenes of solids, holes, panes and mirrors at once: one image of each, in any order, with what nothing meets; and
// of shapes around the eye: leaving out what is out of view changes no bit.
mod random_scenes;

// Meshes that are held once and shown often: the answers of copies, whatever searches them, without leaks.
mod instances;

// What needs more memory than is allowed ends with an error, and leaves files as they were.
mod memory;
// Renders in parts: who looks on, and who ends them early.
mod parts;

// Files of images: what is written is read again, and what is damaged is refused.
mod image;

// Shards and checkpoints: the image of one process, and what does not fit refused by name.
mod farm;

// Files without a scene, framed from every side.
mod framing;

// Images agree with formulas worked out here in double precision.
mod closed_form;

// Error against time: slopes, and sweeps that go on.
mod accuracy;
// Renders towards an error or a time: passes add up, and errors come out as asked for.
mod goals;

// Textures over what rays spread to: against references of many rays, and what they cost.
mod filtering;
// Leaving out what a scene does not call for changes no bit, and every row of the table of passes counts.
mod planning;

// A pilot of some pixels tells what a render will do.
mod expected;

// Far from the origin: positions are moved in double precision, and rounded once.
mod far;

// What cannot be seen costs nothing, by counts, bytes and opened files; what can, what it should.
mod unseen;

// The modules import each other in one direction alone, and files stay short.
mod architecture;

// Cut-outs: camera rays, shadow rays and mirror rays pass where an image has little alpha.
mod cutouts;

// OBJ files with the materials of their MTL files, and the colours of vertices.
mod materials;
// Files without lights: tones that differ, a ground without an edge, alpha.
mod lighting;

// glTF files and meshes alone: what they become, what is refused, and that they convert to the same image.
mod gltf;

// Benchmarks, the price list, charts and pages: what is compared, and how it is shown.
mod report;

// The command: arguments, formats, statistics, exit codes, messages, what is left behind on failure,
// and every subcommand.
mod cli;

// Layers beside the colours, against what geometry says.
mod aov;

// The commands of GUIDE.md work as they stand there.
mod guide;

// Scene files: what a valid one becomes, and which message each invalid one gets.
mod scene;

// The JSON Schema of scene files says what the parser does.
mod schema;

// What is said of scenes and meshes that are wrong, or probably not meant so, word for word.
mod told;

// The server of the page: what it refuses, what it bounds, and what does not end it.
#[cfg(feature = "view")]
mod page_server;
