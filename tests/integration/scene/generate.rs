//! What every generated mesh must be: closed where it says so, facing outward, without a
//! degenerate triangle, and the same bits whoever makes it.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use glam::DVec3;

use wavecrest_base::error::ErrorKind;
use wavecrest_scene::generate::{Model, Recipe, mesh, write_ply};
use wavecrest_scene::mesh::{MeshData, load_bytes};

const ALL: [Model; 3] = [Model::Sphere, Model::Terrain, Model::Knot];

fn file_bytes(recipe: &Recipe) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.ply");
    let mut last = (0, 0);
    let written = write_ply(recipe, &path, &mut |done, total| {
        assert!(done >= last.0 && done <= total);
        last = (done, total);
    })
    .unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(written.bytes, bytes.len() as u64);
    assert_eq!(last, (written.bytes, written.bytes));
    let made = mesh(recipe).unwrap();
    let counts = [made.positions.len() as u64, made.triangles.len() as u64];
    assert_eq!([written.vertices, written.triangles], counts);
    // Nothing else is left in the folder.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    bytes
}

/// FNV-1a, 64 bits: enough to notice a change.
fn hash(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xCBF2_9CE4_8422_2325, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01B3))
}

fn corners(mesh: &MeshData, t: [u32; 3]) -> [DVec3; 3] {
    t.map(|v| mesh.positions[v as usize].as_dvec3())
}

/// Checks that the mesh is a closed manifold, oriented, and of this Euler characteristic.
fn assert_closed(mesh: &MeshData, euler: i64) {
    let mut edges = HashSet::new();
    for [a, b, c] in &mesh.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            assert!(edges.insert(edge), "directed edge {edge:?} twice");
        }
    }
    for (a, b) in &edges {
        assert!(edges.contains(&(*b, *a)), "edge {a} {b} has one side only");
    }
    assert_one_fan_a_vertex(mesh);
    let [v, e, f] = [mesh.positions.len(), edges.len() / 2, mesh.triangles.len()];
    assert_eq!(v as i64 - e as i64 + f as i64, euler);
}

/// Checks that the triangles about each vertex are one closed fan: that no two parts of the
/// surface meet in a point.
fn assert_one_fan_a_vertex(mesh: &MeshData) {
    let mut next: Vec<HashMap<u32, u32>> = vec![HashMap::new(); mesh.positions.len()];
    for &[a, b, c] in &mesh.triangles {
        for (at, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
            next[at as usize].insert(from, to);
        }
    }
    for (v, fan) in next.iter().enumerate() {
        let start = *fan.keys().next().expect("every vertex is used");
        let round = std::iter::successors(Some(start), |spoke| Some(fan[spoke]));
        let length = 1 + round.skip(1).take_while(|spoke| *spoke != start).count();
        assert_eq!(length, fan.len(), "vertex {v} has two fans");
    }
}

/// Checks that no triangle is near to having no area, as 32-bit floats hold it.
fn assert_no_degenerate(mesh: &MeshData) {
    let mut places = HashSet::new();
    for p in &mesh.positions {
        assert!(p.is_finite());
        assert!(places.insert(p.to_array().map(f32::to_bits)), "two vertices at {p}");
    }
    for &t in &mesh.triangles {
        let [a, b, c] = corners(mesh, t);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let height = (b - a).cross(c - a).length() / longest;
        assert!(height > 0.05 * longest, "triangle {t:?} is a sliver");
    }
}

