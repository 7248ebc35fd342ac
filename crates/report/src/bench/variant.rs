//! What is compared: lists of variants of a render, all with the same image.

use serde::Serialize;

use crate::plot::number::plural;
use wavecrest_core::accel::KernelChoice;
use wavecrest_core::math::simd::{Level, is_wide};
use wavecrest_core::render::TracerKind;

/// A way to render an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Variant {
    /// The tracer.
    pub tracer: TracerKind,
    /// The kernel for batches of rays; the recursive tracer always traces single rays.
    pub kernel: KernelChoice,
    /// Instruction sets.
    pub simd: Level,
    /// Paths in a batch.
    pub batch: usize,
    /// Threads.
    pub threads: usize,
    /// Whether passes, columns and code that the scene does not need are skipped.
    pub planned: bool,
}

/// A variant in a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListedVariant {
    /// Its name among the others.
    pub label: String,
    /// The variant.
    pub variant: Variant,
    /// The number of the variant that its speed is compared with.
    pub over: usize,
    /// The step that leads to it, if the list goes on step by step: the number of the variant
    /// before, and what is new.
    pub step: Option<(usize, &'static str)>,
}

wavecrest_base::choices! {
    /// The property that differs between the variants of a list.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Varied {
        /// From the recursive tracer to the wavefront in steps.
        Ladder = "ladder",
        /// Traversal kernels.
        Kernels = "kernels",
        /// The ladder with each instruction set.
        Levels = "levels",
        /// Batch sizes.
        Batches = "batches",
        /// Both tracers on 1, 2, 4 ... threads, up to all.
        Threads = "threads",
        /// Unneeded passes left out, or all forced on.
        Plan = "plan",
    }
}

/// Batch sizes to compare if none are named.
pub const BATCHES: [usize; 5] = [16, 64, 256, 1024, 4096];

/// The steps from the order of the recursive tracer to the wavefront: the kernel, its name on the
/// ladder, and what is new.
const STEPS: [(KernelChoice, &str, &str); 3] = [
    (KernelChoice::Single, "single rays", "order"),
    (KernelChoice::Stream, "in flight", "flight"),
    (KernelChoice::Auto, "packets", "packets"),
];

impl Varied {
    /// The variants that differ from the `usual` one in this property, and those that they are
    /// compared with. `batches` are the batch sizes to compare.
    pub fn choices(self, usual: Variant, batches: &[usize]) -> Vec<ListedVariant> {
        let mut list = Vec::new();
        match self {
            Self::Ladder => ladder(&mut list, usual, ""),
            Self::Kernels => {
                let kernels = KernelChoice::FOR_RENDERS.map(|kernel| Variant { kernel, ..usual });
                list = against(usual, kernels, |variant| variant.kernel.name().to_owned());
            }
            Self::Levels => {
                for simd in Level::available() {
                    ladder(&mut list, Variant { simd, ..usual }, &format!("{}, ", simd.name()));
                }
            }
            Self::Batches => {
                let batches = batches.iter().map(|&batch| Variant { batch, ..usual });
                let mut sizes: Vec<Variant> = batches.chain([usual]).collect();
                sizes.sort_by_key(|variant| variant.batch);
                list = against(recursive(usual), sizes, |variant| match variant.tracer {
                    TracerKind::Recursive => "recursive".to_owned(),
                    TracerKind::Wavefront => variant.batch.to_string(),
                });
            }
            Self::Threads => {
                let powers = std::iter::successors(Some(1), |threads| Some(threads * 2));
                let fewer = powers.take_while(|threads| *threads < usual.threads);
                for threads in fewer.chain([usual.threads]) {
                    let (over, wavefront) = (list.len(), Variant { threads, ..usual });
                    let both = [("recursive", recursive(wavefront)), ("wavefront", wavefront)];
                    for (from, (name, variant)) in both.into_iter().enumerate() {
                        let label = format!("{name}, {}", plural(threads, "thread"));
                        let step = (over > 0).then_some((from, "threads"));
                        list.push(ListedVariant { label, variant, over, step });
                    }
                }
            }
            Self::Plan => {
                let all = Variant { planned: !usual.planned, ..usual };
                let name = |v: &Variant| if v.planned { "planned" } else { "all passes" };
                list = against(usual, [all], |variant| name(variant).to_owned());
            }
        }
        list
    }
}

/// The recursive tracer under the same conditions.
fn recursive(usual: Variant) -> Variant {
    Variant { tracer: TracerKind::Recursive, ..usual }
}

/// Adds the recursive tracer, then the wavefront with one kernel after another, up to the usual one.
fn ladder(list: &mut Vec<ListedVariant>, usual: Variant, prefix: &str) {
    let over = list.len();
    let label = format!("{prefix}recursive");
    list.push(ListedVariant { label, variant: recursive(usual), over, step: None });
    for (kernel, name, gain) in steps(usual) {
        let step = Some((list.len() - 1, gain));
        let label = format!("{prefix}wavefront, {name}");
        list.push(ListedVariant { label, variant: Variant { kernel, ..usual }, over, step });
    }
}

/// The variant `first`, and others that are compared with it, each once.
fn against(
    first: Variant,
    others: impl IntoIterator<Item = Variant>,
    label: impl Fn(&Variant) -> String,
) -> Vec<ListedVariant> {
    let mut list: Vec<ListedVariant> = Vec::new();
    for variant in std::iter::once(first).chain(others) {
        if list.iter().all(|listed| listed.variant != variant) {
            list.push(ListedVariant { label: label(&variant), variant, over: 0, step: None });
        }
    }
    list
}

/// The steps of a ladder that ends with the usual kernel. Narrow instruction sets have single rays
/// only.
fn steps(usual: Variant) -> Vec<(KernelChoice, &'static str, &'static str)> {
    let wide = usual.simd.token().is_some_and(is_wide);
    match usual.kernel {
        KernelChoice::Reference => vec![(KernelChoice::Reference, "reference", "order")],
        KernelChoice::Stream if wide => STEPS[..2].to_vec(),
        kernel @ (KernelChoice::Auto | KernelChoice::Packet) if wide => {
            let [single, stream, (_, name, gain)] = STEPS;
            vec![single, stream, (kernel, name, gain)]
        }
        _ => STEPS[..1].to_vec(),
    }
}
