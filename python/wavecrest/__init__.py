"""Renders scenes, mesh files and arrays to NumPy arrays: render and save. Queries of rays: Mesh and Scene."""

import warnings
from functools import partial

import numpy as np

from . import _arrays, _native
from ._entry import entry
from ._images import render, save
from ._native import Error, __version__

__all__ = ["Error", "Mesh", "RayMeshIntersector", "Scene", "render", "save"]

# What a mesh is made of, for messages.
WHAT = f"a path, {_arrays.A_MESH}, or vertices with faces"


class Mesh:
    """A mesh of triangles, for queries of rays and points.

    Mesh(vertices, faces) takes arrays of the shapes (N, 3) and (M, 3), Mesh(mesh) one of trimesh, Open3D or PyVista, or
    another object with vertices and faces, or triangles, Mesh(path) and Mesh.load(path) a file (PLY, OBJ, STL). normals and
    uvs are those of vertices, (N, 3) and (N, 2), or of the corners of faces, (M, 3, 3) and (M, 3, 2); files have their own, and a mesh
    of trimesh its texture coordinates. bvh is the quality of the search tree, "fast" by default: "fastest" is built
    sooner, "on-demand" pays for fewer rays than faces.

    A mesh is a copy that does not change. It can be pickled.

    Which face is hit is decided with vertices and rays rounded once to single precision. If the first vertex, in
    float64, is more than 1024 from zero, vertices and origins are moved there first, in double precision. For these
    numbers hits are exact: no ray slips between two faces. Distances and locations are then those of the ray and the
    face as given: within 1e-12 of the size of coordinates, as float64; or if all arrays are float32, the distance
    rounded once to float32.

    Faces have two sides. Only hits after t_min, by default 0, and before t_max count. A distance is in lengths of the
    direction, which may be any finite number above zero. Rays that are not finite or have no direction hit nothing.
    One origin or direction, of the shape (3,) or (1, 3), is that of all rays. Work is done on all cores, without the
    GIL.

    Raises wavecrest.Error if arrays or the file are wrong, TypeError for arguments of a wrong type.

    >>> mesh = wavecrest.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> faces, distances = mesh.closest([[0.2, 0.2, 5]], [[0, 0, -1]])
    >>> print(faces, distances)
    [0] [5.]
    """

    @entry
    def __init__(self, vertices, faces=None, *, normals=None, uvs=None, bvh=None):
        points, faces = _arrays.parts(vertices, faces)
        if faces is not None:
            points, faces = _arrays.mesh(points, faces)
            points = points.copy()
            own = getattr(getattr(vertices, "visual", None), "uv", None)
            # Those of other things than vertices are left out.
            if uvs is None and np.shape(own) in [(len(points), 2), (len(faces), 3, 2)]:
                uvs = own
            normals = _attribute("normals", normals, 3, points, faces)
            uvs = _attribute("uvs", uvs, 2, points, faces)
        elif normals is not None or uvs is not None:
            raise Error("normals, uvs: only for vertices with faces")
        else:
            path = _arrays.path("vertices", WHAT, vertices)
            (points, faces, normals, uvs), origin, told = _native.load(path)
            points = points + np.array(origin) if any(origin) else points
            for text in told:
                warnings.warn(text, stacklevel=3)
        positions, origin = _arrays.relative(points)
        is_rounded = points.dtype == np.float64 and (positions + np.array(origin) != points).any()
        self._shapes = _native.mesh(
            (positions, origin, faces, (None, None)), points if is_rounded else None, _arrays.text("bvh", bvh)
        )
        self._vertices, self._faces, self._normals, self._uvs = points, faces, normals, uvs
        self._bvh = bvh or "fast"

    @staticmethod
    @entry
    def load(path, *, bvh=None):
        """The mesh of a file: PLY, OBJ or STL."""
        return Mesh(_arrays.path("path", "a path", path), bvh=bvh)

    @property
    @entry
    def vertices(self):
        """The vertices, shape (N, 3), as they were given."""
        return self._vertices.astype("float64")

    @property
    @entry
    def faces(self):
        """The vertex indices of the faces, shape (M, 3)."""
        return self._faces.astype("int64")

    @property
    def normals(self):
        """The normals of vertices, (N, 3), or of the corners of faces, (M, 3, 3), or None."""
        return None if self._normals is None else self._normals.copy()

    @property
    def uvs(self):
        """The texture coordinates of vertices, (N, 2), or of the corners of faces, (M, 3, 2), or None."""
        return None if self._uvs is None else self._uvs.copy()

    @property
    def ray(self):
        """The same queries with the names, arguments and results of trimesh."""
        return RayMeshIntersector(self)

    @entry
    def closest(self, origins, directions, *, t_min=None, t_max=None):
        """The closest hits of rays: faces and distances. A miss has the face -1 and the distance inf.

        Of faces at the same exact distance, as at an edge, the one with the lowest number is hit.
        """
        return self._shapes.closest(self._rays(origins, directions, t_min, t_max))

    @entry
    def any(self, origins, directions, *, t_min=None, t_max=None):
        """Whether rays hit anything."""
        return self._shapes.any(self._rays(origins, directions, t_min, t_max))

    @entry
    def all(self, origins, directions, *, t_min=None, t_max=None):
        """Every surface on rays, once: for each the number of the ray, the face and the distance, in the order of rays,
        then of distances, then of faces.

        A ray that meets an edge or a corner crosses those of the faces around it that it would cross if its origin
        were moved by an infinitesimal step, the same for all rays: one where it passes through a surface, none or two
        where it only touches one. So a closed mesh is left as often as it is entered. Where closest reports another
        face around that edge, the distance is the same. Of dozens of copies of a face, one may count for all.
        """
        rays = self._rays(origins, directions, t_min, t_max)
        numbers, faces, distances = self._shapes.hits(rays, True, True, None, ["rays", "faces", "distances"])
        return numbers, faces, distances.astype("float32") if rays[-1] else distances

    @entry
    def cast(self, origins, directions, *, t_min=None, t_max=None):
        """The closest hits as arrays by name, of which each has a row for each ray:

        - faces, -1 for a miss; distances, inf for a miss
        - locations, and barycentrics, the weights of the three corners there
        - normals of faces, of unit length, on the side from which corners run counter-clockwise
        - shading_normals, interpolated between those of the corners, or that of the face where there are none
        - uvs, texture coordinates, if the mesh has them

        Numbers are float64; for a miss, nan.
        """
        columns = ["faces", "distances", "locations", "barycentrics", "normals"]
        hits = _closest(self._shapes, _arrays.rays(origins, directions, t_min, t_max), columns)
        _interpolate(hits, [self], np.minimum(hits["faces"], 0))
        return hits

    @entry
    def contains(self, points, rule=None):
        """Whether points are inside a closed mesh. Rays from there cross it, as all counts, by the rule "parity" an odd
        number of times; by "winding", from inside to outside more or less often than the other way, so that what is in
        several closed parts that overlap is inside too. Points on the surface are inside or outside.
        """
        if _arrays.text("rule", rule) not in (None, "parity", "winding"):
            raise Error(_arrays.wrong("rule", "one of parity, winding", rule))
        points = _arrays.rows("points", points)
        return self._shapes.contains((points, None, (0.0, np.inf), False), rule == "winding")

    def _rays(self, origins, directions, t_min, t_max):
        is_single = self._vertices.dtype == np.float32
        return _arrays.rays(origins, directions, t_min, t_max, is_single=is_single)

    def __repr__(self):
        vertices, faces = self._vertices.shape, self._faces.shape
        return f'<wavecrest.Mesh(vertices.shape={vertices}, faces.shape={faces}, bvh="{self._bvh}")>'

    def __copy__(self):
        """What a mesh does not change, a copy shares."""
        return self

    def __deepcopy__(self, memo):
        return self

    def __reduce__(self):
        make = partial(Mesh, normals=self._normals, uvs=self._uvs, bvh=self._bvh)
        return make, (self._vertices, self._faces)


