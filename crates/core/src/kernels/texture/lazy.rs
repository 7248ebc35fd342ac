//! Images that are decoded at their first look-up.

use std::cell::Cell;
use std::sync::LazyLock;
use std::time::Instant;

use xxhash_rust::xxh3::xxh3_128;

use super::Image;
use wavecrest_base::error::Result;

/// A value that a function makes once.
type Lazy<T> = LazyLock<T, Box<dyn FnOnce() -> T + Send>>;

/// An image that is decoded once, by the first thread that asks for a texel; others wait for it.
#[derive(Debug)]
pub struct LazyImage {
    image: Lazy<Result<Image>>,
    fingerprint: Lazy<u128>,
    name: String,
}

thread_local! {
    static DECODING: Cell<f64> = const { Cell::new(0.0) };
}

/// Seconds in which look-ups by the current thread have decoded images, or waited for them.
pub(crate) fn decoding() -> f64 {
    DECODING.get()
}

impl LazyImage {
    /// The image of this `name` that `decode` makes, which must not wait for threads that look up images. `source`
    /// returns the content of its file and whatever else the texels depend on.
    pub fn new(
        name: String,
        source: impl FnOnce() -> Vec<u8> + Send + 'static,
        decode: impl FnOnce() -> Result<Image> + Send + 'static,
    ) -> Self {
        let hash = Box::new(move || xxh3_128(&source()));
        Self { image: LazyLock::new(Box::new(decode)), fingerprint: LazyLock::new(hash), name }
    }

    /// A hash that distinguishes images, for which none is decoded.
    pub fn fingerprint(&self) -> u128 {
        *self.fingerprint
    }

    /// The image, decoded now if it has not been.
    ///
    /// # Errors
    /// When it cannot be decoded.
    #[inline]
    pub fn get(&self) -> Result<&Image> {
        self.image.as_ref().map_err(Clone::clone)
    }

    /// The image, decoded at the first look-up, or `None` if it cannot be decoded, which ends a render.
    #[inline]
    pub(crate) fn usable(&self) -> Option<&Image> {
        let decoded = self.decoded().unwrap_or_else(|| self.wait());
        decoded.as_ref().ok()
    }

    /// Decodes the image, or waits until another thread has, and adds the time to [`decoding`].
    #[cold]
    #[inline(never)]
    fn wait(&self) -> &Result<Image> {
        let start = Instant::now();
        let decoded = &*self.image;
        DECODING.set(decoding() + start.elapsed().as_secs_f64());
        decoded
    }

    /// The result of decoding, if the image has been looked up.
    #[inline]
    pub fn decoded(&self) -> Option<&Result<Image>> {
        LazyLock::get(&self.image)
    }

    /// The path of its file, or its JSON path in the scene's file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.held().map_or(0, |image| image.bytes() as u64)
    }

    /// The image, if it has been decoded.
    pub fn held(&self) -> Option<&Image> {
        self.decoded()?.as_ref().ok()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::time::Duration;

    use super::super::Texels;
    use super::*;
    use wavecrest_base::error::{Error, ErrorKind};

    #[test]
    fn an_image_is_decoded_once_by_whichever_thread_is_first() {
        let times = Arc::new(AtomicU32::new(0));
        let counter = Arc::clone(&times);
        let image = LazyImage::new("a.png".into(), Vec::new, move || {
            counter.fetch_add(1, Ordering::Relaxed);
            Ok(Image::new(1, 1, Texels::Bytes(vec![[1, 2, 3, 0]])))
        });
        assert!(image.decoded().is_none() && image.bytes() == 0);
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| assert!(image.usable().is_some()));
            }
        });
        assert_eq!((times.load(Ordering::Relaxed), image.bytes()), (1, 4));
    }

    #[test]
    fn the_first_look_up_counts_as_decoding() {
        let image = LazyImage::new("a.png".into(), Vec::new, || {
            std::thread::sleep(Duration::from_millis(5));
            Ok(Image::new(1, 1, Texels::Bytes(vec![[1, 2, 3, 0]])))
        });
        let before = decoding();
        assert!(image.usable().is_some());
        let after = decoding();
        assert!(after - before >= 0.005, "{before} {after}");
        assert!(image.usable().is_some() && decoding() == after);
        std::thread::scope(|scope| {
            scope.spawn(|| assert!(image.usable().is_some() && decoding() == 0.0));
        });
    }

    #[test]
    fn a_failure_is_reported_at_every_call() {
        let image = LazyImage::new("a.png".into(), Vec::new, || {
            Err(Error::new(ErrorKind::Texture, "no image").in_file("a.json"))
        });
        for _ in 0..2 {
            let told = image.get().err().map(|error| error.to_string());
            assert_eq!(told.as_deref(), Some("a.json: no image"));
        }
        assert!(image.usable().is_none() && image.decoded().is_some());
    }
}
