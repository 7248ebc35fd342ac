//! What is prepared once more when the file is shown otherwise, or from elsewhere.

use super::Painter;
use crate::input::Upward;
use crate::view::exchange::Kind;
use crate::view::ready::{Ready, check_size, release};
use crate::view::request::Shown;
use crate::view::steering::Steering;
use wavecrest_base::error::Result;

impl Painter<'_> {
    /// Shows the file so from now on; returns whether the image changes.
    pub(super) fn show_as(&mut self, shown: Shown) -> Result<bool> {
        let before = self.shown;
        if shown == before {
            return Ok(false);
        }
        // Another shape of the image, and another axis, have another usual view.
        let is_framed = self.take_away.is_scene() || shown.size == before.size;
        let is_prepared = before == Shown { size: before.size, transfer: before.transfer, ..shown };
        let is_shown = shown.is_valid() && self.say(check_size(&self.args, shown.size)) && {
            self.shown = shown;
            match is_framed && shown.up == before.up {
                true => is_prepared || self.prepare_again(),
                false => self.open_again(before),
            }
        };
        if !is_shown {
            // Pages show what is chosen.
            self.shown = before;
            self.send_state();
            return Ok(false);
        }
        self.steering.resize(shown.size);
        if shown.look.is_some() {
            self.halves.truncate(1);
        }
        self.restart();
        Ok(true)
    }

    /// Reads the file once more, for another axis that is up or another size. A camera that was moved stays where it is. If it
    /// fails, what is shown is prepared once more as `before`.
    fn open_again(&mut self, before: Shown) -> bool {
        let (mut args, shown) = (self.args.clone(), self.shown);
        let input = &mut args.scene_options.input;
        input.up.retain(|up| matches!(up, Upward::Direction(_)));
        input.up.extend(shown.up.map(Upward::Axis));
        (input.size, input.width, input.height) = (Some(shown.size), None, None);
        release(&mut self.ready.scene);
        let opened = match Ready::open(&args, self.exchange, |_, _| shown) {
            Ok((ready, view, _)) => {
                let moved = self.steering;
                (self.ready, self.steering, self.args) = (ready, Steering::new(view), args);
                self.steering.stay_at(&moved);
                Ok(())
            }
            Err(error) => {
                self.shown = before;
                self.prepare_again();
                Err(error)
            }
        };
        self.say(opened)
    }

    /// Prepares the scene once more: shown otherwise, or because the camera or its lights are not where it was prepared for.
    pub(super) fn prepare_again(&mut self) -> bool {
        let Self { exchange, shown, .. } = *self;
        let view = self.steering.view;
        let prepared = self.ready.prepare_again(&self.args, exchange, &shown, view);
        self.say(prepared)
    }

    /// Tells pages what is prepared, or why nothing is: they show the error above the image that they have. Returns whether
    /// it is.
    fn say(&mut self, prepared: Result<()>) -> bool {
        match &prepared {
            Ok(()) => {
                self.exchange.withdraw(Kind::Error);
                self.send_plan();
            }
            Err(error) => self.exchange.send_error(error),
        }
        prepared.is_ok()
    }
}
