//! Tiles that show nothing but the background: no ray of their pixels can meet anything, so none is
//! traced.

use super::{Grid, RenderOptions, tile_edge, window};
use crate::kernels::Aabb;
use crate::prepared::PreparedScene;
use crate::tile::{Tile, Unit};
use wavecrest_base::error::Result;

/// Where the background of a scene is seen alone.
pub(super) struct Backdrop<'a> {
    pub(super) scene: &'a PreparedScene,
    /// See [`Accel::outline`](crate::accel::Accel::outline); `None` if it is seen alone nowhere, for
    /// all that is known.
    boxes: Option<Vec<(Aabb, f32)>>,
}

impl<'a> Backdrop<'a> {
    pub(super) fn of(scene: &'a PreparedScene) -> Self {
        // A sample that is not finite is counted, and has to be traced for it.
        let is_even = scene.background.is_finite() && scene.environment.is_none();
        Self { scene, boxes: scene.accel.outline().filter(|_| is_even) }
    }

    /// Whether no ray of the tile can meet anything.
    pub(super) fn fills(&self, tile: &Tile) -> bool {
        let columns = || tile.x..tile.x + tile.width;
        let rows = || tile.y..tile.y + tile.height;
        let sees = |(bounds, widening): &(Aabb, f32)| {
            self.scene.camera.may_see_in([columns(), rows()], bounds, *widening)
        };
        self.boxes.as_ref().is_some_and(|boxes| !boxes.iter().any(sees))
    }

    /// Adds the samples of a unit that it fills. The sum of so many equal numbers of single
    /// precision is exact, and the product with their number is the same.
    pub(super) fn add(&self, unit: &Unit, sums: &mut [[f64; 3]]) {
        let color = self.scene.background.to_array();
        let color = color.map(|c| f64::from(c) * unit.samples.len() as f64);
        for sum in sums {
            *sum = [0, 1, 2].map(|k| sum[k] + color[k]);
        }
    }
}

/// Number of camera rays of a render of `scene`: none is traced in tiles that show nothing but the
/// background.
///
/// # Errors
/// If the crop is not within the image.
pub fn camera_rays(scene: &PreparedScene, options: &RenderOptions) -> Result<u64> {
    let grid = Grid::new(window(scene, options.crop)?, tile_edge(scene, options.batch));
    let backdrop = Backdrop::of(scene);
    let tiles = (0..grid.len()).map(|number| grid.tile(number));
    let pixels: u64 =
        tiles.filter(|tile| !backdrop.fills(tile)).map(|tile| tile.len() as u64).sum();
    Ok(pixels * u64::from(scene.camera.rays_per_pixel()))
}
