//! Materials: one row of numbers for each shape.

use crate::components::{Map, SurfaceComponents};
use wavecrest_core::kernels::blinn_phong::Material;
use wavecrest_core::kernels::metal;

/// The material of each surface. Shapes of lights get an unused one. Metal maps whose texels do not
/// count give their material here.
pub(crate) fn run(surfaces: &[SurfaceComponents<'_>]) -> Vec<Material> {
    let of = |surface: &SurfaceComponents<'_>| {
        let material = surface.material.map_or(Material::BLACK, |m| Material {
            ks: m.ks as f32,
            kd: m.kd as f32,
            exponent: m.specular_exponent as f32,
            color: m.diffuse_color.as_vec3(),
            kr: m.kr as f32,
            tint: m.specular_color.as_vec3(),
            emission: m.emission.as_vec3(),
        });
        match surface.maps.metal.as_ref().is_some_and(Map::is_constant) {
            true => smooth_nonmetal(material),
            false => material,
        }
    };
    surfaces.iter().map(of).collect()
}

/// The material at every hit under a metal map whose factors are 0.
fn smooth_nonmetal(material: Material) -> Material {
    let look = metal::look(material.color.as_dvec3().into(), 0.0, 0.0);
    let (ks, kd, exponent) = (look.ks as f32, look.kd as f32, look.exponent as f32);
    Material { ks, kd, exponent, kr: look.kr as f32, ..material }
}

/// Bounds on the materials of surfaces in any texel: each weight as large as a metal map can make it.
pub(crate) fn possible(
    surfaces: &[SurfaceComponents<'_>],
    materials: &[Material],
) -> Vec<Material> {
    let may = |(surface, material): (&SurfaceComponents<'_>, &Material)| match &surface.maps.metal {
        Some(map) if !map.is_constant() => {
            let kr = if map.metallic > 0.0 { 1.0 } else { 0.0 };
            Material { ks: 1.0, kd: 1.0, kr, ..*material }
        }
        _ => *material,
    };
    surfaces.iter().zip(materials).map(may).collect()
}
