//! Lit points, and their columns that only some scenes need.

use glam::Vec3;

use super::columns::{Column, Vectors};
use crate::kernels::{Reflection, ShadingPoint};
use crate::math::{LANES, Mask, Single, Vector};

columns! {
    /// Points that lights may reach. Written by shade, read by shadow.
    LitPoints {
        /// World space.
        point: Vectors,
        /// Bound on the error of each coordinate.
        error: Vectors,
        /// Geometric unit normal on the viewer's side.
        normal: Vectors,
        /// Shading unit normal on the viewer's side.
        shading_normal: Vectors,
        /// Unit direction to the viewer.
        view: Vectors,
        /// Diffuse colour.
        color: Vectors,
        /// Throughput of the path at the point.
        throughput: Vectors,
        /// Weights of the highlight and of the diffuse part, and the highlight's exponent.
        reflection: Vectors,
        /// Share of the ambient light that the surface scatters.
        occlusion: Vec<f32>,
        /// The path, by its number in the batch.
        path: Vec<u32>,
    }
}

impl LitPoints {
    /// Appends the lit lanes, of these paths.
    #[inline(always)]
    pub fn push_lanes<F: Single>(
        &mut self,
        p: &ShadingPoint<F>,
        throughput: Vector<F>,
        path: &[u32; LANES],
    ) {
        let (i, lit) = (self.rows, p.lit);
        let Reflection { ks, kd, exponent, .. } = p.reflection;
        self.point.pack(i, p.point, lit);
        self.error.pack(i, p.error, lit);
        self.normal.pack(i, p.normal, lit);
        self.shading_normal.pack(i, p.shading_normal, lit);
        self.view.pack(i, p.view, lit);
        self.color.pack(i, p.color, lit);
        self.throughput.pack(i, throughput, lit);
        self.reflection.pack(i, Vector::new(ks, kd, exponent), lit);
        p.occlusion.pack(lit, &mut self.occlusion[i..i + F::LANES]);
        F::pack_integers(p.kr.token(), path, lit, &mut self.path[i..i + F::LANES]);
        self.rows += lit.bits().count_ones() as usize;
    }

    /// The points from the `i`th on, in the lanes of `used`, and their throughput. Their mirrors
    /// are left out.
    #[inline(always)]
    pub fn load<F: Single>(
        &self,
        token: F::Token,
        i: usize,
        used: u32,
    ) -> (ShadingPoint<F>, Vector<F>) {
        let Vector { x: ks, y: kd, z: exponent } = self.reflection.load::<F>(token, i);
        let point = ShadingPoint {
            point: self.point.load(token, i),
            error: self.error.load(token, i),
            normal: self.normal.load(token, i),
            shading_normal: self.shading_normal.load(token, i),
            view: self.view.load(token, i),
            color: self.color.load(token, i),
            occlusion: F::from_slice(token, &self.occlusion[i..i + F::LANES]),
            // Added by shade.
            emission: Vector::splat(token, Vec3::ZERO),
            reflection: Reflection { ks, kd, exponent, tint: Vector::splat(token, Vec3::ONE) },
            kr: F::splat(token, 0.0),
            opacity: F::splat(token, 1.0),
            lit: F::mask(token, used),
            inside: F::mask(token, 0),
        };
        (point, self.throughput.load(token, i))
    }
}

columns! {
    /// Highlight colours, a row for each of [`LitPoints`], if the scene needs them. Written by
    /// shade, read by shadow.
    Tints {
        /// The largest channel is usually 1.
        tint: Vectors,
    }
}

impl Tints {
    /// Appends the highlight colours of the lit lanes.
    #[inline(always)]
    pub fn push_lanes<F: Single>(&mut self, p: &ShadingPoint<F>) {
        self.tint.pack(self.rows, p.reflection.tint, p.lit);
        self.rows += p.lit.bits().count_ones() as usize;
    }
}
