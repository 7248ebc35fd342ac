//! What each part becomes, and what it is where the file does not say.

use std::path::PathBuf;

use glam::{DAffine3, DVec3, dvec3};
use serde_json::json;

use super::{accepted, at, complete, load, only, set, warnings, with, without};
use crate::components::{
    Ambient, AreaLight, Encoding, Facing, Falloff, Filter, FovAxis, JsonPath, Material, Mesh, Name,
    Order, Pinhole, PointLight, Quad, Sampling, Settings, Shading, Sides, Sphere, TextureRef,
    TextureSource, ThinLens, Transform, Triangle, View, Wrap,
};

#[test]
fn settings() {
    let settings: Settings = only(&load(&complete()).unwrap());
    let background = dvec3(0.1, 0.2, 0.3);
    let file = PathBuf::from("s.json");
    assert_eq!(
        settings,
        Settings {
            file,
            bounces: 3,
            background,
            ambient: Ambient::Even(0.1),
            transfer: Encoding::Srgb
        }
    );
    assert_eq!(load(&complete()).unwrap().transfer(), Encoding::Srgb);
    assert_eq!(load(&without("transfer")).unwrap().transfer(), Encoding::Linear);
    let settings: Settings = only(&load(&without("scene.ambient")).unwrap());
    assert_eq!(settings.ambient, Ambient::Even(0.08));
    let sky = json!({"sky": [0.1, 0.2, 0.3], "ground": [0, 0, 0], "up": [0, 0, 2]});
    let settings: Settings = only(&accepted("scene.ambient", sky));
    let (sky, ground) = (dvec3(0.1, 0.2, 0.3), DVec3::ZERO);
    assert_eq!(settings.ambient, Ambient::Hemisphere { sky, ground, up: 2.0 * DVec3::Z });
    let sky = json!({"sky": [0.1, 0.2, 0.3], "ground": [0, 0, 0]});
    let settings: Settings = only(&accepted("scene.ambient", sky));
    assert!(matches!(settings.ambient, Ambient::Hemisphere { up: DVec3::Y, .. }));
}

#[test]
fn thin_lens() {
    let scene = load(&complete()).unwrap();
    let view = View {
        location: dvec3(0.0, 0.0, 5.0),
        look: DVec3::ZERO,
        up: DVec3::Y,
        fov_degrees: 60.0,
        fov_axis: FovAxis::X,
        width: 640,
        height: 480,
        antialias: 2,
        sampling: Sampling::Jittered,
    };
    assert_eq!(only::<View>(&scene), view);
    let lens = ThinLens {
        aperture: 2.0,
        focal: 10.0,
        sampling: Sampling::Random,
        samples_x: 5,
        samples_y: 6,
    };
    assert_eq!(only::<ThinLens>(&scene), lens);
    assert_eq!(scene.world.query::<&Pinhole>().iter().count(), 0);
}

#[test]
fn thin_lens_defaults() {
    let camera = json!({
        "type": "thinlens", "width": 8, "height": 8, "fov": 60, "aperture": 1, "focal": 1,
        "location": [0, 0, 5], "look": [0, 0, 0]
    });
    let lens: ThinLens = only(&accepted("camera", camera));
    assert_eq!((lens.sampling, lens.samples_x, lens.samples_y), (Sampling::Jittered, 4, 4));
}

/// The report's key is about the lens; a Sobol sequence is one for pixel and lens.
#[test]
fn sampling_of_a_pixel() {
    let of = |camera: serde_json::Value, sampling: &str| {
        let mut camera = camera;
        camera["sampling"] = sampling.into();
        only::<View>(&accepted("camera", camera)).sampling
    };
    assert_eq!(of(pinhole(), "random"), Sampling::Random);
    assert_eq!(of(pinhole(), "sobol"), Sampling::Sobol);
    let mut lens = pinhole();
    (lens["type"], lens["aperture"], lens["focal"]) = (json!("thinlens"), json!(1), json!(1));
    assert_eq!(of(lens.clone(), "random"), Sampling::Jittered);
    assert_eq!(of(lens, "sobol"), Sampling::Sobol);
}

