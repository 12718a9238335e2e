import enum
import os
from collections.abc import Callable, Iterator, KeysView, Mapping, Sequence
from types import TracebackType
from typing import Any, Literal, NamedTuple, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "CacheError", "Contact", "Contacts", "Departure", "DeviceError", "Flag", "Hand", "Loop", "MeshError", "Results",
    "SceneError", "Surface", "SurfacePoints", "Sweep", "Trace", "Triangles", "__version__", "check", "load",
]

__version__: str

_Path = str | os.PathLike[str]
_Quantity = float | str  # in SI, or text with a unit
_Method = Literal["gregory", "shaded", "flat"]
_Backend = Literal["tbb", "serial", "opencl", "auto"]
_Progress = Callable[[int, int], object] | bool | None
_Floats = NDArray[np.float64]
_Indices = NDArray[np.uint32]
_Bools = NDArray[np.bool_]
_Faces = NDArray[np.integer[Any]] | Sequence[Sequence[int]] | tuple[NDArray[np.integer[Any]], NDArray[np.integer[Any]]]

class MeshError(ValueError):
    findings: Sequence[dict[str, Any]]

class CacheError(ValueError):
    stale: bool

class SceneError(ValueError): ...
class DeviceError(RuntimeError): ...

class Flag(enum.IntFlag):
    CONVERGED = 1
    ON_BORDER = 2
    ON_CREASE = 4
    NOT_BUILT = 8
    UNFINISHED = 16
    SETTLING = 32
    SLIPPING = 64

class Results:
    def __init__(self, arrays: Mapping[str, NDArray[Any]]) -> None: ...
    def __getattr__(self, name: str) -> NDArray[Any]: ...
    def __dir__(self) -> list[str]: ...
    @overload
    def __getitem__(self, name: str) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, name: int | np.integer[Any]) -> dict[str, Any]: ...
    def __iter__(self) -> Iterator[dict[str, Any]]: ...
    def __len__(self) -> int: ...
    def __bool__(self) -> bool: ...
    def keys(self) -> KeysView[str]: ...
    def columns(self) -> dict[str, NDArray[Any]]: ...

class Contacts(Results):
    point: _Floats
    normal: _Floats
    distance: _Floats
    face: _Indices
    domain: _Floats
    touching: _Bools
    flags: _Indices
    iterations: NDArray[np.int32]
    @property
    def inside(self) -> _Bools: ...

class SurfacePoints(Results):
    point: _Floats
    d_xi: _Floats
    d_eta: _Floats
    normal: _Floats

class Triangles(Results):
    point: _Floats
    normal: _Floats
    triangles: _Indices

class Trace(Results):
    statistics: dict[str, Any]
    force: _Floats
    point: _Floats
    normal: _Floats
    distance: _Floats
    face: _Indices
    domain: _Floats
    touching: _Bools
    slipping: _Bools
    cone_share: _Floats
    flags: _Indices
    def __init__(self, arrays: Mapping[str, NDArray[Any]], statistics: dict[str, Any]) -> None: ...

class Sweep:
    statistics: list[dict[str, Any]]
    histograms: list[dict[str, NDArray[np.uint64]]]
    bin_edges: _Floats
    computed: int
    rings: int
    def __init__(self, figures: Mapping[str, Any]) -> None: ...

@final
class Contact:
    def __init__(self, *args: Any, **kwargs: Any) -> None: ...  # TypeError: a Hand makes them
    @property
    def force(self) -> _Floats: ...
    @property
    def point(self) -> _Floats: ...
    @property
    def normal(self) -> _Floats: ...
    @property
    def distance(self) -> float: ...
    @property
    def face(self) -> int: ...
    @property
    def domain(self) -> tuple[float, float]: ...
    @property
    def touching(self) -> bool: ...
    @property
    def slipping(self) -> bool: ...
    @property
    def cone_share(self) -> float: ...
    @property
    def flags(self) -> int: ...

class Hand:
    def __init__(
        self, surface: Surface, stiffness: _Quantity = "0.5N/mm", method: _Method = "gregory", *,
        settle: _Quantity = "5ms", friction: float | tuple[float, float] = 0.0, friction_settle: _Quantity = 0.0,
        damping: _Quantity = 0.0, viscosity: _Quantity = 0.0, magnet: tuple[_Quantity, _Quantity] | None = None,
        texture: tuple[str, _Quantity, _Quantity] | tuple[str, _Quantity, _Quantity, ArrayLike] | None = None,
    ) -> None: ...
    def tick(self, hip: ArrayLike, dt: _Quantity = 1e-3) -> Contact: ...
    def ticks(self, path: ArrayLike, dt: _Quantity = 1e-3) -> Results: ...

class Departure(NamedTuple):
    distance: float
    room: float
    face: int

