use glam::Vec3;
use wavecrest_core::accel::build::Preset;
use wavecrest_core::accel::{Accel, KernelChoice};
use wavecrest_core::counters::{Average, KernelCounts, Kernels};
use wavecrest_core::math::ray::Ray;
use wavecrest_core::math::simd::{Level, is_wide};

use crate::kernels::{Numbers, answers, bumpy_sphere, through};

/// From one point, in blocks of 8 by 8, all to one side of it along each axis. They are no
/// multiple of a block.
fn coherent() -> Vec<Ray> {
    let ray = |i: u32| {
        let (block, within) = (i / 64, i % 64);
        let (x, y) = (block % 8 * 8 + within % 8, block / 8 * 8 + within / 8);
        let target = Vec3::new(x as f32 - 32.0, y as f32 - 32.0, 0.0) / 24.0;
        let origin = Vec3::new(-3.0, -3.0, 6.0);
        Ray::new(origin, target - origin)
    };
    (0..64 * 64 - 7).map(ray).collect()
}

/// What was counted with each kernel.
fn counted(rays: &[Ray]) -> [Kernels; 5] {
    let mut accel = Accel::new(bumpy_sphere(50), Preset::Fast);
    let mut usual = None;
    KernelChoice::ALL.map(|kernel| {
        accel.kernel = kernel;
        let mut counted = None;
        // With other levels every ray is taken alone.
        for level in Level::available() {
            accel.level = level.token().expect("it is available");
            let is_wide = is_wide(accel.level);
            let mut traversal = accel.traversal();
            let found = answers(&accel, rays, &mut traversal);
            assert!(*usual.get_or_insert(found.clone()) == found, "{kernel:?} {level:?}");
            let found = traversal.kernels;
            if is_wide {
                assert_eq!(*counted.get_or_insert(found), found, "{kernel:?} {level:?}");
            }
            for class in [found.closest, found.shadow] {
                assert_eq!(class.rays(), rays.len() as u64, "{kernel:?}");
                assert!(class.handed_over <= class.packet);
                assert!(is_wide || class.single == class.rays(), "{kernel:?} {level:?}");
            }
        }
        counted.unwrap_or_default()
    })
}

fn average(value: Average) -> f64 {
    Option::from(value).unwrap_or_default()
}

#[test]
fn coherent_rays_are_taken_by_whom_was_chosen() {
    let rays = coherent();
    let all = rays.len() as u64;
    let [auto, packet, stream, single, reference] = counted(&rays);
    for class in [auto.closest, auto.shadow, packet.closest, packet.shadow] {
        assert_eq!(class.packet, all, "a last tile of more than half is a packet's");
        assert!(class.handed_over > 0);
        assert!((8.0..=64.0).contains(&average(class.rays_a_node)), "{class:?}");
    }
    for class in [stream.closest, stream.shadow] {
        assert_eq!((class.stream, class.rays_a_node), (all, Average::default()));
        assert!((48.0..=64.0).contains(&average(class.rays_a_round)), "{class:?}");
    }
    let alone = KernelCounts { single: all, ..KernelCounts::default() };
    for kernel in [single, reference] {
        assert_eq!([kernel.closest, kernel.shadow], [alone; 2]);
    }
}

#[test]
fn rays_with_nothing_in_common_are_taken_by_packets_only_where_that_is_asked() {
    let rays = through(&mut Numbers(2), 2000);
    let [auto, packet, ..] = counted(&rays);
    for class in [auto.closest, auto.shadow, packet.closest, packet.shadow] {
        // Directions of either sign, or longest along different axes, are unfit for a packet.
        assert_eq!((class.packet, class.stream), (0, 2000), "{class:?}");
    }
    // Of one sign, and longest along one axis, but crossing each other.
    let one_sided: Vec<Ray> = rays
        .iter()
        .map(|ray| {
            let direction = ray.direction.abs().max(Vec3::splat(1e-3)) + 4.0 * Vec3::Z;
            Ray::new(ray.origin - direction.normalize() * 4.0, direction)
        })
        .collect();
    let [auto, packet, ..] = counted(&one_sided);
    assert!(auto.closest.packet < 2000, "{auto:?}");
    assert_eq!(packet.closest.packet, 2000, "{packet:?}");
}
