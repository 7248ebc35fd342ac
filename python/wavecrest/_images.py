"""Images: render and save."""

import json
import warnings
from collections.abc import Sequence
from math import inf
from operator import methodcaller

import numpy as np

from . import _arrays, _native
from ._entry import entry

# As for the command.
MOST_THREADS = 4096

# The images of materials of trimesh.
IMAGES = "image baseColorTexture metallicRoughnessTexture normalTexture occlusionTexture emissiveTexture".split()


@entry
def render(
    scene, faces=None, *, width=None, height=None, camera=None, view=None, up=None, fov=None, fit=None, lights=None,
    background=None, crease=None, seed=None, samples=None, target_error=None, time_budget=None, precision=None, threads=None,
    normals=None, colors=None, layers=None, eye=None, target=None, exposure=None, tone=None,
):
    """Renders a scene to an array of shape (height, width, 3), top row first.

    scene is the path of a scene file, a glTF file or a mesh (PLY, OBJ, STL); a scene as a dict, with paths relative
    to the current folder, and values or arrays of NumPy; a mesh or a scene of trimesh, with its colours, textures and
    materials; or the vertices of a mesh, shape (N, 3), with the vertex indices of its triangles as faces, shape (M, 3), and
    perhaps the normals and colors of its vertices, of the same shape as these: colours are from 0 to 1, or uint8, with the
    sRGB curve. With normals or colors, those of a mesh of trimesh are left out. Any other object that wavecrest.Mesh takes
    is a mesh here too, and so is a list of meshes; the corners of plain ones are joined.

    A mesh is shown whole under studio lights; view, up, fov, fit, lights and crease change this, like the options of the
    command. view is the name of a side, such as "iso", or its azimuth and elevation in degrees, such as (30, 20). samples is
    the number of rays in a pixel, rounded up to a square; precision is "fast" or "exact" (default).

    background is a linear colour, a text such as "#ff8000" in sRGB, or "transparent": then the image has the shape (height,
    width, 4), with the coverage of the pixel from 0 to 1 as its last channel, by which the colours are multiplied.

    camera is the name of one in a glTF file, or its pose: a matrix of 4 x 4 numbers from the space of the camera, which
    looks along -z with y up, to that of the scene. eye is another place for the camera, and target the point that it looks
    at from there, by default the same as without.

    exposure, in stops of which each doubles the light, and tone, "clip" (default) or "filmic", develop the values of the
    image as the command does those of 8-bit formats.

    With layers, such as ["depth", "normal", "object"], returns the image and a dict of arrays: depth along the view,
    shape (height, width), shading normals, shape (height, width, 3), numbers of shapes from 1, and others as in the
    guide. Depth and object are 0 where there is nothing. A transparent background adds the layer "alpha".

    With target_error, time_budget or both, rays are the first points of a Sobol sequence, instead of those of the scene:
    until the error of the image, measured from its halves, is at most target_error (RMSE of linear values); a warning
    says if it is not reached. Or as many as fit into time_budget seconds, with reading and building, and one in any case.

    Values are linear red, green and blue; 8-bit formats store 0 to 1. The number of threads does not change them.

    Raises wavecrest.Error if the input cannot be rendered, or if the system refuses the memory for its tree and image;
    issues warnings. Ctrl-C stops the render.

    >>> image = wavecrest.render(mesh.vertices, mesh.faces, view="iso", width=800, height=600)  # a mesh of trimesh
    >>> wavecrest.save("mesh.png", image)
    """
    kind, source = _source(scene, faces, normals, colors)
    most, stops, is_positive = _native.MOST_SAMPLES, _native.MOST_STOPS, lambda number: 0 < number < inf
    name, pose = _camera(camera)
    words, color = _background(background)
    options = {
        "width": _arrays.whole("width", "a whole number of pixels", width, 0, 2**32 - 1),
        "height": _arrays.whole("height", "a whole number of pixels", height, 0, 2**32 - 1),
        "camera": name,
        "pose": pose,
        **_points(eye, target, camera),
        "view": _view(view),
        "up": _arrays.text("up", up),
        "fov": _written(_arrays.number("fov", "a number of degrees", fov)),
        "fit": _written(_arrays.number("fit", "a share of the image", fit)),
        "lights": _arrays.text("lights", lights),
        "background": words,
        "color": color,
        "crease": _arrays.number("crease", "a number of degrees from 0 to 180", crease, lambda angle: 0 <= angle <= 180),
        "exposure": _arrays.number(
            "exposure", f"a number from -{stops:g} to {stops:g}", exposure, lambda number: abs(number) <= stops
        ),
        "tone": _arrays.text("tone", tone),
        "seed": _arrays.whole("seed", "a whole number from 0 to 2^64 - 1", seed),
        "samples": _arrays.whole("samples", f"a whole number from 1 to {most}", samples, 1, most),
        "target_error": _arrays.number("target_error", "a finite number above 0", target_error, is_positive),
        "time_budget": _arrays.number("time_budget", "a finite number above 0", time_budget, is_positive),
        "precision": _arrays.text("precision", precision),
        "threads": _arrays.whole("threads", f"a whole number from 1 to {MOST_THREADS}", threads, 1, MOST_THREADS),
        "layers": _layers(layers),
    }
    image, found, told = _native.render(kind, source, options)
    for text in told:
        warnings.warn(text, stacklevel=3)
    arrays = {name: np.stack(parts, -1) if len(parts) > 1 else parts[0] for name, parts in found}
    if isinstance(background, str) and background == "transparent":
        image = np.dstack((image, arrays["alpha"]))
    return image if layers is None else (image, arrays)