fn volume(mesh: &MeshData) -> f64 {
    mesh.triangles
        .iter()
        .map(|&t| {
            let [a, b, c] = corners(mesh, t);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

#[test]
fn spheres_are_closed_and_face_outward() {
    for triangles in [48, 49, 1000, 20_000, 150_000] {
        for displacement in [0.0, 0.25, 0.5] {
            let recipe = Recipe { displacement, ..Recipe::new(Model::Sphere, triangles) };
            let mesh = mesh(&recipe).unwrap();
            assert_closed(&mesh, 2);
            assert_no_degenerate(&mesh);
            // About the centre every triangle faces away, whatever the displacement.
            for &t in &mesh.triangles {
                let [a, b, c] = corners(&mesh, t);
                assert!(a.dot(b.cross(c)) > 0.0);
            }
        }
    }
    let round = mesh(&Recipe { displacement: 0.0, ..Recipe::new(Model::Sphere, 50_000) }).unwrap();
    // A little less than the ball, since the corners are on it.
    let share = volume(&round) / (4.0 / 3.0 * std::f64::consts::PI);
    assert!(share > 0.999 && share < 1.0, "{share}");
}

#[test]
fn knots_are_closed_and_face_outward() {
    // Pappus: the area of the tube's section times the length of the centre line.
    let plain = std::f64::consts::PI * 0.18 * 0.18 * 22.85;
    for triangles in [2560, 30_000, 150_000] {
        for displacement in [0.0, 0.3, 0.5] {
            let recipe = Recipe { displacement, ..Recipe::new(Model::Knot, triangles) };
            let mesh = mesh(&recipe).unwrap();
            assert_closed(&mesh, 0);
            assert_no_degenerate(&mesh);
            assert!((volume(&mesh) / plain - 1.0).abs() < 0.15, "{}", volume(&mesh) / plain);
        }
    }
}

#[test]
fn terrain_is_one_sheet_with_one_border() {
    for triangles in [32, 5000, 100_000] {
        let mesh = mesh(&Recipe::new(Model::Terrain, triangles)).unwrap();
        assert_no_degenerate(&mesh);
        let edges: HashSet<(u32, u32)> =
            mesh.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        assert_eq!(edges.len(), 3 * mesh.triangles.len(), "a directed edge is used twice");
        let border = edges.iter().filter(|(a, b)| !edges.contains(&(*b, *a))).count();
        let side = (mesh.triangles.len() / 2).isqrt();
        assert_eq!(border, 4 * side);
    }
}

#[test]
fn normals_agree_with_the_triangles() {
    for model in ALL {
        let recipe = Recipe { normals: true, ..Recipe::new(model, 40_000) };
        let mesh = mesh(&recipe).unwrap();
        let normals = mesh.normals.as_ref().unwrap();
        assert!(normals.indices.is_none());
        assert_eq!(normals.values.len(), mesh.positions.len());
        let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
        for &t in &mesh.triangles {
            let [a, b, c] = corners(&mesh, t);
            for v in t {
                sums[v as usize] += (b - a).cross(c - a);
            }
        }
        let mut total = 0.0;
        for (normal, sum) in normals.values.iter().zip(&sums) {
            assert!((normal.length() - 1.0).abs() < 1e-6);
            let cosine = normal.as_dvec3().dot(sum.normalize());
            // On the crests of the terrain the triangles about a vertex differ widely.
            assert!(cosine > 0.5, "{model}: {cosine} at {normal}");
            total += cosine;
        }
        assert!(total / sums.len() as f64 > 0.99, "{model}: {}", total / sums.len() as f64);
    }
}

#[test]
fn counts_and_displacements_out_of_range_are_refused_with_what_is_allowed() {
    let refused = |recipe: Recipe, kind, words: &str| {
        let error = mesh(&recipe).unwrap_err();
        assert!(error.kind() == kind && error.to_string().contains(words), "{error}");
    };
    for model in ALL {
        for few in [0, 20] {
            let fewest = model.fewest_triangles().to_string();
            refused(Recipe::new(model, few), ErrorKind::Usage, &fewest);
        }
        for many in [model.most_triangles() + 1, u64::MAX] {
            let most = model.most_triangles().to_string();
            refused(Recipe::new(model, many), ErrorKind::Limit, &most);
        }
        for displacement in [-0.1, 11.0, f64::NAN, f64::INFINITY] {
            let recipe = Recipe { displacement, ..Recipe::new(model, 5000) };
            refused(recipe, ErrorKind::Usage, "displacement");
        }
    }
}

#[test]
fn bytes_do_not_depend_on_the_threads() {
    let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    for model in ALL {
        let recipe = Recipe { normals: true, ..Recipe::new(model, 60_000) };
        let one = pool(1).install(|| file_bytes(&recipe));
        let two = pool(2).install(|| file_bytes(&recipe));
        assert!(one == two && two == file_bytes(&recipe), "{model}");
        let other = file_bytes(&Recipe { seed: 2, ..recipe });
        assert_eq!(other.len(), one.len());
        assert!(other != one, "{model}");
    }
}

#[test]
fn the_file_holds_the_bits_of_the_mesh() {
    for model in ALL {
        for normals in [false, true] {
            // More than one buffer of faces.
            let recipe = Recipe { normals, ..Recipe::new(model, 700_000) };
            let bytes = file_bytes(&recipe);
            let read = load_bytes(Path::new("mesh.ply"), &bytes, 1 << 17).unwrap();
            assert!(read.mesh == mesh(&recipe).unwrap(), "{model} {normals}");
        }
    }
}

#[test]
fn small_meshes_keep_their_bytes() {
    let golden = [
        (Model::Sphere, 0xE299_17EB_7093_4E6F),
        (Model::Terrain, 0x129C_336F_50CD_71D6),
        (Model::Knot, 0x1D63_85F0_46E7_6340),
    ];
    let found = ALL.map(|model| {
        let recipe = Recipe { normals: true, ..Recipe::new(model, 3000) };
        (model, hash(&file_bytes(&recipe)))
    });
    assert_eq!(found, golden, "found {found:#X?}");
}
