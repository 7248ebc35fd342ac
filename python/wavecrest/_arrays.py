"""Makes contiguous arrays and numbers of what is given; errors name the argument, its value and the remedy."""

import os
from math import inf
from operator import index

import numpy as np

from . import _native

# Messages quote no more characters of a value.
LONGEST_VALUE = 80

# The objects that are meshes, for messages.
A_MESH = "a mesh of trimesh, PyVista (PolyData) or Open3D"


def wrong(name, what, value):
    """The message about an argument that is not `what` it must be."""
    return f"{name}: must be {what}, found {repr(value)[:LONGEST_VALUE]}"


def path(name, what, value):
    """The path, or a TypeError about an argument that must be `what`."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(wrong(name, what, value))
    return value


def text(name, value, what="a text"):
    """The text, or a TypeError; None is none."""
    if not isinstance(value, (str, type(None))):
        raise TypeError(wrong(name, what, value))
    return value


def number(name, what, value, fits=lambda number: True, kind=float):
    """The number, a whole one of the kind int; None is none. One that does not fit is an error."""
    if value is None:
        return None
    try:
        # Texts are no numbers, though float reads them.
        is_whole = kind is int or isinstance(value, (str, bytes, bytearray))
        made = index(value) if is_whole else float(value)
        if fits(made):
            return made
    except TypeError:
        raise TypeError(wrong(name, what, value)) from None
    except (ValueError, OverflowError):
        pass
    raise _native.Error(wrong(name, what, value))


def whole(name, what, value, least=0, most=2**64 - 1):
    """The whole number from least to most; None is none."""
    return number(name, what, value, lambda number: least <= number <= most, int)


def numbers(name, what, value, shape):
    """The array of float64 of this shape."""
    try:
        made = np.asarray(value).astype("float64", casting="same_kind")
    except TypeError:
        made = np.zeros(())
    except ValueError:
        made = np.zeros(0)
    if made.ndim == 0:
        raise TypeError(wrong(name, what, value))
    if made.shape != shape:
        raise _native.Error(wrong(name, what, value))
    return made


def converted(name, value, kind):
    """An array of this type of elements, without rounding floats to integers."""
    try:
        made = np.asarray(value).astype(kind, order="C", casting="same_kind", copy=False)
        return np.require(made, requirements="CA")
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name}: {error}") from None


def array(name, value, kind, shape):
    """An array of a shape such as "(N, 3)", of which the last number counts."""
    value = converted(name, value, kind)
    if value.ndim != len(shape.split(",")) or value.shape[-1] != 3:
        raise _native.Error(f"{name}: must have the shape {shape}, found {list(value.shape)}")
    return value


def rows(name, value):
    """Points or vectors, (N, 3): float32 and float64 as they are, others as float64. One may have the shape (3,), and an
    empty list is none."""
    try:
        value = np.asarray(value)
    except ValueError as error:
        raise TypeError(f"{name}: {error}") from None
    if value.shape in [(0,), (3,)]:
        value = value.reshape(-1, 3)
    return array(name, value, "float32" if value.dtype == np.float32 else "float64", "(N, 3)")


def parts(mesh, faces):
    """Vertices and faces, also of an object that has them, as those of trimesh (and wavecrest.Mesh), Open3D and PyVista
    do; for anything else, faces are None."""
    if faces is not None:
        return mesh, faces
    for points, numbers in (("vertices", "faces"), ("vertices", "triangles"), ("points", "faces")):
        if hasattr(mesh, points) and hasattr(mesh, numbers):
            vertices, faces = getattr(mesh, points), getattr(mesh, numbers)
            return vertices, faces if points == "vertices" else _unpadded(faces)
    return mesh, None


def _unpadded(faces):
    """Faces (M, 3), also those of a flat list in which the number of its corners stands before each."""
    faces = converted("faces", faces, "int64")
    if faces.ndim != 1:
        return faces
    counts = faces[::4]
    if len(faces) % 4 or (counts != 3).any():
        found = next((count for count in counts.tolist() if count != 3), "a part of one")
        raise _native.Error(f"faces: must be triangles, [3, a, b, c, 3, ...], found {found}; pass mesh.triangulate()")
    return faces.reshape(-1, 4)[:, 1:]


def joined(meshes):
    """The vertices and faces of all meshes of a list; of a list that begins with anything else, faces are None."""
    made = []
    for number, one in enumerate(meshes):
        try:
            vertices, faces = parts(one, None)
            if faces is None and not made:
                return meshes, None
            if faces is None:
                raise TypeError(wrong(f"scene[{number}]", f"{A_MESH}, as those before it", one))
            made.append(mesh(vertices, faces))
        except _native.Error as why:
            raise _native.Error(f"scene[{number}]: {why}") from None
    if not made:
        return meshes, None
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in made[:-1]])
    faces = [faces.astype("int64") + start for (_, faces), start in zip(made, starts)]
    return np.concatenate([vertices for vertices, _ in made]), np.concatenate(faces)


def mesh(vertices, faces):
    """Vertices, (N, 3), and faces, (M, 3), as uint32, which are indices of vertices."""
    vertices, faces = rows("vertices", vertices), array("faces", faces, "int64", "(M, 3)")
    count = len(vertices)
    is_wrong = (faces < 0) | (faces >= count)
    if is_wrong.any():
        number = is_wrong.any(axis=1).argmax()
        found = faces[number, is_wrong[number].argmax()]
        what = f"indices from 0 to {count - 1}, of the {count} vertices"
        raise _native.Error(f"faces[{number}]: must be {what}, found {found}")
    return vertices, faces.astype("uint32")


def relative(vertices):
    """The positions of vertices, as float32, relative to an origin near the first that is far from zero, and the origin."""
    if vertices.dtype == np.float32 or len(vertices) == 0:
        return vertices.astype("float32", copy=False), [0.0, 0.0, 0.0]
    origin = _native.origin(vertices[0])
    with np.errstate(over="ignore", invalid="ignore"):
        return (vertices - origin).astype("float32"), origin


def rays(origins, directions, t_min=None, t_max=None, *, is_single=False, names=("origins", "directions")):
    """Rays for the native part: one origin or direction is that of all. They are single if all arrays are float32."""
    origins, directions = rows(names[0], origins), rows(names[1], directions)
    count, found = len(origins), len(directions)
    if count != found and 1 not in (count, found):
        what = f"must have the shape of {names[0]}, [{count}, 3], or be one"
        raise _native.Error(f"{names[1]}: {what}, found [{found}, 3]")
    is_single = is_single and origins.dtype == directions.dtype == np.float32
    ends = (("t_min", t_min, 0.0), ("t_max", t_max, inf))
    ends = [number(key, "a number of at least 0", usual if t is None else t, lambda t: t >= 0) for key, t, usual in ends]
    return origins, directions, ends, is_single
