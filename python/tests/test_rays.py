"""Queries of rays, against trimesh and against exact arithmetic: python -m unittest discover python/tests."""

import multiprocessing
import re
import subprocess
import sys
import tempfile
import unittest
from fractions import Fraction
from pathlib import Path

try:
    import numpy as np
    import wavecrest
except ImportError as missing:
    raise unittest.SkipTest(f"{missing}: numpy and wavecrest are needed")

try:
    import rtree  # trimesh needs it for its own rays
    import trimesh
    from trimesh.ray.ray_triangle import RayMeshIntersector as Theirs
except ImportError as missing:
    trimesh = None
    WITHOUT = f"{missing}: not compared with trimesh"
else:
    WITHOUT = ""

# A cube of integers, counter-clockwise from outside: rays along axes run in its sides and along its edges.
CORNERS = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)], float)
SIDES = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
CUBE = [face for a, b, c, d in SIDES for face in ([a, b, c], [a, c, d])]


def terrain(n):
    """A height field over n times n cells."""
    x, y = np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1))
    z = 0.2 * np.sin(5 * x) * np.cos(4 * y) + 0.05 * np.sin(23 * x + 11 * y)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    faces = np.vstack([np.stack([a, a + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + n + 1], 1)])
    return trimesh.Trimesh(np.stack([x, y, z], -1).reshape(-1, 3), faces, process=False)


def ten_meshes():
    creation = trimesh.creation
    holed = creation.icosphere(2)
    holed = trimesh.Trimesh(holed.vertices, holed.faces[::3], process=False)
    two = trimesh.util.concatenate([creation.icosphere(2), creation.icosphere(2, radius=0.5)])
    return {
        "icosphere": creation.icosphere(3), "uv sphere": creation.uv_sphere(count=[16, 16]), "box": creation.box(),
        "torus": creation.torus(1, 0.3), "cylinder": creation.cylinder(0.5, 2), "cone": creation.cone(1, 2),
        "capsule": creation.capsule(1, 0.5), "terrain": terrain(24), "holed sphere": holed, "shells": two,
    }


def rays_at(mesh, count, rng):
    """Rays from around a mesh towards points in its box, and rays from there."""
    low, high = mesh.bounds
    inside = rng.uniform(low, high, (count, 3))
    around = rng.normal(size=(count, 3))
    around *= 2 * mesh.scale / np.linalg.norm(around, axis=1, keepdims=True)
    origins = np.where(rng.random((count, 1)) < 0.8, mesh.centroid + around, inside)
    return origins, rng.uniform(low, high, (count, 3)) - origins


def meets(origin, direction, corners):
    """The t at which a ray meets a closed triangle, in exact arithmetic."""
    o, d = ([Fraction(float(x)) for x in v] for v in (origin, direction))
    a, b, c = ([Fraction(float(x)) - o[k] for k, x in enumerate(v)] for v in corners)

    def det(u, v, w):
        return sum(w[i] * (u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2]) for i in range(3))

    sides = det(b, c, d), det(c, a, d), det(a, b, d)
    if min(sides) < 0 < max(sides) or sum(sides) == 0:
        return None
    t = det(a, b, c) / sum(sides)
    return t if t > 0 else None


