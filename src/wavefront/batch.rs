//! The columns of a batch: structures of arrays, each with its unit, writer and readers.

use glam::Vec3;

use crate::accel::{Hit, Rays as RayColumns};
use crate::kernels::shade::{SHADOW_END, ShadingPoint, ShadowRequest};
use crate::math::ray::Ray;
use crate::prepared::PreparedScene;

/// Declares a structure of arrays: a column for each field, all of the same length.
macro_rules! columns {
    (
        $(#[$doc:meta])*
        $name:ident { $( $(#[$field_doc:meta])* $field:ident : $kind:ty ),+ $(,)? }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Default)]
        pub struct $name { $( $(#[$field_doc])* pub $field: $kind, )+ }

        impl $name {
            /// Columns with room for `capacity` rows.
            pub fn with_capacity(capacity: usize) -> Self {
                Self { $( $field: <$kind>::with_capacity(capacity), )+ }
            }

            /// Removes every row and keeps the room.
            pub fn clear(&mut self) {
                $( self.$field.clear(); )+
            }

            /// Number of rows.
            pub fn len(&self) -> usize {
                // Every column has as many.
                [$( Column::rows(&self.$field) ),+][0]
            }

            /// Whether there is no row.
            pub fn is_empty(&self) -> bool {
                self.len() == 0
            }

            /// Bytes that one row takes.
            pub const ROW_BYTES: usize = 0 $( + <$kind as Column>::ITEM_BYTES )+;
        }
    };
}

/// A column: one value, or three of a vector, for each row.
trait Column {
    const ITEM_BYTES: usize;

    fn rows(&self) -> usize;
}

impl<T> Column for Vec<T> {
    const ITEM_BYTES: usize = size_of::<T>();

    fn rows(&self) -> usize {
        self.len()
    }
}

impl Column for Vectors {
    const ITEM_BYTES: usize = 3 * size_of::<f32>();

    fn rows(&self) -> usize {
        self.x.len()
    }
}

/// A column of vectors, as a column for each coordinate.
#[derive(Clone, Debug, Default)]
pub struct Vectors {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl Vectors {
    fn with_capacity(n: usize) -> Self {
        Self { x: Vec::with_capacity(n), y: Vec::with_capacity(n), z: Vec::with_capacity(n) }
    }

    fn clear(&mut self) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
    }

    fn push(&mut self, v: Vec3) {
        self.x.push(v.x);
        self.y.push(v.y);
        self.z.push(v.z);
    }

    /// The `i`th vector.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Adds `v` to the `i`th vector.
    #[inline]
    pub fn add(&mut self, i: usize, v: Vec3) {
        self.x[i] += v.x;
        self.y[i] += v.y;
        self.z[i] += v.z;
    }
}

columns! {
    /// Rays from the camera or from mirrors, t from 0 to infinity. Written by generate and shade,
    /// read by intersect and shade.
    Rays {
        /// World space.
        origin: Vectors,
        /// World space, unit length.
        direction: Vectors,
        /// What the light along the ray counts for in its path; 1 for camera rays.
        throughput: Vectors,
        /// The path, by its number in the batch.
        path: Vec<u32>,
    }
}

impl RayColumns for Rays {
    fn count(&self) -> usize {
        self.path.len()
    }

    #[inline(always)]
    fn ray(&self, i: usize) -> Ray {
        Ray::new(self.origin.get(i), self.direction.get(i))
    }
}

impl Rays {
    /// Appends a ray.
    #[inline]
    pub fn push(&mut self, ray: &Ray, throughput: Vec3, path: u32) {
        self.origin.push(ray.origin);
        self.direction.push(ray.direction);
        self.throughput.push(throughput);
        self.path.push(path);
    }
}

columns! {
    /// One answer for each ray. Written by intersect, read by shade.
    Hits {
        /// t, infinite for a miss, and the primitive's number.
        hit: Vec<Hit>,
    }
}

columns! {
    /// Points that lights reach. Written by shade, read by shadow.
    LitPoints {
        /// World space.
        point: Vectors,
        /// Bound on the error of each coordinate.
        error: Vectors,
        /// Geometric, unit length, on the viewer's side.
        normal: Vectors,
        /// For lighting, unit length, on the viewer's side.
        shading_normal: Vectors,
        /// To the viewer, unit length.
        view: Vectors,
        /// Diffuse colour.
        color: Vectors,
        /// What light from here counts for in its path.
        throughput: Vectors,
        /// Weights of the highlight and of the diffuse part, and the highlight's exponent.
        reflection: Vectors,
        /// The path, by its number in the batch.
        path: Vec<u32>,
    }
}

impl LitPoints {
    /// Appends a point.
    #[inline]
    pub fn push(&mut self, p: &ShadingPoint, throughput: Vec3, path: u32) {
        self.point.push(p.point);
        self.error.push(p.error);
        self.normal.push(p.normal);
        self.shading_normal.push(p.shading_normal);
        self.view.push(p.view);
        self.color.push(p.color);
        self.throughput.push(throughput);
        self.reflection.push(Vec3::new(p.material.ks, p.material.kd, p.material.exponent));
        self.path.push(path);
    }

    /// The `i`th point. Its mirror weight is not kept: shade has used it already.
    #[inline]
    pub fn get(&self, i: usize) -> ShadingPoint {
        let reflection = self.reflection.get(i);
        let color = self.color.get(i);
        ShadingPoint {
            point: self.point.get(i),
            error: self.error.get(i),
            normal: self.normal.get(i),
            shading_normal: self.shading_normal.get(i),
            view: self.view.get(i),
            color,
            material: crate::kernels::blinn_phong::Material {
                ks: reflection.x,
                kd: reflection.y,
                exponent: reflection.z,
                color,
                kr: 0.0,
            },
            lit: true,
        }
    }
}

columns! {
    /// Shadow rays, t from 0 to [`SHADOW_END`]. Written and read by shadow.
    ShadowRays {
        /// World space.
        origin: Vectors,
        /// To the light: its length is the distance.
        direction: Vectors,
        /// What to add to the path if nothing is in the way.
        contribution: Vectors,
        /// The path, by its number in the batch.
        path: Vec<u32>,
        /// Whether something is in the way.
        occluded: Vec<bool>,
    }
}

impl RayColumns for ShadowRays {
    fn count(&self) -> usize {
        self.path.len()
    }

    #[inline(always)]
    fn ray(&self, i: usize) -> Ray {
        Ray { t_max: SHADOW_END, ..Ray::new(self.origin.get(i), self.direction.get(i)) }
    }
}

impl ShadowRays {
    /// Appends a request.
    #[inline]
    pub fn push(&mut self, request: &ShadowRequest, path: u32) {
        self.origin.push(request.ray.origin);
        self.direction.push(request.ray.direction);
        self.contribution.push(request.contribution);
        self.path.push(path);
        self.occluded.push(false);
    }
}

columns! {
    /// The paths of the batch. Written by every pass, read by resolve.
    Paths {
        /// Light gathered so far.
        radiance: Vectors,
        /// The pixel, by its number in the image.
        pixel: Vec<u32>,
        /// The camera ray within the pixel.
        sample: Vec<u32>,
        /// The pixel, by its number in the tile.
        place: Vec<u32>,
    }
}

impl Paths {
    /// Appends a path that has gathered no light yet.
    #[inline]
    pub fn push(&mut self, pixel: u32, sample: u32, place: u32) {
        self.radiance.push(Vec3::ZERO);
        self.pixel.push(pixel);
        self.sample.push(sample);
        self.place.push(place);
    }
}

/// The memory of one wavefront.
#[derive(Debug)]
pub struct Batch {
    capacity: usize,
    /// The paths.
    pub paths: Paths,
    /// The rays of this bounce.
    pub rays: Rays,
    /// Their hits.
    pub hits: Hits,
    /// Where they hit something that lights reach.
    pub lit: LitPoints,
    /// Shadow rays on their way.
    pub shadows: ShadowRays,
    /// The rays of the next bounce.
    pub next: Rays,
}

impl Batch {
    /// A batch of up to `capacity` paths, with the columns that `scene` calls for.
    pub fn new(scene: &PreparedScene, capacity: usize) -> Self {
        let capacity = capacity.max(1);
        let lights = if scene.plan.has_shadows() { capacity } else { 0 };
        let mirrors = if scene.bounces > 0 { capacity } else { 0 };
        Self {
            capacity,
            paths: Paths::with_capacity(capacity),
            rays: Rays::with_capacity(capacity),
            hits: Hits::with_capacity(capacity),
            lit: LitPoints::with_capacity(lights),
            shadows: ShadowRays::with_capacity(lights),
            next: Rays::with_capacity(mirrors),
        }
    }

    /// The greatest number of paths.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// Makes the next bounce's rays this bounce's. False where there are none.
    pub fn advance(&mut self) -> bool {
        std::mem::swap(&mut self.rays, &mut self.next);
        self.next.clear();
        !self.rays.is_empty()
    }

    /// Bytes for each path in the columns that `scene` calls for, by the column group's name.
    pub fn bytes_per_path(scene: &PreparedScene) -> Vec<(&'static str, usize)> {
        let mut groups =
            vec![("paths", Paths::ROW_BYTES), ("rays", Rays::ROW_BYTES), ("hits", Hits::ROW_BYTES)];
        if scene.plan.has_shadows() {
            groups.push(("lit points", LitPoints::ROW_BYTES));
            groups.push(("shadow rays", ShadowRays::ROW_BYTES));
        }
        if scene.bounces > 0 {
            groups.push(("next rays", Rays::ROW_BYTES));
        }
        groups
    }
}