class Surface:
    def __init__(
        self, vertices: ArrayLike, faces: _Faces, unit: _Quantity = "m", *,
        level: str | None = None, construction: Literal["fair", "paper"] | None = None,
        precision: Literal["float", "double"] | None = None, crease: str | None = None,
        crease_radius: _Quantity | None = None, weld: _Quantity | Literal[False] | None = None,
        normals: Literal["auto", "file", "made"] = "auto", orient: Literal["outward", "file"] = "outward",
        flip: bool = False, strict: bool = False, keep_non_manifold: bool = False,
        threads: int = 0, backend: _Backend = "tbb", opencl_device: str = "", progress: _Progress = None,
    ) -> None: ...
    @property
    def unit(self) -> float: ...
    @property
    def face_count(self) -> int: ...
    @property
    def faces(self) -> int: ...
    @property
    def vertices(self) -> _Floats: ...
    @property
    def polygons(self) -> list[_Indices]: ...
    @property
    def creases(self) -> int: ...
    @property
    def patch_count(self) -> int: ...
    @property
    def patches(self) -> int: ...
    @property
    def level(self) -> str: ...
    @property
    def construction(self) -> str: ...
    @property
    def precision(self) -> str: ...
    @property
    def nbytes(self) -> int: ...
    @property
    def bounds(self) -> _Floats: ...
    @property
    def departure(self) -> Departure: ...
    @property
    def tightest(self) -> Departure: ...
    @property
    def backend(self) -> str: ...
    @property
    def threads(self) -> int: ...
    @property
    def findings(self) -> list[dict[str, Any]]: ...
    def __getstate__(self) -> dict[str, Any]: ...
    def __setstate__(self, state: dict[str, Any]) -> None: ...
    def save(self, path: _Path) -> None: ...
    def nearest(self, points: ArrayLike, method: _Method = "gregory") -> Contacts: ...
    def contains(self, points: ArrayLike, method: _Method = "gregory") -> _Bools: ...
    def force(self, points: ArrayLike, stiffness: _Quantity = "0.5N/mm", method: _Method = "gregory") -> _Floats: ...
    def evaluate(self, face: ArrayLike, xi_eta: ArrayLike) -> SurfacePoints: ...
    def tessellate(self, cells: int = 8) -> Triangles: ...
    def sweep(
        self, depth: _Quantity | Sequence[_Quantity], samples: float | None = None, *, rings: int = 8,
        methods: _Method | Sequence[_Method] = ("gregory", "shaded", "flat"), stiffness: _Quantity = "0.5N/mm",
        output: _Path | None = None, parts: _Path | None = None,
        progress: _Progress = None,
    ) -> Sweep: ...
    def compare(
        self, *, surfaces: str | Sequence[str] = ("fair", "paper", "paper-ribbon", "paper-bezier", "paper-table", "shaded", "flat"),
        precisions: str | Sequence[str] = ("float", "double"), solvers: str | Sequence[str] = ("newton",),
        depth: _Quantity | Sequence[_Quantity] | None = None, stiffness: _Quantity = "0.5N/mm", settle: _Quantity = 0,
        walks: int = 8, walk_ticks: int = 2500, leaving: int | None = None, seed: int = 1, dense_limit: int = 500000,
        max_force_error: float | None = None, max_tick: float | None = None, max_memory: float | None = None,
        progress: _Progress = None,
    ) -> dict[str, Any]: ...
    def trace(
        self, path: ArrayLike, stiffness: _Quantity = "0.5N/mm", method: _Method = "gregory", *, time: ArrayLike | None = None,
        progress: _Progress = None,
        settle: _Quantity = "5ms", friction: float | tuple[float, float] = 0.0, friction_settle: _Quantity = 0.0,
        damping: _Quantity = 0.0, viscosity: _Quantity = 0.0, magnet: tuple[_Quantity, _Quantity] | None = None,
        texture: tuple[str, _Quantity, _Quantity] | tuple[str, _Quantity, _Quantity, ArrayLike] | None = None,
    ) -> Trace: ...
    def hand(
        self, stiffness: _Quantity = "0.5N/mm", method: _Method = "gregory", *,
        settle: _Quantity = "5ms", friction: float | tuple[float, float] = 0.0, friction_settle: _Quantity = 0.0,
        damping: _Quantity = 0.0, viscosity: _Quantity = 0.0, magnet: tuple[_Quantity, _Quantity] | None = None,
        texture: tuple[str, _Quantity, _Quantity] | tuple[str, _Quantity, _Quantity, ArrayLike] | None = None,
    ) -> Hand: ...

def check(
    mesh: _Path | ArrayLike, faces: _Faces | None = None, unit: _Quantity | None = None, *,
    level: str | None = None, construction: Literal["fair", "paper"] | None = None,
    precision: Literal["float", "double"] | None = None, crease: str | None = None,
    crease_radius: _Quantity | None = None, weld: _Quantity | Literal[False] | None = None,
    normals: Literal["auto", "file", "made"] = "auto", orient: Literal["outward", "file"] = "outward",
        flip: bool = False, strict: bool = False, keep_non_manifold: bool = False,
    threads: int = 0, backend: _Backend = "tbb", opencl_device: str = "", progress: _Progress = None,
) -> list[dict[str, Any]]: ...

def load(
    path: _Path, unit: _Quantity | None = None, *,
    level: str | None = None, construction: Literal["fair", "paper"] | None = None,
    precision: Literal["float", "double"] | None = None, crease: str | None = None,
    crease_radius: _Quantity | None = None, weld: _Quantity | Literal[False] | None = None,
    normals: Literal["auto", "file", "made"] = "auto", orient: Literal["outward", "file"] = "outward",
        flip: bool = False, strict: bool = False, keep_non_manifold: bool = False,
    threads: int = 0, backend: _Backend = "tbb", opencl_device: str = "", progress: _Progress = None,
) -> Surface: ...

class Loop:
    def __init__(
        self, scene: _Path, device: str = "sim", *, seconds: float = 0.0, wait: bool = True, realtime: bool = True,
        threads: int = 0, cpu: int | None = None,
    ) -> None: ...
    def engage(self) -> None: ...
    def read(self) -> NDArray[np.void]: ...
    def wait(self, timeout: float | None = None) -> bool: ...
    def close(self) -> None: ...
    @property
    def running(self) -> bool: ...
    @property
    def closed(self) -> bool: ...
    @property
    def lost(self) -> int: ...
    @property
    def device(self) -> str: ...
    @property
    def end(self) -> str | None: ...
    @property
    def refusals(self) -> list[str]: ...
    def __enter__(self) -> Loop: ...
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...