class Rays(unittest.TestCase):
    def setUp(self):
        self.rng = np.random.default_rng(7)

    def test_hits_are_those_of_exact_arithmetic(self):
        rng = self.rng
        vertices = rng.integers(0, 5, (40, 3)).astype(np.float32)
        faces = rng.integers(0, 40, (30, 3))
        mesh = wavecrest.Mesh(vertices, faces)
        origins, targets = rng.integers(-2, 7, (2, 400, 3)).astype(float)
        hit, distance = mesh.closest(origins, targets - origins)
        rays, crossed, distances = mesh.all(origins, targets - origins)
        for i, (origin, target) in enumerate(zip(origins, targets)):
            met = {}
            for face, corners in enumerate(vertices[faces]):
                t = meets(origin, target - origin, corners)
                if t is not None:
                    met[face] = np.float32(float(t))
            closest = min(((t, face) for face, t in met.items()), default=(np.inf, -1))
            self.assertEqual((distance[i], hit[i]), closest)
            for face, t in zip(crossed[rays == i], distances[rays == i]):
                self.assertEqual(met[face], t)
        np.testing.assert_array_equal(mesh.any(origins, targets - origins), hit >= 0)
        self.assertTrue((hit >= 0).sum() > 50 and (distance[hit < 0] == np.inf).all())

    def test_every_surface_is_reported_once_at_edges_and_corners(self):
        mesh = wavecrest.Mesh(CORNERS, CUBE)
        # Through the middle of sides, where two faces meet, and from corner to corner.
        origins = [[0.5, 0.5, -3], [-3, 0.5, 0.5], [-1, -1, -1], [3, 3, 3], [2, -1, 0.5]]
        directions = [[0, 0, 1], [2, 0, 0], [1, 1, 1], [-1, -1, -1], [-1, 1, 0]]
        rays, faces, distances = mesh.all(origins, directions)
        self.assertEqual(rays.tolist(), [0, 0, 1, 1, 2, 2, 3, 3, 4, 4])
        self.assertEqual(distances.tolist(), [3, 4, 1.5, 2, 1, 2, 2, 3, 1, 2])
        # Rays that only touch an edge or run along one enter as often as they leave.
        n = 4000
        origins = self.rng.integers(-6, 8, (n, 3)) / 2
        directions = self.rng.integers(0, 3, (n, 3)) / 2 - origins
        outside = ((origins < 0) | (origins > 1)).any(axis=1)
        count = np.bincount(mesh.all(origins, directions)[0], minlength=n)
        self.assertTrue((count[outside] % 2 == 0).all())
        self.assertTrue(((count == 0) | (count == 2))[outside].all())

    def test_points_are_inside_by_exact_parity(self):
        mesh = wavecrest.Mesh(CORNERS, CUBE)
        points = self.rng.integers(-4, 9, (5000, 3)) / 4 + 0.125
        inside = ((points > 0) & (points < 1)).all(axis=1)
        np.testing.assert_array_equal(mesh.contains(points), inside)

    def test_arrays_of_any_kind_are_the_same_rays(self):
        mesh = wavecrest.Mesh(CORNERS.tolist(), CUBE)
        origins = np.array([[0.25, 0.5, 4], [9, 9, 9]])
        directions = np.array([[0, 0, -1], [0, 0, 1]])
        for kind in (np.float32, np.float64, np.int64):
            for array in (np.ascontiguousarray, np.asfortranarray):
                faces, distances = mesh.closest(array(origins), array(directions.astype(kind)))
                self.assertEqual((faces.dtype, distances.dtype), (np.int64, np.float32))
                self.assertEqual((faces[1], distances.tolist()), (-1, [3, np.inf]))
        many = np.repeat(origins, 3, axis=0)[::3]
        np.testing.assert_array_equal(mesh.any(many, directions), [True, False])
        self.assertEqual(mesh.any(origins, directions, t_max=3).tolist(), [False, False])
        self.assertEqual(mesh.all(np.zeros((0, 3)), np.zeros((0, 3)))[1].shape, (0,))
        bad = [[np.nan, 0, 0], [0, 0, 0]], [[0, 0, 1], [0, 0, 0]]
        self.assertEqual(mesh.closest(*bad)[0].tolist(), [-1, -1])
        np.testing.assert_array_equal(mesh.vertices, CORNERS)
        np.testing.assert_array_equal(mesh.faces, CUBE)

    def test_far_meshes_in_double_precision_keep_their_digits(self):
        far = np.array([5e6 + 0.25, -3e6, 0])
        mesh = wavecrest.Mesh(CORNERS + far, CUBE)
        origins = [far + [0.25, 0.5, 4]]
        self.assertEqual(mesh.closest(origins, [[0, 0, -1]])[1].tolist(), [3])
        self.assertEqual(mesh.contains([far + 0.999, far + 1.001]).tolist(), [True, False])
        np.testing.assert_array_equal(mesh.vertices, CORNERS + far)

    def test_files_are_meshes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "cube.obj")
            lines = ["v {} {} {}".format(*v) for v in CORNERS] + ["f {} {} {}".format(*np.add(f, 1)) for f in CUBE]
            path.write_text("\n".join(lines))
            for mesh in (wavecrest.Mesh(path), wavecrest.Mesh.load(str(path), bvh="on-demand")):
                self.assertEqual(mesh.closest([[0.5, 0.25, 9]], [[0, 0, -2]])[1].tolist(), [4])
            with self.assertRaisesRegex(wavecrest.Error, "missing.obj"):
                wavecrest.Mesh(Path(folder, "missing.obj"))

    def test_errors_name_argument_shape_and_remedy(self):
        mesh = wavecrest.Mesh(CORNERS, CUBE)
        with self.assertRaisesRegex(wavecrest.Error, r"origins: must have the shape \(N, 3\), found \[3\]"):
            mesh.closest([0, 0, 1], [[0, 0, 1]])
        with self.assertRaisesRegex(wavecrest.Error, r"directions: must have the shape of origins, \[1, 3\], found \[2"):
            mesh.all([[0, 0, 1]], [[0, 0, 1]] * 2)
        with self.assertRaisesRegex(wavecrest.Error, r"points: must have the shape \(N, 3\)"):
            mesh.contains(np.zeros((4, 2)))
        with self.assertRaisesRegex(TypeError, "directions: .*complex"):
            mesh.any([[0, 0, 1]], np.zeros((1, 3), complex))
        with self.assertRaisesRegex(wavecrest.Error, "t_max: must be a number of at least 0, found -1"):
            mesh.any([[0, 0, 1]], [[0, 0, 1]], t_max=-1)
        with self.assertRaisesRegex(wavecrest.Error, "bvh: must be one of .*fastest"):
            wavecrest.Mesh(CORNERS, CUBE, bvh="best")
        with self.assertRaisesRegex(wavecrest.Error, r"faces\[0\]: must be indices from 0 to 7"):
            wavecrest.Mesh(CORNERS, [[0, 1, 8]])
        with self.assertRaisesRegex(wavecrest.Error, "vertex 0"):
            wavecrest.Mesh(CORNERS * np.nan, CUBE)
        with self.assertRaisesRegex(TypeError, "vertices: must be a path, a mesh, or vertices with faces, found 7"):
            wavecrest.Mesh(7)
        with self.assertRaisesRegex(wavecrest.Error, "max_hits: must be a whole number, found -1"):
            mesh.ray.intersects_id([[0, 0, 1]], [[0, 0, 1]], max_hits=-1)

    @unittest.skipUnless("fork" in multiprocessing.get_all_start_methods(), "there is no fork")
    def test_a_forked_process_has_threads_of_its_own(self):
        mesh = wavecrest.Mesh(CORNERS, CUBE)
        origins = np.tile([[0.5, 0.25, 9]], (20_000, 1))
        expected = mesh.any(origins, -origins)
        with multiprocessing.get_context("fork").Pool(1) as pool:
            child = pool.apply_async(mesh_any, (origins,))
            np.testing.assert_array_equal(child.get(timeout=30), expected)