@entry
def save(path, image, *, transfer=None):
    """Writes an image returned by render to a .png, .jpg, .ppm, .exr or .pfm file; with alpha to a .png, whose colours are
    not multiplied by it, or an .exr, whose colours are.

    8-bit formats use the transfer curve "srgb" (default) or "linear"; .exr and .pfm are always linear. An image of
    uint8 has been through that curve: its values are stored as they are in 8-bit formats.

    Raises wavecrest.Error if the file cannot be written.
    """
    _arrays.path("path", "a path", path)
    image, alpha = np.asarray(image), None
    if image.dtype == np.uint8:
        levels = np.arange(256, dtype="float32") / np.float32(255) if transfer == "linear" else _native.srgb_levels()
        image = np.array(levels, "float32")[image]
    elif image.ndim == 3 and image.shape[2] == 4:
        image, alpha = image[..., :3], image[..., 3].astype("float32", order="C")
    image = _arrays.array("image", image, "float32", "(height, width, 3)")
    _native.save(path, image, alpha, {"transfer": _arrays.text("transfer", transfer)})


def _source(scene, faces, normals, colors):
    """What to render: its kind, and what the native part takes for it."""
    is_plain = faces is None and normals is None and colors is None
    glb = _glb(scene) if is_plain else None
    if glb is not None:
        return "glb", glb
    if faces is None and isinstance(scene, (list, tuple)):
        vertices, faces = _arrays.joined(scene)
    else:
        vertices, faces = _arrays.parts(scene, faces)
    if faces is not None:
        vertices, faces = _arrays.mesh(vertices, faces)
        normals = _of_vertices("normals", normals, len(vertices))
        colors = _of_vertices("colors", colors, len(vertices))
        return "mesh", (*_arrays.relative(vertices), faces, (normals, colors))
    for name, value in (("normals", normals), ("colors", colors)):
        if value is not None:
            raise _native.Error(f"{name}: only for vertices with faces")
    if isinstance(scene, dict):
        try:
            return "json", json.dumps(scene, default=methodcaller("tolist"))
        except Exception as error:
            raise _native.Error(f"scene: as JSON: {error}") from None
    what = f"a path, a dict, {_arrays.A_MESH}, a list of meshes, a scene of trimesh, or vertices with faces"
    return "file", _arrays.path("scene", what, scene)


def _camera(value):
    """A camera: its name in the file, or the matrix that takes its space, where it looks along -z and y is up, to that of
    the scene."""
    if isinstance(value, (str, type(None))):
        return value, None
    what = "a name, or a 4 x 4 matrix of a right-handed camera, with 0, 0, 0, 1 as its last row"
    pose = _arrays.numbers("camera", what, value, (4, 4))
    x, y, z = pose[:3, :3].T
    if not np.isfinite(pose).all() or pose[3].tolist() != [0, 0, 0, 1] or x @ np.cross(y, z) <= 0:
        raise _native.Error(_arrays.wrong("camera", what, value))
    return None, pose.tolist()


def _points(eye, target, camera):
    """The points of a camera by name, unless another one is given."""
    what = "three numbers of at most 2^40"
    points = {"eye": eye, "target": target}
    for name, value in points.items():
        if value is not None:
            points[name] = _arrays.numbers(name, what, value, (3,)).tolist()
            if not all(abs(number) <= 2**40 for number in points[name]):
                raise _native.Error(_arrays.wrong(name, what, value))
    if eye is None and target is not None:
        raise _native.Error("target: needs eye, the place of the camera")
    if eye is not None and camera is not None:
        raise _native.Error("eye: cannot be used with camera; leave out one of them")
    return points


def _background(value):
    """A text, or a linear colour."""
    if isinstance(value, (str, type(None))):
        return value, None
    what = "three numbers from 0 to 2^40, or a text"
    color = _arrays.numbers("background", what, value, (3,))
    if not ((color >= 0) & (color <= 2**40)).all():
        raise _native.Error(_arrays.wrong("background", what, value))
    return None, color.tolist()


