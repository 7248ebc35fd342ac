//! Options, output and progress shared by several commands.

use std::ffi::OsStr;
use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::{LazyLock, Mutex};

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use serde_json::Value;

use wavecrest_base::choice::Choice;
use wavecrest_base::error::{Error, ErrorKind, Result, Warning};
use wavecrest_base::lock;
use wavecrest_base::words;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::kernels::precision::Precision;
use wavecrest_core::math::simd::Level;
pub(crate) use wavecrest_report::files::{to_json, write_text};

/// Sections of the help, in the order of their first options.
pub(crate) const IMAGE: &str = "Image";
pub(crate) const VIEW: &str = "View and lights of a mesh or a glTF file";
pub(crate) const FRAMES: &str = "Frames";
pub(crate) const LONG: &str = "Long renders";
pub(crate) const FILES: &str = "Files";
pub(crate) const SPEED: &str = "Speed and memory";

/// Options on how the tree is searched, which change no answer.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct SearchOptions {
    /// Instruction set: auto (the best available), sse2, avx2, avx512 or neon; does not change the image
    #[arg(long, help_heading = SPEED, value_name = "LEVEL", default_value = "auto", hide_possible_values = true,
          value_parser = with_names(&["auto", "sse2", "avx2", "avx512", "neon"], simd))]
    pub(crate) simd: Level,
    /// Traversal kernel; does not change the image
    #[arg(long, help_heading = SPEED, value_name = "KERNEL", value_parser = choice::<KernelChoice>(), default_value_t)]
    pub(crate) kernel: KernelChoice,
}

impl SearchOptions {
    /// Checks that the kernel is one for this precision.
    ///
    /// # Errors
    /// If the reference is asked for fast precision, which has no pairs in exact arithmetic.
    pub(crate) fn check(&self, precision: Precision) -> Result<()> {
        if (self.kernel, precision) != (KernelChoice::Reference, Precision::Fast) {
            return Ok(());
        }
        Err(Error::new(ErrorKind::Usage, "the kernel `reference` is exact, not fast")
            .remedy("leave out --precision fast, or use --kernel single"))
    }
}

/// An instruction level of this processor.
fn simd(text: &str) -> std::result::Result<Level, String> {
    if text == "auto" {
        return Ok(Level::best());
    }
    let available = Level::available();
    available.iter().copied().find(|level| level.name() == text).ok_or_else(|| {
        let names: Vec<_> = available.iter().map(|level| level.name()).collect();
        let is_known = Level::by_name(text).is_some();
        let what =
            if is_known { "this processor does not have it" } else { "unknown instruction set" };
        format!("{what}; use auto, {}", names.join(", "))
    })
}

/// How many threads to work on.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(crate) struct Threads {
    /// Number of threads [default: one per core]
    #[arg(long, help_heading = SPEED, value_name = "N", value_parser = whole(1..=4096_u16))]
    pub(crate) threads: Option<u16>,
}

impl Threads {
    /// Runs `work` on the requested threads.
    pub(crate) fn run<R: Send>(&self, work: impl FnOnce() -> Result<R> + Send) -> Result<R> {
        let threads = self.threads.map_or(0, usize::from);
        let processors = std::thread::available_parallelism().map_or(threads, usize::from);
        if threads > processors {
            tell(&format!("warning: more threads than processors; use --threads {processors}"));
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| {
            Error::new(ErrorKind::Usage, format!("cannot start threads: {e}"))
                .remedy("use fewer --threads, or raise the limits of the process (ulimit -u, -v)")
        })?;
        pool.install(work)
    }
}

/// The words of the command of this process, which need not be Unicode.
pub(crate) fn command_words() -> Vec<String> {
    std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect()
}

/// Writes to standard output.
pub(crate) fn print(text: &str) -> Result<()> {
    wavecrest_base::replace::print(text.as_bytes())
}

/// Writes a line to standard error, above the bars. If that is closed, the line is lost.
pub(crate) fn tell(line: &str) {
    BARS.suspend(|| drop(writeln!(std::io::stderr(), "{line}")));
}

/// Prints an error, one line for each of several.
pub(crate) fn tell_error(error: &Error) {
    error.to_string().lines().for_each(|line| tell(&format!("error: {line}")));
}

/// As [`tell`], as the last line: in place of the bars.
#[cfg(unix)]
pub(crate) fn tell_last(line: &str) {
    let _ = BARS.clear();
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// The bars, one below the other.
static BARS: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// Prints warnings, and notes unless `quiet`; they are then told.
pub(crate) fn tell_all(warnings: &mut Vec<Warning>, notes: &mut Vec<Warning>, quiet: bool) {
    warn(&std::mem::take(warnings));
    let notes = std::mem::take(notes);
    notes.iter().filter(|_| !quiet).for_each(|note| tell_of("note", note));
}

/// Prints warnings.
pub(crate) fn warn(warnings: &[Warning]) {
    warnings.iter().for_each(|warning| tell_of("warning", warning));
}

/// Prints a warning or a note, without the name of its file if the one before had the same.
fn tell_of(kind: &str, warning: &Warning) {
    static LAST: Mutex<Option<PathBuf>> = Mutex::new(None);
    let mut last = lock(&LAST);
    let file = warning.file().map(Path::to_owned);
    if file.is_some() && *last == file {
        tell(&format!("{kind}: {}", warning.without_file()));
    } else {
        tell(&format!("{kind}: {warning}"));
        *last = file;
    }
}

/// A progress bar on a terminal, otherwise hidden, below the lines of [`tell`].
pub(crate) fn progress_bar(quiet: bool, template: &str) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style =
        ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    BARS.add(ProgressBar::new(0).with_style(style))
}