fn pinhole() -> serde_json::Value {
    json!({
        "type": "pinhole", "width": 8, "height": 8, "fov": 60,
        "location": [0, 0, 5], "look": [0, 0, 0]
    })
}

#[test]
fn pinhole_defaults() {
    let scene = accepted("camera", pinhole());
    only::<Pinhole>(&scene);
    let view: View = only(&scene);
    assert_eq!((view.up, view.fov_axis, view.antialias), (DVec3::Y, FovAxis::Smaller, 1));
    assert_eq!(scene.world.query::<&ThinLens>().iter().count(), 0);
}

#[test]
fn lens_keys_mean_nothing_to_a_pinhole() {
    let scene = set(with("camera", pinhole()), "camera.focal", json!(3));
    let text = "s.json: camera.focal: is not a key of a pinhole camera, found 3; it is ignored";
    assert_eq!(load(&scene).unwrap().warnings[0].to_string(), text);
}

#[test]
fn camera_aliases() {
    let moved = set(without("camera.location"), "camera.position", json!([1, 2, 3]));
    assert_eq!(only::<View>(&load(&moved).unwrap()).location, dvec3(1.0, 2.0, 3.0));
    for alias in ["lookat", "lookAt"] {
        let turned = set(without("camera.look"), &format!("camera.{alias}"), json!([1, 2, 3]));
        let scene = load(&turned).unwrap();
        assert_eq!(only::<View>(&scene).look, dvec3(1.0, 2.0, 3.0));
        assert_eq!(scene.warnings, []);
    }
}

#[test]
fn hc27_up_parallel_to_the_view() {
    let up = |look: serde_json::Value, up: serde_json::Value| {
        let scene = load(&set(with("camera.look", look), "camera.up", up)).unwrap();
        (only::<View>(&scene).up, scene.warnings.len())
    };
    assert_eq!(up(json!([0, 0, 0]), json!([0, 0, 1])), (DVec3::X, 1));
    assert_eq!(up(json!([0, 0, 0]), json!([1e-7, 0, 1])), (DVec3::X, 1));
    assert_eq!(up(json!([0, 0, 0]), json!([1e-5, 0, 1])), (dvec3(1e-5, 0.0, 1.0), 0));
    // The views are (3, 2, 1) and (3, 1, 2).
    assert_eq!(up(json!([3, 2, 6]), json!([-3, -2, -1])), (DVec3::Z, 1));
    assert_eq!(up(json!([3, 1, 7]), json!([3, 1, 2])), (DVec3::Y, 1));
}

#[test]
fn an_unsaid_up_is_substituted_too() {
    let above = set(without("camera.up"), "camera.location", json!([0, 5, 0]));
    let scene = load(&above).unwrap();
    assert_eq!(only::<View>(&scene).up, DVec3::X);
    assert_eq!(
        scene.warnings[0].to_string(),
        "s.json: camera.up: is parallel to the view direction, found [0, 1, 0]; \
         [1, 0, 0] is used instead"
    );
}

#[test]
fn lights() {
    let scene = load(&complete()).unwrap();
    let light = PointLight {
        intensity: 50.0,
        position: dvec3(1.0, 2.0, 3.0),
        color: DVec3::ONE,
        falloff: Falloff::None,
    };
    assert_eq!(at(&scene, "scene.lightsources[0]"), Some(light));
    let light = AreaLight {
        intensity: 40.0,
        color: DVec3::Y,
        falloff: Falloff::Linear,
        sampling: Sampling::Jittered,
        samples: 4,
    };
    let area = "scene.lightsources[1]";
    assert_eq!(at(&scene, area), Some(light));
    assert_eq!(at(&scene, area), Some(Order(1)));
    assert_eq!(at(&scene, area), Some(Facing::Flipped));
    assert!(at::<Quad>(&scene, area).is_some());
    assert_eq!(at::<Material>(&scene, area), None);
    assert_eq!(at::<Sides>(&scene, area), None);
    let scene = load(&without("scene.lightsources[0].falloff")).unwrap();
    assert_eq!(at::<PointLight>(&scene, "scene.lightsources[0]").unwrap().falloff, Falloff::Linear);
    let scene = accepted("scene.lightsources[0].falloff", json!("inverse-square"));
    let light: PointLight = at(&scene, "scene.lightsources[0]").unwrap();
    assert_eq!(light.falloff, Falloff::InverseSquare);
}