class Scene:
    """Meshes in several places, for queries of rays.

    Scene([mesh, (mesh, transform), ...]) takes meshes, each perhaps with a matrix of 4 x 4 numbers from its space to
    that of the scene. Each is an instance, numbered in this order. A mesh may be there several times: it is stored
    once, and geometries, the distinct meshes, are numbered in the order in which they first appear.

    Which face is hit is exact in the space of its mesh: the ray, rounded once, is transformed there in double precision
    and rounded again. Distances and locations follow from the corners, transformed in double precision.
    Otherwise queries are those of Mesh. A scene has search trees of its own.
    """

    @entry
    def __init__(self, instances):
        self._instances = [_instance(number, one) for number, one in enumerate(instances)]
        self._meshes = list(dict.fromkeys(mesh for mesh, _ in self._instances))
        self._geometries = np.array([self._meshes.index(mesh) for mesh, _ in self._instances], "int64")
        places = [(number, place) for number, (_, place) in zip(self._geometries, self._instances)]
        bvh = self._meshes[-1]._bvh if self._meshes else None
        self._shapes = _native.scene([mesh._shapes for mesh in self._meshes], places, bvh)
        try:
            self._inverses = np.array([np.linalg.inv(place[:3, :3]) for _, place in self._instances])
        except np.linalg.LinAlgError:
            raise Error("instances: a matrix must have an inverse") from None

    @entry
    def cast(self, origins, directions, *, t_min=None, t_max=None):
        """The closest hits, as Mesh.cast returns them, with the number of the geometry and that of the instance besides,
        geometries and instances, both -1 for a miss. Normals are those in the space of the scene.
        """
        columns = ["faces", "instances", "distances", "locations", "barycentrics", "normals"]
        hits = _closest(self._shapes, _arrays.rays(origins, directions, t_min, t_max), columns)
        # A miss has the last.
        hits["geometries"] = np.append(self._geometries, -1)[hits["instances"]]
        _interpolate(hits, self._meshes, hits["geometries"], self._inverses)
        return hits

    @entry
    def any(self, origins, directions, *, t_min=None, t_max=None):
        """Whether rays hit anything."""
        return self._shapes.any(_arrays.rays(origins, directions, t_min, t_max))

    def __repr__(self):
        return f"<wavecrest.Scene(geometries={len(self._meshes)}, instances={len(self._instances)})>"

    def __reduce__(self):
        return Scene, (self._instances,)