/// Runs `work`, which reports its progress, with a bar of [`progress_bar`].
pub(crate) fn with_bar<R>(
    quiet: bool,
    template: &str,
    work: impl FnOnce(&mut dyn FnMut(u64, u64)) -> R,
) -> R {
    let bar = progress_bar(quiet, template);
    let result = work(&mut |done, all| {
        bar.set_length(all);
        bar.set_position(done);
    });
    bar.finish_and_clear();
    result
}

/// A JSON object without the keys that have no value.
pub(crate) fn known(mut object: Value) -> Value {
    if let Value::Object(entries) = &mut object {
        entries.retain(|_, value| !value.is_null());
    }
    object
}

/// A number rounded to this many digits.
pub(crate) fn rounded(x: f64, digits: usize) -> f64 {
    let rounded: f64 = format!("{x:.*e}", digits.saturating_sub(1)).parse().unwrap_or(x);
    // Avoids -0.
    rounded + 0.0
}

/// `n` with spaces between thousands.
pub(crate) fn grouped(n: u64) -> String {
    words::grouped(&n.to_string(), ' ')
}

/// Seconds to two digits or to the second, whichever says more.
pub(crate) fn seconds(seconds: f64) -> String {
    let digits = match seconds {
        s if s < 0.1 => 3,
        s if s < 10.0 => 2,
        s if s < 100.0 => 1,
        _ => 0,
    };
    format!("{seconds:.digits$}")
}

/// Whole numbers between commas, if there are as many as asked for.
pub(crate) fn numbers<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let all: Option<Vec<T>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    all?.try_into().ok()
}

/// A parser of named values; the help lists each with its meaning.
pub(crate) fn choice<T: Choice>() -> impl TypedValueParser<Value = T> {
    let listed = T::VALUES.iter().map(|value| {
        let help = value.help().trim_end_matches('.');
        PossibleValue::new(value.name()).help(help).aliases(value.old_names())
    });
    PossibleValuesParser::new(listed)
        .try_map(|name| T::by_name(&name).ok_or("not one of the possible values"))
}

/// A parser of values of which these have `names`, which shells complete.
#[derive(Clone)]
struct WithNames<P>(&'static [&'static str], P);

impl<P: TypedValueParser> TypedValueParser for WithNames<P> {
    type Value = P::Value;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &OsStr,
    ) -> std::result::Result<P::Value, clap::Error> {
        self.1.parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.iter().map(PossibleValue::new)))
    }
}

/// As `parser`, with the names of some values for shells to complete.
pub(crate) fn with_names<P: TypedValueParser>(
    names: &'static [&'static str],
    parser: P,
) -> impl TypedValueParser<Value = P::Value> {
    WithNames(names, parser)
}

/// The file to write, named as an option or by its place.
///
/// # Errors
/// If it is not named.
pub(crate) fn output<'a>(
    option: &'a Option<PathBuf>,
    placed: &'a Option<PathBuf>,
    example: &str,
) -> Result<&'a PathBuf> {
    option.as_ref().or(placed.as_ref()).ok_or_else(|| {
        let remedy = format!("add one, such as {example}");
        Error::new(ErrorKind::Usage, "the output is missing").remedy(remedy)
    })
}

/// A number that `fits`; `wrong` says what to write instead of another.
pub(crate) fn number<T: FromStr>(
    text: &str,
    fits: impl FnOnce(&T) -> bool,
    wrong: &str,
) -> std::result::Result<T, String> {
    text.parse().ok().filter(fits).ok_or_else(|| wrong.to_owned())
}

/// A whole number in this range.
pub(crate) fn whole<T>(
    range: RangeInclusive<T>,
) -> impl Fn(&str) -> std::result::Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    let wrong = format!("use a whole number from {} to {}", range.start(), range.end());
    move |text| number(text, |found| range.contains(found), &wrong)
}

/// A number of 0 or more; `such` says what else than a number it is, and gives one.
pub(crate) fn not_negative(
    such: &str,
) -> impl Fn(&str) -> std::result::Result<f64, String> + Clone + Send + Sync + 'static {
    let wrong = format!("use a number of {such}");
    let fits = |value: &f64| value.is_finite() && *value >= 0.0;
    move |text| number(text, fits, &wrong)
}

/// A number above 0.
pub(crate) fn above_zero(text: &str) -> std::result::Result<f64, String> {
    let fits = |value: &f64| value.is_finite() && *value > 0.0;
    number(text, fits, "use a number above 0, such as 0.01")
}