/// Both keys are in the report's examples, but not in all of its files.
#[test]
fn area_lights_without_samples_take_some_and_say_so() {
    let of = |absent: &[&str]| {
        let mut scene = complete();
        let light = scene["scene"]["lightsources"][1].as_object_mut().unwrap();
        light["samples"] = json!(7);
        absent.iter().for_each(|key| drop(light.remove(*key)));
        let light: AreaLight = at(&load(&scene).unwrap(), "scene.lightsources[1]").unwrap();
        (light.sampling, light.samples, warnings(&scene))
    };
    let told =
        |what: &str| vec![format!("scene.lightsources[1]: has no {what} points on it are used")];
    let all = told("\"sampling\" and \"samples\"; 4 x 4 jittered");
    assert_eq!(of(&["sampling", "samples"]), (Sampling::Jittered, 4, all));
    let told_sampling = told("\"sampling\"; 7 x 7 jittered");
    assert_eq!(of(&["sampling"]), (Sampling::Jittered, 7, told_sampling));
    let mut random = without("scene.lightsources[1].samples");
    random["scene"]["lightsources"][1]["sampling"] = json!("random");
    assert_eq!(warnings(&random), told("\"samples\"; 4 random"));
}

#[test]
fn area_lights_take_every_shape() {
    let path = "scene.lightsources[1].shape";
    let light = "scene.lightsources[1]";
    let sphere = json!({"type": "sphere", "center": [0, 0, 0], "radius": 1});
    assert!(at::<Sphere>(&accepted(path, sphere), light).is_some());
    let triangle = json!({"type": "triangle", "points": [[0, 0, 0], [0, 1, 0], [1, 0, 0]]});
    assert!(at::<Triangle>(&accepted(path, triangle), light).is_some());
    // What lights do not use is not looked at: the report's own examples leave it empty.
    let file = json!({"type": "trimesh", "file": "src/lib.rs", "material": {}, "texture": "none"});
    assert!(at::<Mesh>(&accepted(path, file), light).is_some());
}

#[test]
fn missing_lists_are_empty() {
    let scene = load(&without("scene.shapes")).unwrap();
    assert_eq!(scene.world.query::<&Material>().iter().count(), 0);
    let scene = load(&without("scene.lightsources")).unwrap();
    assert_eq!(scene.world.query::<&PointLight>().iter().count(), 0);
}

#[test]
fn shapes() {
    let scene = load(&complete()).unwrap();
    let ball = "scene.shapes[0]";
    assert_eq!(at(&scene, ball), Some(Sphere { center: dvec3(1.0, 2.0, 3.0), radius: 4.0 }));
    assert_eq!(at(&scene, ball), Some(Name("ball".into())));
    assert_eq!(at(&scene, ball), Some(Order(0)));
    assert_eq!(at(&scene, ball), Some(Sides::Front));
    let material = Material {
        emission: DVec3::ZERO,
        specular_color: DVec3::ONE,
        ks: 0.5,
        kd: 0.5,
        specular_exponent: 20.0,
        diffuse_color: dvec3(1.0, 0.0, 1.0),
        kr: 0.25,
    };
    assert_eq!(at(&scene, ball), Some(material));
    let texture = TextureRef {
        source: TextureSource::File(PathBuf::from("Cargo.toml")),
        encoding: Encoding::Srgb,
        tint: dvec3(0.5, 1.0, 0.25),
        filter: Filter::Nearest,
        wrap: Wrap::Clamp,
        placing: None,
    };
    assert_eq!(at(&scene, ball), Some(texture));
    assert_eq!(at(&scene, "scene.shapes[1]"), Some(Facing::Toward(DVec3::Z)));
    assert_eq!(at::<Facing>(&scene, "scene.shapes[2]"), None);
    assert_eq!(at::<Transform>(&scene, "scene.shapes[1]"), None);
    assert_eq!(at::<Name>(&scene, "scene.shapes[1]"), None);
    assert_eq!(at(&scene, "scene.shapes[3]"), Some(Shading::Smooth));
    assert_eq!(at::<Mesh>(&scene, "scene.shapes[5]").unwrap().file, Some("src/lib.rs".into()));
    assert_eq!(scene.world.query::<&JsonPath>().iter().count(), 8);
}