class RayMeshIntersector:
    """Ray queries with the names, arguments and results of trimesh.

    mesh is one of trimesh, a wavecrest.Mesh, or whatever wavecrest.Mesh takes. The search tree of a mesh of trimesh is
    made at the first query, and made anew when the mesh has changed: its hash is compared at every query. Hits are in
    the order of rays, then of distances. Those at the origin of a ray do not count.

    >>> mesh.ray = wavecrest.RayMeshIntersector(mesh)  # a mesh of trimesh
    """

    def __init__(self, mesh):
        # Primitives of trimesh have no faces yet when they ask for their intersector.
        is_mesh = hasattr(type(mesh), "faces") or hasattr(mesh, "faces")
        self.mesh = mesh if is_mesh else Mesh(mesh)
        self._known = (None, None)

    @entry
    def intersects_id(self, ray_origins, ray_directions, multiple_hits=True, max_hits=None, return_locations=False):
        """The hits of rays: index_tri, index_ray, and with return_locations the locations.

        Without multiple_hits, only the closest hit of each ray. max_hits limits the hits of a ray; all by default.
        """
        columns = ["faces", "rays", "locations"] if return_locations else ["faces", "rays"]
        rays = _their_rays(ray_origins, ray_directions)
        most = _arrays.whole("max_hits", "a whole number", max_hits)
        return tuple(self._current()._shapes.hits(rays, multiple_hits, False, most, columns))

    @entry
    def intersects_location(self, ray_origins, ray_directions, multiple_hits=True, max_hits=None):
        """The locations of hits, and for each the index of the ray and of the face."""
        faces, rays, locations = self.intersects_id(ray_origins, ray_directions, multiple_hits, max_hits, True)
        return locations, rays, faces

    @entry
    def intersects_first(self, ray_origins, ray_directions):
        """The first face that each ray hits, or -1."""
        return self._current()._shapes.closest(_their_rays(ray_origins, ray_directions, True))[0]

    @entry
    def intersects_any(self, ray_origins, ray_directions):
        """Whether each ray hits anything."""
        return self._current()._shapes.any(_their_rays(ray_origins, ray_directions))

    @entry
    def contains_points(self, points):
        """Whether each point is inside the mesh, by parity."""
        return self._current().contains(points)

    def _current(self):
        """The mesh as it is now."""
        if isinstance(self.mesh, Mesh):
            return self.mesh
        try:
            key = hash(self.mesh)
        except Exception:
            key = None
        # What has no hash counts as changed.
        known = self._known
        if key is None or known[0] != key:
            known = self._known = (key, Mesh(self.mesh))
        return known[1]

    def __repr__(self):
        return f"<wavecrest.RayMeshIntersector({self.mesh!r})>"

    def __getstate__(self):
        return {"mesh": self.mesh}

    def __setstate__(self, state):
        # A mesh that is being unpickled with its rays has no arrays yet.
        self.mesh, self._known = state["mesh"], (None, None)


