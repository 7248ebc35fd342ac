from os import PathLike
from typing import Any, Literal

from numpy import float32
from numpy.typing import ArrayLike, NDArray

__version__: str

class Error(ValueError): ...

def render(
    scene: str | PathLike[str] | dict[str, Any] | ArrayLike,
    faces: ArrayLike | None = None,
    *,
    width: int | None = None,
    height: int | None = None,
    camera: str | None = None,
    view: str | None = None,
    up: str | None = None,
    fov: float | None = None,
    lights: Literal["studio", "headlight", "none"] | None = None,
    background: tuple[float, float, float] | None = None,
    crease: float | None = None,
    seed: int | None = None,
    precision: Literal["fast", "exact"] | None = None,
    threads: int | None = None,
) -> NDArray[float32]: ...

def save(
    path: str | PathLike[str],
    image: ArrayLike,
    *,
    transfer: Literal["srgb", "linear"] | None = None,
) -> None: ...
