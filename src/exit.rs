//! Exit codes of the command.

/// The code of an error.
pub(crate) const ERROR: u8 = 2;

/// Every exit code with its meaning: for the help, the manual and the guide.
pub(crate) const CODES: [(u8, &str); 5] = [
    (0, "success; diff: the images are equal, or within the limits"),
    (
        1,
        "the check failed; diff: the images differ by more than the limits; bench: images differ; selftest: a case fails",
    ),
    (ERROR, "error, printed to standard error"),
    (130, "stopped by SIGINT (Ctrl-C); a new image has what was finished, an older one stays"),
    (143, "stopped by SIGTERM; the same"),
];