def _view(value):
    """The name of a side, or azimuth and elevation in degrees, as text has them."""
    if isinstance(value, (str, type(None))):
        return value
    what = "the name of a side, or two angles in degrees"
    try:
        return ",".join(map(_written, _arrays.numbers("view", what, value, (2,)).tolist()))
    except _native.Error as error:
        raise TypeError(str(error)) from None


def _written(number):
    """The number as text."""
    return None if number is None else repr(number).removesuffix(".0")


def _layers(names):
    if names is None:
        return None
    if isinstance(names, str) or not isinstance(names, Sequence):
        raise TypeError(_arrays.wrong("layers", "a list of names", names))
    for name in names:
        if not isinstance(name, str):
            raise TypeError(_arrays.wrong("layers", "a text", name))
    return list(names)


def _of_vertices(name, value, count):
    """Normals or linear colours of so many vertices, (count, 3), as float32."""
    if value is None:
        return None
    rows = _arrays.rows(name, value)
    if len(rows) != count:
        raise _native.Error(f"{name}: must have the shape of vertices, [{count}, 3], found [{len(rows)}, 3]")
    with np.errstate(over="ignore"):
        rows = rows.astype("float32")
    is_right = np.isfinite(rows) & ((rows >= 0) | (name == "normals"))
    if not is_right.all():
        number = is_right.all(axis=1).argmin()
        found = rows[number].tolist()
        raise _native.Error(f"{name}[{number}]: must be finite, and colours at least 0, found {found}")
    is_levels = name == "colors" and np.asarray(value).dtype == np.uint8
    return rows / np.float32(255) if is_levels else rows


def _glb(scene):
    """The bytes of a GLB file with a scene of trimesh, or with meshes of it of which one has colours or a material; None
    for anything else.

    trimesh writes it from a copy that is changed before: corners that faces share are divided, so that colours of faces
    stay crisp; a material without metalness becomes no metal, which its image alone colours; and a mesh that is far from
    zero is moved there in double precision. Normals are left out, as for any mesh: whether trimesh has computed them must
    not matter.
    """
    is_scene = hasattr(scene, "graph") and hasattr(scene, "geometry")
    is_list = isinstance(scene, (list, tuple)) and any(_kind(mesh) is not None for mesh in scene)
    if not (is_scene or is_list or _kind(scene) is not None):
        return None
    try:
        return _exported(_scene_of(scene) if is_list else scene.copy(), is_scene or is_list)
    except MemoryError:
        raise
    except Exception as why:
        raise _native.Error(f"scene: {why}; correct it, or give vertices and faces") from why


def _kind(mesh):
    """Whether a mesh has colours by "vertex" or "face", or a "texture"."""
    visual = getattr(mesh, "visual", None) if hasattr(mesh, "faces") else None
    kind = getattr(visual, "kind", None)
    return kind if isinstance(kind, str) else None


def _scene_of(meshes):
    """A scene of trimesh with copies of meshes."""
    first, *others = [mesh.copy() for mesh in meshes]
    scene = first.scene()
    scene.add_geometry(others)
    return scene


def _exported(scene, is_scene):
    if not is_scene:
        origin = np.array(_native.origin(scene.vertices[0]))
        scene.apply_translation(-origin)
        scene = scene.scene()
        scene.apply_translation(origin)
    # trimesh makes a camera up once it is asked for one.
    scene._camera = None
    for part in scene.geometry.values():
        kind = _kind(part)
        if kind == "face":
            _divide(part)
        elif kind == "texture":
            _convert(part.visual)
    if scene.bounds is not None and not np.isfinite(scene.bounds).all():
        raise _native.Error("vertices and transforms must be finite")
    return scene.export(None, "glb", include_normals=False)


def _divide(mesh):
    """Gives each face corners of its own, with its colour."""
    colors = mesh.visual.face_colors.repeat(3, 0)
    mesh.unmerge_vertices()
    mesh.visual.vertex_colors = colors


def _convert(visual):
    """Makes a material of diffuse colour and gloss one of metalness and roughness."""
    uvs, several = visual.uv, getattr(visual.material, "materials", None)
    visual.material = material = several[0] if several else visual.material
    for key in IMAGES:
        image = getattr(material, key, None)
        if image is not None and not hasattr(image, "save"):
            raise _native.Error(f"{key} must be an image of Pillow, found {type(image)}")
    if not hasattr(material, "image"):
        return
    made = material.to_pbr()
    made.metallicFactor, made.doubleSided = 0.0, True
    if material.image is not None and uvs is not None:
        made.baseColorFactor = [255] * 4
    visual.material = made