def _attribute(name, value, width, points, faces):
    """A copy of the values of vertices, (N, width), or of the corners of faces, (M, 3, width), as float32."""
    if value is None:
        return None
    value = _arrays.converted(name, value, "float32")
    of_vertices, of_corners = [len(points), width], [len(faces), 3, width]
    if list(value.shape) not in (of_vertices, of_corners):
        shapes = f"{of_vertices}, for vertices, or {of_corners}, for corners of faces"
        raise Error(f"{name}: must have the shape {shapes}, found {list(value.shape)}")
    return value.copy()


def _instance(number, value):
    """A mesh with its transform, (4, 4)."""
    what = "a wavecrest.Mesh, or a tuple of one and a 4 x 4 matrix whose last row is 0, 0, 0, 1"
    name = f"instances[{number}]"
    mesh, place = value if isinstance(value, tuple) and len(value) == 2 else (value, np.eye(4))
    if not isinstance(mesh, Mesh):
        raise TypeError(_arrays.wrong(name, what, value))
    place = _arrays.converted(name, place, "float64")
    if place.shape != (4, 4) or not np.isfinite(place).all() or place[3].tolist() != [0, 0, 0, 1]:
        raise Error(_arrays.wrong(name, what, value))
    return mesh, place.copy()


def _their_rays(origins, directions, is_single=False):
    """Rays by the names of trimesh: single where only faces matter, which are the same."""
    return _arrays.rays(origins, directions, is_single=is_single, names=("ray_origins", "ray_directions"))


def _closest(shapes, rays, columns):
    """What is known of the closest hits, by the names of columns."""
    return dict(zip(columns, shapes.hits(rays, False, True, None, columns)))


def _interpolate(hits, meshes, geometries, inverses=None):
    """Adds shading normals, and texture coordinates if there are any, to hits on meshes with these numbers, -1 for none;
    inverses are those of the transforms of instances, (3, 3) each."""
    weights = hits["barycentrics"]
    hits["shading_normals"] = hits["normals"].copy()
    if any(mesh._uvs is not None for mesh in meshes):
        hits["uvs"] = np.full((len(weights), 2), np.nan)
    for number, mesh in enumerate(meshes):
        if mesh._normals is None and mesh._uvs is None:
            continue
        at = np.flatnonzero(geometries == number)
        faces = hits["faces"][at]
        if mesh._normals is not None:
            normals = np.einsum("rc,rck->rk", weights[at], _unit(_of_corners(mesh, mesh._normals, faces)))
            if inverses is not None:
                normals = np.einsum("rk,rkj->rj", normals, inverses[hits["instances"][at]])
            normals = _unit(normals)
            # Those of corners without one are nan, and opposite ones have no sum.
            is_known = np.einsum("rk,rk->r", normals, normals) > 0
            hits["shading_normals"][at[is_known]] = normals[is_known]
        if mesh._uvs is not None:
            hits["uvs"][at] = np.einsum("rc,rck->rk", weights[at], _of_corners(mesh, mesh._uvs, faces))


def _of_corners(mesh, values, faces):
    """The values of the corners of faces, (R, 3, K), from those of vertices or of all corners."""
    corners = faces if values.ndim == 3 else mesh._faces.take(faces, axis=0)
    return values.take(corners, axis=0).astype("float64")


def _unit(vectors):
    """Vectors of unit length, or zero."""
    lengths = np.sqrt(np.einsum("...k,...k", vectors, vectors))[..., None]
    return vectors / np.where(lengths == 0, 1, lengths)
