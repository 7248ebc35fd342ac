//! What the painter tells pages: where the camera is and what may be taken away, figures, and what is simulated.

use serde_json::{Value, json};

use super::Painter;
use crate::explain;
use crate::view::exchange::Kind;
use wavecrest_core::math::sampling::Sampling;
use wavecrest_image::look::Look;
use wavecrest_image::write::Transfer;
use wavecrest_scene::load::framing::Up;

impl Painter<'_> {
    /// The figures of the halves that have an image.
    pub(super) fn all_figures(&self) -> Value {
        let halves = &self.figures[..self.halves.len()];
        let known: Vec<&Value> = halves.iter().filter(|figures| !figures.is_null()).collect();
        json!({"kind": "figures", "halves": known})
    }

    pub(super) fn send_figures(&self) {
        self.exchange.send(Kind::Figures, self.all_figures().to_string());
    }

    pub(super) fn send_chart(&self) {
        let Some([wide, narrow]) = self.tried.chart() else { return };
        let message = json!({"kind": "chart", "wide": wide, "narrow": narrow});
        self.exchange.send(Kind::Chart, message.to_string());
    }

    pub(super) fn send_state(&self) {
        let view = &self.steering.view;
        let commands = self.take_away.commands(
            &self.halves[0],
            &self.shown,
            ([self.steering.start(), view], self.args.scene_options.input.direction()),
        );
        // A scene, and a camera by its name, have their own.
        let has_axis = self.take_away.is_scene() || self.args.scene_options.input.camera.is_some();
        let state = json!({
            "kind": "state",
            "file": self.args.scene.file_name().unwrap_or_default().to_string_lossy(),
            "halves": self.halves,
            "samplers": Sampling::ALL,
            "shown": self.shown,
            "own_size": self.own_size,
            "looks": Look::ALL,
            "transfers": Transfer::ALL,
            "ups": if has_axis { &[][..] } else { &Up::ALL },
            "follows": self.ready.has_added_lights(),
            "camera": {"location": view.location.to_array(), "look": view.look.to_array(), "up": view.up.to_array(), "fov": view.fov_degrees},
            "commands": commands,
            "image": self.take_away.named("view.png"),
        });
        self.exchange.send(Kind::State, state.to_string());
    }

    /// What is simulated, wherever the camera is.
    pub(super) fn send_plan(&self) {
        let plan = &self.ready.scene.plan;
        let (passes, bvh) = (explain::passes(plan), self.ready.preset.name());
        let message = json!({"kind": "plan", "effects": plan, "passes": passes, "bvh": bvh});
        self.exchange.send(Kind::Plan, message.to_string());
    }
}
