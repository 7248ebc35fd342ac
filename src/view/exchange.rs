//! What passes between the painter, which has the scene, and the connections of pages.
//!
//! Requests of all pages wait in the [`Inbox`]; what pages show lies on the [`Board`], the last message of each kind.
//! Neither grows: beyond a limit the oldest request is dropped, and a message replaces the one before it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use serde_json::json;
use tokio::sync::watch;
use tokio_tungstenite::tungstenite::Utf8Bytes;

use super::picture::Picture;
use super::request::Request;
use wavecrest_base::error::Error;
use wavecrest_base::{lock, memory, progress};
use wavecrest_core::film::Film;
use wavecrest_core::render::Watch;
use wavecrest_image::write::Transfer;

/// The most requests that wait.
const MOST_REQUESTS: usize = 64;

/// Requests that wait for the painter.
#[derive(Default)]
pub(super) struct Inbox {
    waiting: Mutex<Vec<Request>>,
    arrived: Condvar,
    /// Whether any wait for which a render ends, to be asked without a lock.
    any: AtomicBool,
}

impl Inbox {
    /// Adds a request.
    pub(super) fn put(&self, request: Request) {
        let mut waiting = lock(&self.waiting);
        if waiting.len() == MOST_REQUESTS {
            waiting.remove(0);
        }
        // To take hold of something changes nothing yet.
        self.any.fetch_or(!matches!(request, Request::Grab { .. }), Ordering::Release);
        waiting.push(request);
        self.arrived.notify_one();
    }

    /// Takes all requests, once there are any; none if none come in time.
    pub(super) fn take(&self, patience: Duration) -> Vec<Request> {
        let waiting = lock(&self.waiting);
        let (mut waiting, _) = self
            .arrived
            .wait_timeout_while(waiting, patience, |waiting| waiting.is_empty())
            .unwrap_or_else(PoisonError::into_inner);
        self.any.store(false, Ordering::Release);
        std::mem::take(&mut waiting)
    }
}

/// Ends a render when a request arrives.
impl Watch for Inbox {
    fn cancelled(&self) -> bool {
        self.any.load(Ordering::Acquire)
    }
}

/// The kinds of messages to pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Progress,
    Error,
    State,
    Plan,
    Figures,
    Chart,
    Probe,
    /// The image of a half.
    First,
    Second,
}

impl Kind {
    /// The number of kinds.
    pub(super) const COUNT: usize = Self::Second as usize + 1;

    /// That of the image of a half.
    pub(super) fn image(half: usize) -> Self {
        if half == 0 { Self::First } else { Self::Second }
    }
}

/// A message to pages.
#[derive(Clone)]
pub(super) enum Posted {
    Words(Utf8Bytes),
    Picture(Arc<Picture>),
}

impl From<String> for Posted {
    fn from(words: String) -> Self {
        Self::Words(words.into())
    }
}

impl From<Picture> for Posted {
    fn from(picture: Picture) -> Self {
        Self::Picture(Arc::new(picture))
    }
}

/// What pages show, and what they may take away.
#[derive(Clone, Default)]
pub(super) struct Board {
    /// The last message of each kind, with the number of messages of its kind so far.
    pub(super) messages: [(u64, Option<Posted>); Kind::COUNT],
    /// The last whole image, developed, of the first half.
    pub(super) image: Option<(Arc<Film>, Transfer)>,
}

/// Both directions.
#[derive(Default)]
pub(super) struct Exchange {
    pub(super) inbox: Inbox,
    pub(super) board: watch::Sender<Board>,
    /// Whether a scene is being prepared.
    prepares: AtomicBool,
    /// Whether what is shown meanwhile is the first part of the file.
    pub(super) shows_part: AtomicBool,
}

impl Exchange {
    /// Begins the preparation of a scene, which ends when the answer is dropped.
    pub(super) fn prepare(&self) -> Preparing<'_> {
        progress::begin();
        self.prepares.store(true, Ordering::Relaxed);
        Preparing(self)
    }

    /// Tells how far the preparation of a scene is, if one is being prepared.
    pub(super) fn send_progress(&self) {
        if self.prepares.load(Ordering::Relaxed) {
            let ([done, all], mut stage) =
                (progress::now(), memory::Stage::now().name().to_owned());
            if self.shows_part.load(Ordering::Relaxed) {
                stage += ": the image shows the first part of the file, as if it were all";
            }
            let message = json!({"kind": "progress", "stage": stage, "done": done, "all": all});
            self.send(Kind::Progress, message.to_string());
        }
    }

    /// Puts a message on the board.
    pub(super) fn send(&self, kind: Kind, message: impl Into<Posted>) {
        self.board.send_modify(|board| {
            let (number, last) = &mut board.messages[kind as usize];
            (*number, *last) = (*number + 1, Some(message.into()));
        });
    }

    /// Shows an error.
    pub(super) fn send_error(&self, error: &Error) {
        let message = json!({"kind": "error", "message": error.to_string()});
        self.send(Kind::Error, message.to_string());
    }

    /// Takes a message from the board.
    pub(super) fn withdraw(&self, kind: Kind) {
        self.board.send_modify(|board| board.messages[kind as usize].1 = None);
    }
}

/// That a scene is being prepared.
pub(super) struct Preparing<'a>(&'a Exchange);

impl Drop for Preparing<'_> {
    fn drop(&mut self) {
        self.0.prepares.store(false, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flood_of_requests_is_bounded() {
        let inbox = Inbox::default();
        assert!(inbox.take(Duration::ZERO).is_empty() && !inbox.cancelled());
        (0..100_000).for_each(|_| inbox.put(Request::Probe { at: [0.5, 0.5] }));
        assert!(inbox.cancelled());
        assert_eq!(inbox.take(Duration::MAX).len(), MOST_REQUESTS);
        assert!(inbox.take(Duration::ZERO).is_empty() && !inbox.cancelled());
    }
}
