"""Renders of trimesh's meshes and scenes: python -m unittest discover python/tests, with trimesh and Pillow."""

import unittest
import warnings

import numpy as np
import trimesh
import wavecrest
from PIL import Image
from trimesh.transformations import translation_matrix
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial, SimpleMaterial

SIZE = {"width": 64, "height": 48}

# Red on the left, green on the right.
RED_GREEN = Image.fromarray(np.uint8([[[255, 0, 0], [0, 255, 0]]]).repeat(8, 0).repeat(8, 1))


def render(scene, **options):
    """The image, without a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return wavecrest.render(scene, **SIZE, **options)


def ball(visual=None, **colors):
    """A sphere whose poles are along z."""
    mesh = trimesh.creation.icosphere(subdivisions=2)
    if visual is not None:
        mesh.visual = visual
    for key, value in colors.items():
        setattr(mesh.visual, key, value)
    return mesh


def square(**material):
    """A square that faces +z, with all of an image."""
    corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    visual = TextureVisuals(uv=(np.array(corners)[:, :2] + 1) / 2, **material)
    return trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False)


class Visuals(unittest.TestCase):
    def assert_refused(self, text, scene):
        with self.assertRaises(wavecrest.Error) as caught:
            render(scene)
        self.assertIn(text, str(caught.exception))

    def test_a_mesh_without_colors_is_its_arrays(self):
        mesh = ball()
        plain = render(mesh)
        np.testing.assert_array_equal(plain, wavecrest.render(mesh.vertices, mesh.faces, **SIZE))
        self.assertIsNotNone(mesh.vertex_normals, "computed now, which changes nothing")
        np.testing.assert_array_equal(plain, render(trimesh.Scene(mesh)))

    def test_vertex_colors_are_those_of_arrays(self):
        colors = np.random.default_rng(1).integers(0, 256, (len(ball().vertices), 3)).astype(np.uint8)
        mesh = ball(vertex_colors=colors)
        image = render(mesh)
        expected = wavecrest.render(mesh.vertices, mesh.faces, colors=colors, **SIZE)
        np.testing.assert_array_equal(image, expected)
        np.testing.assert_array_equal(image, render(trimesh.Scene(mesh)))
        self.assertIs(mesh.visual.mesh, mesh)
        plain = wavecrest.render(mesh.vertices, mesh.faces, **SIZE)
        np.testing.assert_array_equal(wavecrest.render(mesh, colors=np.ones_like(mesh.vertices), **SIZE), plain)

    def test_face_colors_are_crisp(self):
        mesh = ball()
        is_left = mesh.triangles_center[:, 0] < 0
        colors = np.where(is_left[:, None], [255, 0, 0, 255], [0, 0, 255, 255]).astype(np.uint8)
        mesh.visual.face_colors = colors
        corners = mesh.vertices[mesh.faces.ravel()]
        faces = np.arange(len(corners)).reshape(-1, 3)
        expected = wavecrest.render(corners, faces, colors=colors[:, :3].repeat(3, 0), view="front", up="y", **SIZE)
        image = render(mesh, view="front", up="y")
        np.testing.assert_array_equal(image, expected)
        one, other = image[24, 24], image[24, 40]
        self.assertTrue(one[0] > 3 * one[2] and other[2] > 3 * other[0], (one, other))
        self.assertEqual((len(mesh.vertices), mesh.visual.kind), (len(ball().vertices), "face"), "unchanged")

    def test_alpha_is_opacity(self):
        options = {"view": "front", "up": "y", "background": (0, 0, 0), "lights": "headlight"}
        solid, half = (render(ball(vertex_colors=[255, 255, 255, alpha]), **options) for alpha in (255, 64))
        self.assertLess(half[24, 32].max(), 0.8 * solid[24, 32].max())

    def test_textures_are_shown_the_right_way_up(self):
        views = {"view": "front", "up": "y", "lights": "none"}
        upright = Image.fromarray(np.array(RED_GREEN).transpose(1, 0, 2))
        for material in ({"image": RED_GREEN}, {"material": SimpleMaterial(image=RED_GREEN, diffuse=[9, 9, 9, 255])},
                         {"material": PBRMaterial(baseColorTexture=RED_GREEN, metallicFactor=0.0)}):
            image = render(square(**material), **views)
            np.testing.assert_allclose(image[24, 20], [1, 0, 0], atol=1e-6)
            np.testing.assert_allclose(image[24, 44], [0, 1, 0], atol=1e-6)
        image = render(square(image=upright), **views)
        np.testing.assert_allclose(image[[12, 36], 32], [[1, 0, 0], [0, 1, 0]], atol=1e-6)

    def test_a_seam_of_a_texture_is_smooth(self):
        mesh = ball()
        is_left = mesh.triangles_center[:, 0] < 0
        faces = np.concatenate([mesh.faces[is_left], mesh.faces[~is_left] + len(mesh.vertices)])
        cut = trimesh.Trimesh(np.concatenate([mesh.vertices] * 2), faces, process=False)
        cut.remove_unreferenced_vertices()
        views = {"crease": 180, "view": "front", "up": "y"}
        seam = np.abs(render(cut, **views) - render(mesh, **views)).max()
        for one in (cut, mesh):
            white = Image.new("RGB", (4, 4), (255, 255, 255))
            one.visual = TextureVisuals(uv=np.zeros((len(one.vertices), 2)), image=white)
        joined = np.abs(render(cut, **views) - render(mesh, **views)).max()
        self.assertTrue(joined < 1e-5 and seam > 0.01, (joined, seam))

    def test_materials_are_those_of_gltf(self):
        def lit(**material):
            return render(ball(TextureVisuals(material=PBRMaterial(**material))), view="front", up="y")[24, 32]

        red = lit(baseColorFactor=[255, 0, 0, 255], metallicFactor=0.0, roughnessFactor=1.0)
        self.assertTrue(red[0] > 0.2 and red[1] < 0.02, red)
        metal = lit(baseColorFactor=[255, 0, 0, 255], metallicFactor=1.0, roughnessFactor=0.1)
        self.assertGreater(np.abs(metal - red).max(), 0.05)

    def test_scenes_have_transforms_and_materials(self):
        red, green = ball(vertex_colors=[255, 0, 0, 255]), ball(vertex_colors=[0, 255, 0, 255])
        scene = trimesh.Scene()
        scene.add_geometry(red, transform=translation_matrix([-2, 0, 0]))
        scene.add_geometry(green, transform=translation_matrix([2, 0, 0]))
        options = {"view": "front", "up": "y"}
        image, layers = wavecrest.render(scene, layers=["object"], **options, **SIZE)
        left, right = image[24, 16], image[24, 48]
        self.assertTrue(left[0] > 3 * left[1] and right[1] > 3 * right[0], (left, right))
        self.assertEqual(len(np.unique(layers["object"])), len(scene.geometry) + 1 + 1, "the ground, and nothing")
        self.assertIsNotNone(scene.camera, "made up now, which changes nothing")
        np.testing.assert_array_equal(render(scene, **options), image)
        self.assertGreater(np.abs(render(scene, camera=scene.camera_transform) - image).max(), 0.1)

    def test_a_list_with_colors_is_a_scene(self):
        plain, red = ball(), ball(vertex_colors=[255, 0, 0, 255])
        plain.apply_translation([4, 0, 0])
        np.testing.assert_array_equal(render([plain, red]), render(trimesh.Scene([plain, red])))
        self.assertIsNone(plain.visual.kind, "unchanged")

    def test_colors_far_from_zero_are_as_near_it(self):
        mesh = ball(vertex_colors=[255, 128, 0, 255])
        far = mesh.copy()
        far.apply_translation([450_000, 5_200_000, 100])
        np.testing.assert_allclose(render(far), render(mesh), atol=1e-3)

    def test_what_looks_like_a_mesh_needs_no_trimesh(self):
        class Kind:
            kind = None

        class Mesh:
            vertices, faces, visual = ball().vertices, ball().faces, Kind()

        plain = render(ball())
        np.testing.assert_array_equal(render(Mesh()), plain)
        Kind.kind = 7
        np.testing.assert_array_equal(render(Mesh()), plain)
        Kind.kind = "face"
        self.assert_refused("has no attribute 'copy'; correct it, or give vertices and faces", Mesh())

    def test_errors_say_what_is_wrong(self):
        self.assert_refused("scene: ", trimesh.Scene())
        self.assert_refused("image must be an image of Pillow, found <class 'numpy.ndarray'>",
                            square(image=np.zeros((8, 8, 3), np.uint8)))
        self.assert_refused("cannot write mode CMYK", square(image=RED_GREEN.convert("CMYK")))
        broken = ball(vertex_colors=[255, 0, 0, 255])
        broken.vertices[3] = np.nan
        self.assert_refused("vertices and transforms must be finite", broken)
        with self.assertWarnsRegex(UserWarning, "has no texture coordinates"):
            wavecrest.render(ball(TextureVisuals(image=RED_GREEN)), **SIZE)
        with self.assertRaisesRegex(wavecrest.Error, "no such camera, found x"):
            wavecrest.render(trimesh.Scene(ball()), camera="x", **SIZE)


if __name__ == "__main__":
    unittest.main()