def mesh_any(origins):
    return wavecrest.Mesh(CORNERS, CUBE).any(origins, -origins)


@unittest.skipUnless(trimesh, WITHOUT)
class Readme(unittest.TestCase):
    def test_examples_run_as_they_are(self):
        text = (Path(__file__).parents[1] / "README.md").read_text()
        examples = re.findall("```python\n(.*?)```", text, re.DOTALL)
        self.assertEqual(len(examples), 3)
        for example in examples:
            with tempfile.TemporaryDirectory() as folder:
                subprocess.run([sys.executable, "-W", "error", "-c", example], check=True, cwd=folder)


@unittest.skipUnless(trimesh, WITHOUT)
class Trimesh(unittest.TestCase):
    """The same answers as trimesh's own, by the same names."""

    def setUp(self):
        rng = np.random.default_rng(11)
        self.cases = {name: (mesh, *rays_at(mesh, 300, rng)) for name, mesh in ten_meshes().items()}

    def test_queries_are_those_of_trimesh(self):
        hits = 0
        for name, (mesh, *rays) in self.cases.items():
            with self.subTest(name):
                ours, theirs = wavecrest.RayMeshIntersector(mesh), Theirs(mesh)
                np.testing.assert_array_equal(ours.intersects_any(*rays), theirs.intersects_any(*rays))
                np.testing.assert_array_equal(ours.intersects_first(*rays), theirs.intersects_first(*rays))
                for multiple in (True, False):
                    faces, index, places = ours.intersects_id(*rays, multiple, return_locations=True)
                    expected = theirs.intersects_id(*rays, multiple_hits=multiple, return_locations=True)
                    order, other = np.lexsort((faces, index)), np.lexsort(expected[:2])
                    np.testing.assert_array_equal(faces[order], expected[0][other])
                    np.testing.assert_array_equal(index[order], expected[1][other])
                    np.testing.assert_allclose(places[order], expected[2][other], atol=1e-5 * mesh.scale)
                    hits += len(faces)
                locations, index_ray, index_tri = ours.intersects_location(*rays)
                self.assertEqual((locations.shape, index_ray.shape), ((len(index_tri), 3), index_tri.shape))
                self.assertEqual((locations.dtype, index_ray.dtype), (np.float64, np.int64))
        self.assertGreater(hits, 3000)

    def test_max_hits_keeps_the_closest(self):
        mesh, *rays = self.cases["shells"]
        ray = wavecrest.Mesh(mesh).ray
        one = ray.intersects_id(*rays, max_hits=1)
        np.testing.assert_array_equal(one, ray.intersects_id(*rays, multiple_hits=False))
        self.assertGreater(len(ray.intersects_id(*rays, max_hits=3)[0]), len(one[0]))

    def test_points_are_inside_as_for_trimesh(self):
        for name, (mesh, *_) in self.cases.items():
            if mesh.is_watertight and name != "shells":
                with self.subTest(name):
                    points = np.random.default_rng(3).uniform(*mesh.bounds * 1.1, (500, 3))
                    ours = wavecrest.RayMeshIntersector(mesh).contains_points(points)
                    np.testing.assert_array_equal(ours, Theirs(mesh).contains_points(points))

    def test_a_mesh_takes_it_for_its_own(self):
        mesh = trimesh.creation.icosphere()
        mesh.ray = wavecrest.RayMeshIntersector(mesh)
        self.assertEqual(mesh.contains([[0, 0, 0], [2, 0, 0]]).tolist(), [True, False])


if __name__ == "__main__":
    unittest.main()
