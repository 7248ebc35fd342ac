from collections.abc import Iterable
from os import PathLike
from typing import Any, Literal, Protocol, TypedDict, overload

from numpy import bool_, float32, float64, int64, uint32
from numpy.typing import ArrayLike, NDArray
from typing_extensions import NotRequired, TypeAlias, Unpack

__version__: str
__all__: list[str]

class Error(ValueError): ...

class _Mesh(Protocol):
    """Such as trimesh.Trimesh."""

    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...

class _Triangles(Protocol):
    """Such as open3d.geometry.TriangleMesh."""

    @property
    def vertices(self) -> Any: ...
    @property
    def triangles(self) -> Any: ...

class _Points(Protocol):
    """Such as pyvista.PolyData."""

    @property
    def points(self) -> Any: ...
    @property
    def faces(self) -> Any: ...

_AnyMesh: TypeAlias = _Mesh | _Triangles | _Points

class _Scene(Protocol):
    """Such as trimesh.Scene."""

    @property
    def graph(self) -> Any: ...
    @property
    def geometry(self) -> Any: ...

_Bvh = Literal["brute", "on-demand", "fastest", "very-fast", "fast", "medium"]
_Layer = Literal["depth", "normal", "albedo", "position", "object", "material", "alpha", "samples", "invalid"]

class Mesh:
    # vertices (N, 3), faces (M, 3), normals (N, 3) or (M, 3, 3), uvs (N, 2) or (M, 3, 2)
    @overload
    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        bvh: _Bvh | None = None,
    ) -> None: ...
    @overload
    def __init__(
        self,
        vertices: str | PathLike[str] | _AnyMesh,
        faces: None = None,
        *,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        bvh: _Bvh | None = None,
    ) -> None: ...
    @staticmethod
    def load(path: str | PathLike[str], *, bvh: _Bvh | None = None) -> Mesh: ...
    # (N, 3)
    @property
    def vertices(self) -> NDArray[float64]: ...
    # (M, 3)
    @property
    def faces(self) -> NDArray[int64]: ...
    # (N, 3) or (M, 3, 3)
    @property
    def normals(self) -> NDArray[float32] | None: ...
    # (N, 2) or (M, 3, 2)
    @property
    def uvs(self) -> NDArray[float32] | None: ...
    @property
    def ray(self) -> RayMeshIntersector: ...
    # origins and directions (R, 3), or one of them (3,): faces (R,), distances (R,)
    def closest(
        self, origins: ArrayLike, directions: ArrayLike, *, t_min: float | None = None, t_max: float | None = None
    ) -> tuple[NDArray[int64], NDArray[float32] | NDArray[float64]]: ...
    # (R,)
    def any(
        self, origins: ArrayLike, directions: ArrayLike, *, t_min: float | None = None, t_max: float | None = None
    ) -> NDArray[bool_]: ...
    # rays (H,), faces (H,), distances (H,)
    def all(
        self, origins: ArrayLike, directions: ArrayLike, *, t_min: float | None = None, t_max: float | None = None
    ) -> tuple[NDArray[int64], NDArray[int64], NDArray[float32] | NDArray[float64]]: ...
    def cast(
        self, origins: ArrayLike, directions: ArrayLike, *, t_min: float | None = None, t_max: float | None = None
    ) -> _Hits: ...
    # points (P, 3): (P,)
    def contains(
        self, points: ArrayLike, rule: Literal["parity", "winding"] | None = None
    ) -> NDArray[bool_]: ...
    def __copy__(self) -> Mesh: ...
    def __deepcopy__(self, _memo: Any) -> Mesh: ...

class _Hits(TypedDict):
    # (R,)
    faces: NDArray[int64]
    distances: NDArray[float64]
    # (R, 3)
    locations: NDArray[float64]
    barycentrics: NDArray[float64]
    normals: NDArray[float64]
    shading_normals: NDArray[float64]
    # (R, 2), if there are texture coordinates
    uvs: NotRequired[NDArray[float64]]

class _SceneHits(_Hits):
    # (R,)
    geometries: NDArray[int64]
    instances: NDArray[int64]

class Scene:
    # Each transform (4, 4)
    def __init__(self, instances: Iterable[Mesh | tuple[Mesh, ArrayLike]]) -> None: ...
    # origins and directions (R, 3), or one of them (3,)
    def cast(
        self, origins: ArrayLike, directions: ArrayLike, *, t_min: float | None = None, t_max: float | None = None
    ) -> _SceneHits: ...
    # (R,)
    def any(
        self, origins: ArrayLike, directions: ArrayLike, *, t_min: float | None = None, t_max: float | None = None
    ) -> NDArray[bool_]: ...

class RayMeshIntersector:
    def __init__(self, mesh: Mesh | _AnyMesh | str | PathLike[str]) -> None: ...
    @property
    def mesh(self) -> Any: ...
    # index_tri (H,), index_ray (H,), locations (H, 3)
    @overload
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        return_locations: Literal[False] = False,
    ) -> tuple[NDArray[int64], NDArray[int64]]: ...
    @overload
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        *,
        return_locations: Literal[True],
    ) -> tuple[NDArray[int64], NDArray[int64], NDArray[float64]]: ...
    # locations (H, 3), index_ray (H,), index_tri (H,)
    def intersects_location(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
    ) -> tuple[NDArray[float64], NDArray[int64], NDArray[int64]]: ...
    # (R,)
    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[int64]: ...
    # (R,)
    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[bool_]: ...
    # (P,)
    def contains_points(self, points: ArrayLike) -> NDArray[bool_]: ...

class _Options(TypedDict, total=False):
    width: int | None
    height: int | None
    camera: str | ArrayLike | None
    eye: ArrayLike | None
    target: ArrayLike | None
    view: str | tuple[float, float] | None
    up: str | None
    fov: float | None
    fit: float | None
    lights: Literal["studio", "headlight", "none"] | None
    background: str | tuple[float, float, float] | None
    crease: float | None
    seed: int | None
    samples: int | None
    target_error: float | None
    time_budget: float | None
    precision: Literal["fast", "exact"] | None
    threads: int | None
    normals: ArrayLike | None
    colors: ArrayLike | None
    exposure: float | None
    tone: Literal["clip", "filmic"] | None

_Renderable: TypeAlias = str | PathLike[str] | dict[str, Any] | _AnyMesh | list[_AnyMesh] | _Scene | ArrayLike

# (height, width, 3); (height, width, 4) with a transparent background
@overload
def render(
    scene: _Renderable, faces: ArrayLike | None = None, *, layers: None = None, **options: Unpack[_Options]
) -> NDArray[float32]: ...
# With layers: an image as without, and arrays (height, width) or (height, width, 3)
@overload
def render(
    scene: _Renderable, faces: ArrayLike | None = None, *, layers: list[_Layer], **options: Unpack[_Options]
) -> tuple[NDArray[float32], dict[_Layer, NDArray[float32] | NDArray[uint32]]]: ...
def save(
    path: str | PathLike[str],
    image: ArrayLike,
    *,
    transfer: Literal["srgb", "linear"] | None = None,
) -> None: ...