#[test]
fn shape_defaults() {
    let scene = load(&without("scene.shapes[0].sides")).unwrap();
    let sides: Vec<Option<Sides>> =
        (0..6).map(|i| at(&scene, &format!("scene.shapes[{i}]"))).collect();
    let (front, both) = (Some(Sides::Front), Some(Sides::Both));
    assert_eq!(sides, [both, front, front, front, both, both]);
    // A strip without fronts of its own has none.
    let strip = load(&without("scene.shapes[3].normal")).unwrap();
    assert_eq!(at(&strip, "scene.shapes[3]"), both);
    assert_eq!(at(&scene, "scene.shapes[1]"), Some(Shading::Flat));
    let scene = load(&without("scene.shapes[0].material.kr")).unwrap();
    assert_eq!(at::<Material>(&scene, "scene.shapes[0]").unwrap().kr, 0.0);
    let scene = accepted("scene.shapes[3].texture", json!("Cargo.toml"));
    let texture: TextureRef = at(&scene, "scene.shapes[3]").unwrap();
    assert_eq!((texture.filter, texture.wrap), (Filter::Bilinear, Wrap::Repeat));
    assert_eq!((texture.encoding, texture.tint), (Encoding::Linear, DVec3::ONE));
}

#[test]
fn ids_are_names() {
    let scene = accepted("scene.shapes[1].id", json!("floor"));
    assert_eq!(at(&scene, "scene.shapes[1]"), Some(Name("floor".into())));
}

fn transform(value: serde_json::Value) -> DAffine3 {
    let scene = accepted("scene.shapes[1].transform", value);
    at::<Transform>(&scene, "scene.shapes[1]").unwrap().0
}

#[test]
fn transforms() {
    assert_eq!(transform(json!({})), DAffine3::IDENTITY);
    let matrix = transform(json!([[1, 2, 0, 10], [0, 1, 0, 20], [0, 0, 3, 30], [0, 0, 0, 1]]));
    assert_eq!(matrix.transform_point3(DVec3::ONE), dvec3(13.0, 21.0, 33.0));
    // Scale, then rotate, then translate; quarters of a turn are exact.
    let all = transform(json!({"translate": [10, 0, 0], "rotate": [0, 90, 0], "scale": [2, 1, 1]}));
    assert_eq!(all.transform_point3(DVec3::X), dvec3(10.0, 0.0, -2.0));
    // About x first: y goes to z, which about z then stays.
    let turned = transform(json!({"rotate": [90, 0, 90]}));
    assert_eq!(turned.transform_point3(DVec3::Y), DVec3::Z);
    assert_eq!(turned.transform_point3(DVec3::X), DVec3::Y);
    let about_x_and_y = transform(json!({"rotate": [90, 90, 0]}));
    assert_eq!(about_x_and_y.transform_point3(DVec3::Y), DVec3::X);
    assert_eq!(transform(json!({"scale": -2})).matrix3.determinant(), -8.0);
    for (degrees, sine) in [(-30.0, -0.5), (30.0, 0.5), (150.0, 0.5), (210.0, -0.5), (750.0, 0.5)] {
        let turned = transform(json!({"rotate": [0, 0, degrees]}));
        assert!((turned.transform_point3(DVec3::X).y - sine).abs() < 1e-15, "{degrees}");
    }
}
