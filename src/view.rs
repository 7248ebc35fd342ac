//! `view`: a page on this machine that shows a scene from anywhere, and what its accuracy costs.
//!
//! [`server`] talks to pages, [`painter`] has the scene and renders it; between them is the [`exchange`].

mod address;
mod exchange;
mod line;
mod page;
mod painter;
mod picture;
mod ready;
mod refine;
mod request;
mod server;
mod showing;
mod steering;
mod take_away;
mod talk;

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use super::common::{SPEED, SearchOptions, choice, command_words, print, tell, whole};
use super::input::SceneOptions;
use super::interrupt;
use address::{Address, origin};
use server::{Site, serve};
use take_away::TakeAway;
use wavecrest_base::error::{Error, ErrorKind, Result};
use wavecrest_base::read;
use wavecrest_core::render::TracerKind;
use wavecrest_image::look::Look;

/// The section of the help for the page.
const PAGE: &str = "Page";

/// Paths in a batch: fewer than for `render`, as a render that is no longer wanted ends between two.
const BATCH: u32 = 1 << 14;

/// How long pages have to show why the command ends.
const FAREWELL: Duration = Duration::from_millis(200);
/// How long the address that the browser is given leads to the page: longer than a browser takes to start.
const OPENING: Duration = Duration::from_secs(60);

/// Look at a scene, a glTF file or a mesh in a browser: find the camera, and see what accuracy costs.
///
/// The page shows the file from anywhere, with the time, the error and the effects of its image. It gives the command that
/// renders what it shows. Ctrl-C ends it.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct ViewArgs {
    /// Scene (.json), glTF file (.gltf, .glb) or mesh (.ply, .obj, .stl)
    pub(crate) scene: PathBuf,
    /// Print the address only; open no browser
    #[arg(long, help_heading = PAGE)]
    pub(crate) no_open: bool,
    /// Name or address to listen at, for other machines: whoever knows the page's address sees the scene
    #[arg(long, help_heading = PAGE, value_name = "ADDRESS", default_value = "127.0.0.1")]
    pub(crate) listen: String,
    /// Port to listen at [default: any that is free]
    #[arg(long, help_heading = PAGE, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) port: u16,
    /// Address of another server that leads to the page, with its scheme
    #[arg(long, help_heading = PAGE, value_name = "ADDRESS", value_parser = origin)]
    pub(crate) allow_origin: Vec<String>,
    /// Show geometry or materials instead of lighting
    #[arg(long = "as", value_name = "LOOK", value_parser = choice::<Look>())]
    pub(crate) look: Option<Look>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = whole(0..=u64::MAX))]
    pub(crate) seed: u64,
    /// Tracer; does not change the image
    #[arg(long, help_heading = SPEED, value_parser = choice::<TracerKind>(), default_value_t)]
    pub(crate) tracer: TracerKind,
    /// Paths in a batch of the wavefront tracer; does not change the image
    #[arg(long, help_heading = SPEED, value_name = "PATHS", default_value_t = BATCH,
          value_parser = whole(1..=1_u32 << 20))]
    pub(crate) batch: u32,
    /// Traversal
    #[command(flatten)]
    pub(crate) search: SearchOptions,
    /// Scene
    #[command(flatten)]
    pub(crate) scene_options: SceneOptions,
}

/// Serves the page of a scene until a signal ends the process.
///
/// # Errors
/// If the port cannot be used, or the scene cannot be loaded or prepared.
pub(crate) fn run(args: &ViewArgs) -> Result<()> {
    args.search.check(args.scene_options.precision)?;
    args.scene_options.input.check(&args.scene)?;
    // Before a server is started and a browser opened.
    read::open(&args.scene).map_err(|e| Error::io("cannot read the scene", &args.scene, e))?;
    if args.scene_options.input.turntable.is_some() {
        let error = Error::new(ErrorKind::Usage, "a page shows no turntable");
        return Err(error.remedy("leave out --turntable, and turn it yourself"));
    }
    if args.scene_options.input.is_transparent() {
        let error = Error::new(ErrorKind::Usage, "a page shows no transparent background");
        return Err(error.remedy("leave out --background, or use a colour"));
    }
    let (name, port) = (&args.listen, args.port);
    let cannot = |e: io::Error| {
        let message = format!("cannot serve the page at {name}, port {port}: {e}");
        Error::new(ErrorKind::Io, message).remedy("use another --listen or --port").because(e)
    };
    let (listener, address) = Address::listen(name, port, &args.allow_origin).map_err(cannot)?;
    interrupt::expect();
    let site = Arc::new(Site {
        exchange: Arc::default(),
        take_away: TakeAway::new(&args.scene, command_words()),
        turn: Arc::default(),
        token: token()?,
        once: token()?,
        leads: Mutex::new(Some(Instant::now() + OPENING)),
        address,
    });
    let tunnel = site.address.tunnel();
    if tunnel.is_none() {
        tell(
            "warning: other machines can reach the page; leave out --listen to keep it to this one",
        );
    }
    if !args.scene_options.quiet {
        let from = tunnel.map_or(String::new(), |ssh| format!(" From another machine: {ssh}"));
        tell(&format!("Open this address in a browser; Ctrl-C ends the page.{from}"));
    }
    print(&format!("{}\n", site.address.url(&site.token)))?;
    let _ = io::stdout().flush();
    let served = Arc::clone(&site);
    let serving = thread::Builder::new().spawn(move || {
        if let Err(error) = serve(listener, &served) {
            tell(&format!("error: cannot serve the page: {error}"));
        }
    });
    serving.map_err(cannot)?;
    if !args.no_open && open(&site.address.url(&site.once)).is_err() {
        tell("note: no browser could be opened; open the address in one");
    }
    let painted =
        args.scene_options.threads.run(|| painter::paint(args, &site.exchange, &site.take_away));
    if let Err(error) = &painted {
        site.exchange.send_error(error);
        thread::sleep(FAREWELL);
    }
    painted
}

/// Opens an address in the browser of the system's choice.
fn open(url: &str) -> io::Result<()> {
    let (program, first) = if cfg!(windows) {
        ("rundll32", Some("url.dll,FileProtocolHandler"))
    } else {
        (if cfg!(target_os = "macos") { "open" } else { "xdg-open" }, None)
    };
    let mut command = Command::new(program);
    command.args(first).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().map(drop)
}

/// The secret part of the address: 128 random bits, in hexadecimal digits.
fn token() -> Result<String> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|e| {
        Error::new(ErrorKind::Io, format!("the system gives no random numbers: {e}")).because(e)
    })?;
    Ok(bytes.map(|byte| format!("{byte:02x}")).concat())
}
