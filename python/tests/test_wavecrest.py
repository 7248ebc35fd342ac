"""What the module promises: python -m unittest discover python/tests, where it and the command are installed."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import warnings
from pathlib import Path

import numpy as np
import wavecrest

# A pyramid, counter-clockwise from outside.
VERTICES = [[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1], [0, 1.5, 0]]
FACES = [[0, 1, 2], [0, 2, 3], [0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]]

SCENE = {
    "nbounces": 1,
    "camera": {"type": "pinhole", "width": 64, "height": 48, "fov": 40, "location": [0, 1, 5], "look": [0, 0, 0]},
    "scene": {
        "backgroundcolor": [0, 0, 0.25],
        "lightsources": [{"type": "pointlight", "intensity": 60, "position": [2, 3, 5], "color": [1, 1, 1]}],
        "shapes": [{
            "type": "sphere", "center": [0, 0, 0], "radius": 1,
            "material": {"ks": 0.2, "kd": 0.8, "specularexponent": 20, "diffusecolor": [1, 0.5, 0]},
        }],
    },
}

# The scene under a square light, with one point on it.
CORNERS = [[-1, 4, -1], [-1, 4, 1], [1, 4, 1], [1, 4, -1]]
FLOOR = {"type": "plane", "points": [[-5, -1, 5], [-5, -1, -5], [5, -1, -5], [5, -1, 5]],
         "material": {"ks": 0, "kd": 0.8, "specularexponent": 1, "diffusecolor": [0.2, 0.3, 0.6]}}
SOFT = {**SCENE, "scene": {
    "backgroundcolor": [0, 0, 0.25],
    "lightsources": [{"type": "arealight", "intensity": 60, "color": [1, 1, 1], "sampling": "jittered", "samples": 1,
                      "shape": {"type": "plane", "points": CORNERS}}],
    "shapes": [*SCENE["scene"]["shapes"], FLOOR],
}}


def rmse(image, reference):
    return np.sqrt(np.mean((image.astype(float) - reference) ** 2))


def read_pfm(path):
    """The rows of a PFM file, which has the lowest first."""
    with open(path, "rb") as file:
        kind, size, scale = (file.readline() for _ in range(3))
        assert kind == b"PF\n" and float(scale) < 0, "little-endian colours"
        width, height = map(int, size.split())
        return np.fromfile(file, "<f4").reshape(height, width, 3)[::-1]


class Wavecrest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def ply(self):
        """The pyramid as a file."""
        path = self.folder / "pyramid.ply"
        head = ["ply", "format ascii 1.0", f"element vertex {len(VERTICES)}"]
        head += [f"property float {axis}" for axis in "xyz"]
        head += [f"element face {len(FACES)}", "property list uchar int vertex_indices", "end_header"]
        body = [" ".join(map(str, v)) for v in VERTICES] + [" ".join(map(str, [3, *f])) for f in FACES]
        path.write_text("\n".join(head + body) + "\n")
        return path

    def assert_refused(self, text, *args, **options):
        with self.assertRaises(wavecrest.Error) as caught:
            wavecrest.render(*args, **options)
        self.assertIn(text, str(caught.exception))

    def test_scene_as_a_dict_is_the_scene_file(self):
        path = self.folder / "scene.json"
        path.write_text(json.dumps(SCENE))
        image = wavecrest.render(path)
        self.assertEqual((image.shape, image.dtype), ((48, 64, 3), np.float32))
        self.assertEqual(image[0, 0].tolist(), [0, 0, 0.25])
        red, green, _ = image[24, 32]
        self.assertTrue(red > 0.1 and green < red)
        np.testing.assert_array_equal(image, wavecrest.render(SCENE))
        np.testing.assert_array_equal(image, wavecrest.render(str(path), threads=1))

    def test_arrays_are_the_mesh_file(self):
        options = {"width": 60, "height": 40, "view": "30,20", "background": (1, 1, 1), "seed": 3}
        image = wavecrest.render(self.ply(), **options)
        self.assertGreater(image.std(), 0.05)
        for dtype in (np.float32, np.float64):
            vertices = np.array(VERTICES, dtype)
            for faces in (FACES, np.array(FACES, np.uint32), np.asfortranarray(FACES)):
                np.testing.assert_array_equal(image, wavecrest.render(vertices, faces, **options))

    def test_image_is_that_of_the_command(self):
        path, out = self.ply(), self.folder / "out.pfm"
        command = ["wavecrest", "-q", path, out, "--width", "60", "--height", "40", "--precision", "exact"]
        subprocess.run(command, check=True)
        image = wavecrest.render(path, width=60, height=40, precision="exact")
        np.testing.assert_array_equal(image, read_pfm(out))

    def test_options_are_those_of_the_command(self):
        path, out, ours = self.ply(), self.folder / "out.png", self.folder / "ours.png"
        command = ["wavecrest", "-q", path, out, "--metadata", "none", "--size", "60x40"]
        command += ["--samples", "7", "--fit", "0.5", "--view", "30,20", "--background", "transparent"]
        subprocess.run(command, check=True)
        options = {"width": 60, "height": 40, "samples": 7, "fit": 0.5, "background": "transparent"}
        for view in ((30, 20), [30.0, 20.0], np.array([30, 20]), "30,20"):
            image = wavecrest.render(path, view=view, **options)
            wavecrest.save(ours, image)
            self.assertEqual(ours.read_bytes(), out.read_bytes())
        image, layers = wavecrest.render(path, layers=["samples"], **options)
        self.assertEqual((image.shape, image.dtype, set(layers)), ((40, 60, 4), np.float32, {"samples", "alpha"}))
        np.testing.assert_array_equal(image[..., 3], layers["alpha"])
        self.assertEqual((image[0, 0].tolist(), layers["samples"][0, 0]), ([0, 0, 0, 0], 9))
        with self.assertRaisesRegex(wavecrest.Error, "path: an image with alpha needs .png or .exr"):
            wavecrest.save(ours.with_suffix(".ppm"), image)
        white = wavecrest.render(path, width=60, height=40, background=(1, 1, 1))
        np.testing.assert_array_equal(wavecrest.render(path, width=60, height=40, background="#ffffff"), white)

    def test_a_camera_by_two_points_and_developed_light_are_those_of_the_command(self):
        path, out, ours = self.ply(), self.folder / "out.png", self.folder / "ours.png"
        command = ["wavecrest", "-q", path, out, "--metadata", "none", "--size", "60x40", "--from", "3,4,5", "--at", "0,1,0"]
        command += ["--exposure", "1.5", "--tone", "filmic"]
        options = {"eye": (3, 4, 5), "target": np.array([0, 1, 0]), "exposure": 1.5, "tone": "filmic", "width": 60, "height": 40}
        for more in ([], ["--background", "transparent"]):
            subprocess.run(command + more, check=True)
            wavecrest.save(ours, wavecrest.render(path, **options, **{"background": text for text in more[1:]}))
            self.assertEqual(ours.read_bytes(), out.read_bytes())
        usual = wavecrest.render(path, eye=[3, 4, 5], width=60, height=40)
        self.assertGreater(np.abs(usual - wavecrest.render(path, width=60, height=40)).max(), 0.01)
        self.assert_refused("eye: cannot be used with camera", path, eye=(3, 4, 5), camera=np.eye(4))
        self.assert_refused("target: needs eye", path, target=(3, 4, 5))
        self.assert_refused("eye: must be three numbers", path, eye=(3, 4, np.nan))
        self.assert_refused("would be at the point it looks at", path, eye=(3, 4, 5), target=(3, 4, 5))
        self.assert_refused("exposure: must be a number from -64 to 64, found 65", path, exposure=65)

    def test_wrong_names_are_answered_by_the_right_ones(self):
        for given, meant in {"widht": "width", "spp": "samples", "from_": "eye", "size": "width and height"}.items():
            with self.assertRaisesRegex(TypeError, f"render: there is no argument {given}; did you mean {meant}?"):
                wavecrest.render(SCENE, **{given: 3})
        with self.assertRaisesRegex(TypeError, "closest: there is no argument q; it has origins, directions, t_min, t_max"):
            wavecrest.Mesh(VERTICES, FACES).closest([0, 0, 0], [0, 0, 1], q=1)
        self.assert_refused('must be one of clip, filmic, found "filmik"; did you mean filmic?', SCENE, tone="filmik")

    def test_a_list_of_meshes_is_one_scene(self):
        class Part:
            faces = FACES

            def __init__(self, x):
                self.vertices = np.array(VERTICES) + [x, 0, 0]

        both = np.concatenate([Part(0).vertices, Part(3).vertices]), FACES + [[i + 5 for i in face] for face in FACES]
        expected = wavecrest.render(*both, width=64, height=48)
        np.testing.assert_array_equal(wavecrest.render([Part(0), Part(3)], width=64, height=48), expected)
        with self.assertRaisesRegex(TypeError, r"scene\[1\]: must be a mesh of .*, as those before it, found 7"):
            wavecrest.render([Part(0), 7])
        Part.faces = [[0, 1, 5]]
        self.assert_refused("scene[0]: faces[0]: must be indices", [Part(0)])

    def test_a_dict_may_hold_values_of_numpy(self):
        scene = json.loads(json.dumps(SCENE))
        scene["camera"].update(location=np.array([0, 1, 5.0]), width=np.int64(64), fov=np.float32(40))
        scene["scene"]["shapes"][0].update(center=np.zeros(3, np.float32), radius=np.float64(1))
        np.testing.assert_array_equal(wavecrest.render(scene), wavecrest.render(SCENE))

    def test_saved_images_are_those_of_the_command(self):
        path, ours, theirs = self.ply(), self.folder / "ours.pfm", self.folder / "theirs.ppm"
        image = wavecrest.render(path, width=60, height=40)
        wavecrest.save(ours, image)
        np.testing.assert_array_equal(image, read_pfm(ours))
        wavecrest.save(ours.with_suffix(".ppm"), image)
        subprocess.run(["wavecrest", "-q", path, theirs, "--width", "60", "--height", "40"], check=True)
        self.assertEqual(ours.with_suffix(".ppm").read_bytes(), theirs.read_bytes())
        with self.assertRaisesRegex(wavecrest.Error, "unknown image format"):
            wavecrest.save(self.folder / "out.pmp", image)
        with self.assertRaisesRegex(wavecrest.Error, "shape"):
            wavecrest.save(ours, image[..., 0])

    def test_eight_bits_are_saved_as_they_are(self):
        levels = np.arange(256 * 3, dtype=np.uint8).reshape(16, 16, 3)
        path = self.folder / "levels.ppm"
        for transfer in ("srgb", "linear"):
            wavecrest.save(path, levels, transfer=transfer)
            self.assertEqual(path.read_bytes()[-levels.size:], levels.tobytes())
        wavecrest.save(path.with_suffix(".pfm"), levels, transfer="linear")
        np.testing.assert_allclose(read_pfm(path.with_suffix(".pfm")), levels / 255, atol=1e-7)
        wavecrest.save(path, np.asfortranarray(levels)[::-1])
        self.assertEqual(path.read_bytes()[-levels.size:], levels[::-1].tobytes())

    def test_a_matrix_is_the_camera(self):
        pose = np.array([[1, 0, 0, 0], [0, 0.8, 0.6, 3], [0, -0.6, 0.8, 4], [0, 0, 0, 1]])
        scene = json.loads(json.dumps(SCENE))
        scene["camera"].update(location=[0, 3, 4], look=[0, 2.4, 3.2], up=[0, 0.8, -0.6])
        np.testing.assert_array_equal(wavecrest.render(scene), wavecrest.render(SCENE, camera=pose))
        for wrong in (np.eye(3), -np.eye(4), np.full((4, 4), np.nan), pose.T):
            self.assert_refused("camera: must be a name, or a 4 x 4 matrix", SCENE, camera=wrong)

    def test_layers_come_with_the_image(self):
        names = ["object", "depth", "normal"]
        image, layers = wavecrest.render(SCENE, layers=names)
        np.testing.assert_array_equal(image, wavecrest.render(SCENE))
        self.assertEqual({name: (array.shape, array.dtype) for name, array in layers.items()}, {
            "depth": ((48, 64), np.float32), "normal": ((48, 64, 3), np.float32), "object": ((48, 64), np.uint32)})
        self.assertEqual((layers["object"][0, 0], layers["object"][24, 32], layers["depth"][0, 0]), (0, 1, 0))
        self.assertAlmostEqual(layers["depth"][24, 32], np.sqrt(26) - 1, delta=0.01)
        np.testing.assert_allclose(layers["normal"][24, 32], np.array([0, 1, 5]) / np.sqrt(26), atol=0.05)
        self.assertEqual(wavecrest.render(SCENE, layers=[])[1], {})
        bright = {"colors": np.full((5, 3), 3e38), "layers": ["invalid"]}
        self.assertTrue(wavecrest.render(VERTICES, FACES, width=60, height=40, **bright)[1]["invalid"].any())
        self.assert_refused("layers: must be one of depth, normal", SCENE, layers=["depths"])

    def test_vertices_have_normals_and_colors(self):
        options = {"width": 60, "height": 40}
        plain = wavecrest.render(VERTICES, FACES, **options)
        normals = np.array(VERTICES) - [0, 0.5, 0]
        self.assertGreater(np.abs(wavecrest.render(VERTICES, FACES, normals=normals, **options) - plain).max(), 0.01)
        levels = np.tile(np.array([255, 0, 0], np.uint8), (5, 1))
        red = wavecrest.render(VERTICES, FACES, colors=levels, **options)
        np.testing.assert_array_equal(red, wavecrest.render(VERTICES, FACES, colors=levels / 255, **options))
        self.assertTrue(red[20, 30, 0] > 2 * red[20, 30, 1])
        self.assert_refused("colors: must have the shape of vertices, [5, 3], found [4, 3]", VERTICES, FACES,
                            colors=np.zeros((4, 3)))
        self.assert_refused("colors[2]: must be finite", VERTICES, FACES, colors=np.eye(5, 3) - np.eye(5, 3, -2) * 2)
        self.assert_refused("normals: only for vertices with faces", SCENE, normals=normals)

    def test_samples_for_an_error_are_those_of_the_command(self):
        path, out = self.folder / "soft.json", self.folder / "out.pfm"
        path.write_text(json.dumps(SOFT))
        command = ["wavecrest", "-q", path, out, "--target-error", "0.005", "--seed", "3"]
        subprocess.run(command, check=True)
        image, layers = wavecrest.render(path, target_error=0.005, seed=3, layers=["samples", "depth"])
        np.testing.assert_array_equal(image, read_pfm(out))
        self.assertTrue((layers["samples"] >= 4).all(), "of rays in a pixel")

    def test_an_error_is_reached(self):
        fine = json.loads(json.dumps(SOFT))
        fine["camera"].update(antialias=40, sampling="sobol")
        reference = wavecrest.render(fine, seed=7)
        coarse, better = (rmse(wavecrest.render(SOFT, target_error=e), reference) for e in (0.05, 0.005))
        self.assertTrue(better < coarse / 2 and better < 0.005 * 1.05, (coarse, better))

    def test_a_time_is_kept(self):
        fine = json.loads(json.dumps(SOFT))
        fine["camera"].update(antialias=40, sampling="sobol")
        reference = wavecrest.render(fine, seed=7)
        start = time.perf_counter()
        image = wavecrest.render(SOFT, time_budget=1, threads=1)
        self.assertLess(time.perf_counter() - start, 2)
        once = json.loads(json.dumps(SOFT))
        once["scene"]["lightsources"][0].update(samples=1)
        self.assertLess(rmse(image, reference), rmse(wavecrest.render(once), reference) / 2)

    def test_samples_are_the_most_of_a_goal(self):
        image, layers = wavecrest.render(SOFT, time_budget=600, samples=24, layers=["samples"])
        self.assertTrue((layers["samples"] == 24).all())
        fine = {**SOFT, "camera": {**SOFT["camera"], "antialias": 5, "sampling": "sobol"}}
        np.testing.assert_array_equal(wavecrest.render(SOFT, time_budget=600, samples=25), wavecrest.render(fine))

    def test_an_error_out_of_reach_is_a_warning(self):
        with self.assertWarnsRegex(UserWarning, "the target error .* was not reached: .*; choose a larger error"):
            wavecrest.render(SOFT, width=3, height=2, target_error=1e-7)

    def test_rays_in_a_pixel_are_chosen_where_nothing_else_is_random(self):
        image = wavecrest.render(SCENE, target_error=0.01)
        self.assertGreater(rmse(image, wavecrest.render(SCENE)), 0.001)
        np.testing.assert_array_equal(image[0, 0], [0, 0, 0.25])
        empty = {**SCENE, "scene": {**SCENE["scene"], "shapes": []}}
        np.testing.assert_array_equal(wavecrest.render(empty, target_error=0.01), wavecrest.render(empty))

    def test_errors_are_exceptions_that_say_where(self):
        self.assert_refused("missing.ply", "missing.ply")
        wrong = json.loads(json.dumps(SCENE))
        wrong["scene"]["shapes"][0]["radius"] = -2
        self.assert_refused("scene.shapes[0].radius", wrong)
        self.assert_refused("faces[1]: must be indices from 0 to 4", VERTICES, [[0, 1, 2], [0, 1, 5]])
        self.assert_refused("found -1", VERTICES, [[0, 1, -1]])
        self.assert_refused("has no triangles", VERTICES, np.zeros((0, 3), int))
        self.assert_refused("vertices: must have the shape (N, 3), found [5, 2]", np.zeros((5, 2)), FACES)
        self.assert_refused("vertex 4", VERTICES[:4] + [[np.nan, 0, 0]], FACES)
        self.assert_refused("precision: must be one of fast, exact", SCENE, precision="best")
        self.assert_refused("background", VERTICES, FACES, background=(1, -1, 0))
        self.assert_refused("background", VERTICES, FACES, background=(1, 1e13, 0))
        self.assert_refused("crease", VERTICES, FACES, crease=200)
        self.assert_refused("fov", VERTICES, FACES, fov=180)
        self.assert_refused("threads", SCENE, threads=0)
        for value in (0, -0.01, float("inf"), float("nan"), 10**400):
            self.assert_refused(f"target_error: must be a finite number above 0, found {str(value)[:80]}", SCENE,
                                target_error=value)
        with self.assertRaisesRegex(TypeError, "faces: .*float64"):
            wavecrest.render(VERTICES, np.array(FACES) + 0.5)
        for key, value in [("width", -1), ("height", 2**40), ("seed", -1), ("threads", -2), ("threads", 5000)]:
            self.assert_refused(f"{key}: must be a whole number", SCENE, **{key: value})
        self.assert_refused("found -1", SCENE, width=-1)
        self.assert_refused('found "sideways"', VERTICES, FACES, view="sideways")
        self.assert_refused("background: must be three numbers from 0 to 2^40, or a text, found (1, 2)", VERTICES, FACES,
                            background=(1, 2))
        self.assert_refused('background: use transparent, three numbers from 0 to 1, such as 1,0.5,0, or six hexadecimal digits, such as #ff8000, found "red"',
                            VERTICES, FACES, background="red")
        self.assert_refused("samples: must be a whole number from 1 to 4096, found 0", SCENE, samples=0)
        self.assert_refused("time_budget: must be a finite number above 0, found -1", SCENE, time_budget=-1)
        self.assert_refused("fit: write a share of the image", VERTICES, FACES, fit=2)
        self.assert_refused('found "400,2"', VERTICES, FACES, view=(400, 2))
        self.assert_refused("scene: as JSON: 'set' object", {"scene": {1, 2}})
        wrong_types = {"width": "wide", "camera": 3, "view": 3, "up": 1, "fov": "wide", "lights": 2,
                       "background": 7, "fit": "all", "samples": 2.5, "crease": "sharp", "seed": 0.5, "target_error": "fine", "precision": 1,
                       "threads": "many"}
        for key, value in wrong_types.items():
            with self.assertRaisesRegex(TypeError, f"{key}: must be .*, found {value!r}"):
                wavecrest.render(VERTICES, FACES, **{key: value})
        with self.assertRaisesRegex(TypeError, "scene: must be a path, a dict, a mesh of trimesh, .*, or vertices with faces"):
            wavecrest.render(7)
        with self.assertRaisesRegex(TypeError, "path: must be a path, found 7"):
            wavecrest.save(7, np.zeros((1, 1, 3)))

    @unittest.skipUnless(sys.platform == "linux", "limits and their measure are those of Linux")
    def test_refused_memory_is_an_exception(self):
        path = self.folder / "knot.ply"
        subprocess.run(["wavecrest", "generate", "knot", path, "--triangles", "1M"], check=True, capture_output=True)
        code = """
