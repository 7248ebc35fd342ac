//! How the command ends.

/// Every code that the command ends with, and what it means: for the help, the manual and the README.
pub(crate) const CODES: [(u8, &str); 5] = [
    (0, "done; of diff: the images are equal, or within the limits given"),
    (
        1,
        "the answer is no: of diff, the images differ, by more than the limits if any are given; of bench, the \
         tracers disagree; of selftest, a case fails; of probe, the two tracers differ; of accuracy, what must not change a picture does, or something \
         became worse",
    ),
    (2, "an error, reported on standard error"),
    (130, "SIGINT (Ctrl-C) ended a render early; what was finished is kept"),
    (143, "SIGTERM did"),
];
