//! Area lights.

use glam::DVec3;
use hecs::EntityBuilder;

use super::{MOST_SAMPLES, check_samples, warn_of_power};
use crate::camera::{Falloff, Sampling};
use crate::format::{Declaration, Kind, Object, Range, component, declared, keys};
use crate::shapes::{self, Triangle};
use wavecrest_base::error::Result;

pub(super) const KIND: Kind = Kind {
    keys: keys! {
        /// Has no effect: the light is where its shape is.
        "position": Point;
    },
    more: &[&[SHAPE]],
    ..Kind::entity(
        "arealight",
        "an area light",
        "A light with a shape, visible in the colour of the light.",
        &[Declaration::of::<AreaLight>()],
    )
};

component! {
    /// A light whose shape is the geometry of the same entity. Camera and mirror rays that hit it
    /// return its colour.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub struct AreaLight {
        /// Strength; with the default falloff 40 to 100 suits distances of 10 to 20.
        pub intensity: f64 = "intensity": Number(Range::NOT_NEGATIVE), Required;
        /// The colour of the light.
        pub color: DVec3 = "color": Color, Required;
        /// At distance d: 1/(4 pi d), 1/(4 pi d^2), or 1.
        pub falloff: Falloff = "falloff": word::<Falloff>(), Says("linear");
        /// Distribution of the points on the light: random, one in each cell of a grid of equal
        /// areas, or of an Owen-scrambled Sobol sequence through all rays of a pixel.
        pub sampling: Sampling = "sampling": word::<Sampling>(), Says("jittered");
        /// Points on the light, which share its strength; with jittered sampling, along each side
        /// of the grid.
        pub samples: u32 = "samples": Integer(1, MOST_SAMPLES), Is(4.0);
    }
}

declared!(AreaLight, check);

fn check(light: &mut AreaLight, object: &Object<'_>) -> Result<()> {
    warn_of_power(object, light.intensity, light.color);
    // The report's format has this key, but the shape gives the position.
    object.get("position").map(|cursor| cursor.point()).transpose()?;
    check_samples(object, light.sampling, light.samples)?;
    note_samples(object, light);
    Ok(())
}

/// Says how many points an area light takes if that is left open: they decide time and noise.
fn note_samples(object: &Object<'_>, &AreaLight { sampling, samples, .. }: &AreaLight) {
    let absent = ["sampling", "samples"].into_iter().filter(|key| !object.has(key));
    let absent: Vec<String> = absent.map(|key| format!("{key:?}")).collect();
    if absent.is_empty() {
        return;
    }
    let points = match sampling {
        Sampling::Jittered => format!("{samples} x {samples}"),
        _ => samples.to_string(),
    };
    let cursor = object.cursor();
    let message = format!("has no {}", absent.join(" and "));
    let remedy = format!("{points} {} points on it are used", sampling.name());
    cursor.notes().note(&cursor.path(), &message, &remedy);
}

/// The shape of the light, whose components are the light's entity's.
const SHAPE: Declaration = Declaration {
    read: read_shape,
    write: |entity, to| {
        let shape = to.inner().variant(&shapes::LIT, entity);
        to.set("shape", shape);
    },
    ..Declaration::of_keys(keys! {
        /// The shape that emits the light: any shape, which needs no material.
        "shape": Variants(&shapes::LIT), Required;
    })
};

fn read_shape(object: &Object<'_>, entity: &mut EntityBuilder) -> Result<()> {
    let cursor = object.need("shape", "a shape, an object { ... }")?;
    let shape = cursor.variant(&shapes::LIT)?;
    shape.components(entity)?;
    if entity.get::<&Triangle>().is_some_and(|triangle| !triangle.has_area())
        && let Some(points) = shape.get("points")
    {
        return Err(points.error("a light must have an area").remedy("move the corners apart"));
    }
    Ok(())
}