import resource, sys, wavecrest
taken = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (taken + 80 * 2**20, resource.RLIM_INFINITY))
wavecrest.render(sys.argv[1], threads=1)"""
        # Threads would reserve addresses for memory of their own.
        few = {**os.environ, "MALLOC_ARENA_MAX": "1"}
        ended = subprocess.run([sys.executable, "-c", code, path], capture_output=True, text=True, env=few)
        self.assertEqual(ended.returncode, 1, ended.stderr)
        self.assertIn("wavecrest.Error: the system refused", ended.stderr)

    def test_what_is_odd_is_a_warning(self):
        odd = {**SCENE, "nbounce": 2}
        with self.assertWarnsRegex(UserWarning, "nbounce"):
            wavecrest.render(odd)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaises(UserWarning):
                wavecrest.render(odd)

    def test_interrupt_ends_a_render(self):
        for more in ("", ", target_error=0.01"):
            code = "import sys, wavecrest; print(flush=True); "
            code += f"wavecrest.render(sys.argv[1], width=8000, height=8000{more})"
            process = subprocess.Popen([sys.executable, "-c", code, self.ply()], stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            process.stdout.readline()
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(0.5)
            process.send_signal(signal.SIGINT)
            _, told = process.communicate(timeout=20)
            self.assertIn("KeyboardInterrupt", told)


if __name__ == "__main__":
    unittest.main()
