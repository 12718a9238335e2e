"""Gliss makes coarse polygon meshes feel smooth under a haptic device.

A surface is made of a mesh file, a cache of ``gliss bake``, or arrays. Then it is asked:

>>> surface = gliss.load("knot.obj", unit="mm")
>>> c = surface.nearest(points)              # c.point, c.normal, c.distance, ... as NumPy arrays
>>> f = surface.force(points, "0.5N/mm")     # (n, 3) N

Points and distances are in the unit of the surface, all else in SI: N, N/m, s. A quantity is a number in SI, or text
with a unit: ``stiffness=500`` and ``stiffness="0.5N/mm"`` are the same. The signed distance is negative inside, as in
VTK; that of trimesh is positive there.

Arrays of float64 are read where they lie, in whatever order, and others are converted. Results are new arrays that own
their memory. Calls that compute let other Python threads run, and end by Ctrl-C. A wrong argument raises ValueError or
TypeError.
"""

import difflib as _difflib
import enum as _enum
import functools as _functools
import inspect as _inspect
import os as _os
import shlex as _shlex
import sys as _sys
import tempfile as _tempfile
import typing as _typing
import warnings as _warnings
import weakref as _weakref

import numpy as _np

from . import _gliss
from ._gliss import CacheError, Contact, DeviceError, MeshError, SceneError, __version__

__all__ = ["CacheError", "Contact", "Contacts", "Departure", "DeviceError", "Flag", "Hand", "Loop", "MeshError", "Results",
           "SceneError", "Surface", "SurfacePoints", "Sweep", "Trace", "Triangles", "__version__", "check", "load"]


# Maps names of the program's options to the names that they have here.
_NAMES_OF_PROGRAM = {"at": "xi_eta", "hip": "points", "levels": "surfaces", "no_wait": "wait", "require_rt": "realtime"}


def _refuse(function, keywords):
    """Raises the TypeError of the first of the keywords that the function does not have, and names the likely one.
    Returns if it has them all."""
    known = [name for name, p in _inspect.signature(function).parameters.items()
             if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY) and name != "self"]
    for name in keywords:
        if name in known:
            continue
        near = [_NAMES_OF_PROGRAM.get(name.replace("-", "_")), *_difflib.get_close_matches(name, known, 1)]
        meant = next((other for other in near if other in known), None)
        hint = f": did you mean '{meant}'?" if meant else f"; it has {', '.join(known)}" if known else "; it has none"
        raise TypeError(f"{function.__qualname__.replace('.__init__', '')}() has no argument '{name}'{hint}")


def _with_keywords(function, more):
    """Returns the signature of a function whose **options are the keywords of another one, `more`."""
    signature = _inspect.signature(function)
    own = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
    added = [p for p in _inspect.signature(more).parameters.values() if p.kind is p.KEYWORD_ONLY]
    return signature.replace(parameters=[*own, *added])


def _public(options=None):
    """Decorates a function that users call. An unknown keyword then raises TypeError that names the likely one, and
    help() lists the keywords of `options`, which the function's **options go to.

    Keywords are checked once the call has failed, so that other calls take no longer.
    """
    def decorate(function):
        @_functools.wraps(function)
        def call(*args, **keywords):
            try:
                return function(*args, **keywords)
            except TypeError:
                unknown = keywords.keys() - call.__signature__.parameters.keys()
                if not unknown:
                    raise
            _refuse(call, keywords)

        call.__signature__ = _with_keywords(function, options) if options else _inspect.signature(function)
        return call
    return decorate


def _warn(text, category=UserWarning):
    """Warns at the line of the user that called the package, however deep it is within."""
    level, frame = 2, _sys._getframe(1)
    while frame.f_back is not None and frame.f_globals is globals():
        level, frame = level + 1, frame.f_back
    _warnings.warn(text, category, stacklevel=level)


def _text(quantity):
    """As a command line has it."""
    return format(quantity, ".17g") if isinstance(quantity, (int, float)) else str(quantity)


def _words(options):
    """The options of the program that read and build the same."""
    words, usual = [], (("normals", "auto"), ("orient", "outward"))
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if name in ("threads", "backend", "opencl_device", "progress") or value is None or (name, value) in usual:
            continue
        if name == "weld" and isinstance(value, bool):
            words += [] if value else [option, "none"]
        elif isinstance(value, bool):
            words += [option] if value else []
        else:
            words += [option, _text(value)]
    return words


def _touch(stiffness, method, options):
    return dict(stiffness=stiffness, method=method, **_touch_options(**options))


def _touch_options(*, settle="5ms", friction=0.0, friction_settle=0.0, damping=0.0, viscosity=0.0, magnet=None,
                   texture=None):
    return dict(settle=settle, friction=friction, friction_settle=friction_settle, damping=damping,
                viscosity=viscosity, magnet=magnet, texture=texture)


class Flag(_enum.IntFlag):
    """Bits of the flags of a contact: ``Flag(c.flags[0])``, or ``c.flags & Flag.ON_BORDER``."""

    CONVERGED = 1  # the search has ended at a nearest point
    ON_BORDER = 2  # at the rim of an open mesh
    ON_CREASE = 4
    NOT_BUILT = 8  # of a cache of a part of the mesh
    UNFINISHED = 16  # more evaluations were needed than a tick may take
    SETTLING = 32  # slides to the nearest point instead of leaping there
    SLIPPING = 64


class Results:
    """Arrays by name: as attributes, and as items, so that ``dict(results)`` is all of them. ``len(results)`` rows;
    ``results[i]`` is a dict of row i."""

    def __init__(self, arrays):
        self._arrays = arrays

    def __getattr__(self, name):
        try:
            return self.__dict__["_arrays"][name]
        except KeyError:
            raise AttributeError(f"'{type(self).__name__}' has no array '{name}'") from None

    def __dir__(self):
        return [*super().__dir__(), *self._arrays]

    @_public()
    def keys(self):
        """Names of the arrays."""
        return self._arrays.keys()

    def __getitem__(self, name):
        if isinstance(name, (int, _np.integer)):
            return {key: array[name] for key, array in self._arrays.items()}
        return self._arrays[name]

    def __iter__(self):
        return (self[i] for i in range(len(self)))

    def __len__(self):
        return len(next(iter(self._arrays.values())))

    def __bool__(self):
        return True

    def __repr__(self):
        return f"{type(self).__name__}({', '.join(f'{name}: {array.shape}' for name, array in self._arrays.items())})"

    @_public()
    def columns(self):
        """The same as a dict of arrays (n,), with point_x, point_y, point_z for point: for pandas.DataFrame."""
        flat = {}
        of_grid = self.distance.ndim if "distance" in self._arrays else 1
        for name, array in self._arrays.items():
            if array.ndim == of_grid:
                flat[name] = array.ravel()
            else:
                axes = ("x", "y", "z") if array.shape[-1] == 3 else ("xi", "eta")
                flat.update((f"{name}_{axis}", array[..., i].ravel()) for i, axis in enumerate(axes))
        return flat


class Contacts(Results):
    """Nearest points of a surface, as Surface.nearest tells."""

    @property
    def inside(self):
        """True where the point lies inside."""
        return self.distance < 0


class SurfacePoints(Results):
    """Points of patches, as Surface.evaluate tells."""


class Triangles(Results):
    """A mesh of triangles, as Surface.tessellate tells."""


class Trace(Results):
    """What a HIP felt along a path, tick by tick, as Surface.trace tells.

    statistics: figures over all ticks, as ``gliss trace --json`` has them: largest_step_N, jumps_per_100k, ...
    """

    def __init__(self, arrays, statistics):
        super().__init__(arrays)
        self.statistics = statistics


class Sweep:
    """The figures of a sweep.

    statistics: a dict for each depth and method, as ``gliss sweep --json`` has them.
    histograms: in the same order, a dict of counts (320,) by name: step, edge_step, angle, error, residual.
    bin_edges: (320,), the upper edge of each bin, in N or rad.
    computed: contacts that were computed, without those of parts that were there.
    rings: of the grid on each patch.
    """

    def __init__(self, figures):
        self.statistics = figures["statistics"]
        self.histograms = figures["histograms"]
        self.bin_edges = figures["bin_edges"]
        self.computed = figures["computed"]
        self.rings = figures["rings"]


def _refuse_mask(values, name):
    """Raises TypeError for a masked array, and for a list or tuple that holds one."""
    masked = _np.ma.MaskedArray
    if isinstance(values, masked) or isinstance(values, (list, tuple)) and any(isinstance(v, masked) for v in values):
        raise TypeError(f"{name}: a masked array, whose mask would be lost; take its .compressed() or .filled()")


def _real(values, name):
    """An aligned array of float64, of any strides; a view where `values` is one."""
    _refuse_mask(values, name)
    array = _np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected real numbers, found dtype {array.dtype}")
    return _np.require(array, _np.float64, "A")


def _whole(values, name):
    """An array of uint32."""
    _refuse_mask(values, name)
    array = _np.asarray(values)
    if array.size == 0:
        array = array.astype(_np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: expected whole numbers, found dtype {array.dtype}")
    if array.size and not (array.min() >= 0 and array.max() < 2**32):
        raise ValueError(f"{name}: expected numbers from 0 to {2**32 - 1}, found {array.min()} to {array.max()}")
    return _np.ascontiguousarray(array, _np.uint32)


def _grid(values, name):
    """Points of shape (..., 3) as (n, 3), and the shape before the 3."""
    points = _real(values, name)
    if points.ndim in (0, 2) or points.shape[-1] != 3:
        return points, points.shape[:1]  # what is wrong with its shape is said where it is read
    return points.reshape(-1, 3), points.shape[:-1]


def _shaped(array, shape):
    """An array (n, ...) with the shape of the grid that its n points had."""
    return array if len(shape) == 1 else array.reshape(shape + array.shape[1:])


def _also_named(rows, **old_names):
    """The same structured rows, fields of which have their old names as well."""
    names, fields = rows.dtype.names, rows.dtype.fields
    return rows.view(_np.dtype({"names": names, "formats": [fields[name][0] for name in names],
                                "offsets": [fields[name][1] for name in names],
                                "titles": [old_names.get(name) for name in names], "itemsize": rows.dtype.itemsize}))


def _progress(progress, name):
    """A function of (done, total), or None."""
    if progress is None or progress is False:
        return None
    if progress is True:
        return lambda done, total: print(f"gliss: {name}: {100 * done // max(total, 1)} %", file=_sys.stderr, flush=True)
    if not callable(progress):
        raise TypeError(f"progress: expected a function of (done, total), or True, found {progress!r}")
    return progress


def _unpadded(padded):
    """Offsets and corners of [n, i0, i1, ..., n, ...]."""
    counts, at = [], 0
    while at < len(padded):
        counts.append(int(padded[at]))
        at += 1 + counts[-1]
    if at != len(padded):
        raise ValueError(f"faces: the last face of the padded array needs {at - len(padded)} corners more")
    counts = _np.array(counts, int)
    heads = _np.concatenate(([0], _np.cumsum(counts + 1)))[:-1].astype(int)
    return _np.concatenate(([0], _np.cumsum(counts))), _np.delete(padded, heads)


def _faces(faces):
    """Offsets and corners of any form of faces."""
    _refuse_mask(faces, "faces")
    if isinstance(faces, tuple) and len(faces) == 2 and all(isinstance(part, _np.ndarray) for part in faces):
        return _whole(faces[0], "faces"), _whole(faces[1], "faces")
    if isinstance(faces, _np.ndarray) and faces.dtype != object:
        corners = _whole(faces, "faces")
        if corners.ndim == 1:
            offsets, corners = _unpadded(corners)
            return _whole(offsets, "faces"), _whole(corners, "faces")
        if corners.ndim != 2:
            raise ValueError(f"faces: expected shape (m, k), (m,) or a list of faces, found {corners.shape}")
        m, k = corners.shape
        return _np.arange(0, m * k + 1, k, dtype=_np.uint32) if k else _np.zeros(1, _np.uint32), corners.ravel()
    try:
        rows = [_whole(face, "faces") for face in faces]
    except TypeError as error:
        raise TypeError(f"faces: expected lists of whole numbers, or an array of them ({error})") from None
    if any(row.ndim != 1 for row in rows):
        raise ValueError("faces: expected a list of faces, each a list of vertices")
    offsets = _np.cumsum([0] + [len(row) for row in rows])
    return _whole(offsets, "faces"), _np.concatenate(rows) if rows else _np.zeros(0, _np.uint32)


def _path(path):
    text = _os.fsdecode(path)
    if "\0" in text:
        raise ValueError(f"a path cannot hold a null character: {text!r}")
    return text


def _options(unit=None, **options):
    return dict(unit=unit, **_surface_options(**options))


def _surface_options(*, level=None, construction=None, precision=None, crease=None, crease_radius=None, weld=None,
             normals="auto", orient="outward", flip=False, strict=False, keep_non_manifold=False, threads=0, backend="tbb",
             opencl_device="", progress=None):
    return dict(level=level, construction=construction, precision=precision, crease=crease,
                crease_radius=crease_radius, weld=weld, normals=normals, orient=orient, flip=flip, strict=strict,
                keep_non_manifold=keep_non_manifold, threads=threads, backend=backend, opencl_device=opencl_device,
                progress=_progress(progress, "build"))


class Departure(_typing.NamedTuple):
    """How far a patch leaves its polygon, and the room there, in the surface's unit."""

    distance: float
    room: float
    face: int


def _warn_of(surface):
    """Warns of repairs, of creases, of a unit that was forgotten, and of a surface that is not its mesh's shape."""
    for finding in surface.findings:
        kind = "soup" if finding["code"] == "soup" else finding["severity"]
        if kind in ("soup", "repaired"):
            _warn(f"{kind}: {finding['message']}")
    edges, degrees = surface.creases, surface._open.crease_hint
    if edges and surface._open.has_usual_creases:
        _warn(f"{edges} edges are kept sharp; crease='none' makes the surface smooth all over")
    elif degrees is not None:
        _warn(f"the edges of this mesh turn by much less than {degrees:.0f} degrees or by much more, as a machine "
              "part's do: crease='auto' keeps the latter sharp")
    low, high = surface.bounds
    across = surface.unit * float(_np.linalg.norm(high - low))
    if across > 10:
        _warn(f"the surface is {across:.3g} m across: its unit may be another, as unit='mm'")
    if tight := _gliss.tight_curvature_text(surface._open):
        _warn(tight)
    if surface._open.faithful:
        return
    distance, room, face = surface.tightest
    _warn(f"the surface leaves face {face} by {_gliss.length_text(distance * surface.unit)}, and the next face is "
          f"{_gliss.length_text(room * surface.unit)} away: a hand feels another shape than the mesh's there; crease= "
          "keeps edges sharp, finer faces follow the shape")


class Surface:
    """A smooth surface over a polygon mesh. Any number of threads may ask one at once.

    Surface(vertices, faces) makes one of arrays; ``gliss.load`` reads a file.

    vertices: (n, 3), in `unit`.
    faces, of any number of sides each, anticlockwise seen from outside; one of
      an array (m, k) of whole numbers, a list of lists,
      a padded array [k, i0, i1, ..., k, i0, ...] as PyVista has it, or
      (offsets, corners), a tuple of two arrays: face j has corners[offsets[j]:offsets[j + 1]].
      Not the triangles of a trimesh.Trimesh that was read from polygons: they are cut there.
    unit: of the coordinates: "m" (default), "cm", "mm", "um", "nm", "in", or a number of metres.

    The other keywords are described at gliss.load. MeshError for what is no mesh, with all findings.
    """

    @_public(_surface_options)
    def __init__(self, vertices, faces, unit="m", **options):
        self._open = _gliss.from_arrays(_real(vertices, "vertices"), *_faces(faces), _options(unit, **options))
        _warn_of(self)
        self._words = []  # no command of the program reads it

    def __getstate__(self):
        with _tempfile.TemporaryDirectory() as folder:
            path = _os.path.join(folder, "surface.gliss")
            self.save(path)
            with open(path, "rb") as file:
                return {"cache": file.read(), "threads": self.threads, "backend": self.backend}

    def __setstate__(self, state):
        with _tempfile.TemporaryDirectory() as folder:
            path = _os.path.join(folder, "surface.gliss")
            with open(path, "wb") as file:
                file.write(state["cache"])
            self._open = _gliss.load(path, _options(threads=state["threads"], backend=state["backend"]))
        self._words = []

    @classmethod
    def _of(cls, opened, words):
        surface = cls.__new__(cls)
        surface._open, surface._words = opened, words
        _warn_of(surface)
        return surface

    @property
    def unit(self):
        """Metres in one unit of its points and distances."""
        return self._open.unit

    @property
    def face_count(self):
        """Number of faces of the mesh, after repairs; `polygons` are the faces themselves."""
        return self._open.faces

    @property
    def faces(self):
        """The old name of `face_count`, until 0.3: the faces of Surface(vertices, faces) are an array."""
        return self._was("faces", "face_count")

    @property
    def vertices(self):
        """(n, 3): vertices of the mesh, after repairs, in its unit. ValueError for a cache that does not keep them."""
        return self._open.mesh()[0]

    @property
    def polygons(self):
        """The faces of the mesh, after repairs: a list of arrays of vertices. ValueError as for `vertices`."""
        _, offsets, corners = self._open.mesh()
        return _np.split(corners, offsets[1:-1])

    @property
    def creases(self):
        """Number of edges that are kept sharp; of a cache, which does not keep them: 0."""
        return self._open.creases

    @property
    def patch_count(self):
        """Number of patches: one a face, or one for each triangle of a face that was split."""
        return self._open.patches

    @property
    def patches(self):
        """The old name of `patch_count`, until 0.3."""
        return self._was("patches", "patch_count")

    def _was(self, old, new):
        _warn(f"Surface.{old} is Surface.{new} now; the old name goes in 0.3", DeprecationWarning)
        return getattr(self, new)

    @property
    def level(self):
        """How patches stand for the construction: "exact", "ribbon", "bezier", "table" or "table:N"."""
        return self._open.level

    @property
    def construction(self):
        """How patches are made: "fair" or "paper"."""
        return self._open.construction

    @property
    def precision(self):
        """Precision of the patches: "double" or "float"."""
        return self._open.precision

    @property
    def nbytes(self):
        """Bytes that the patches take."""
        return self._open.nbytes

    @property
    def bounds(self):
        """(2, 3): lowest and highest corner of the mesh, in its unit. Patches bulge beyond it."""
        return self._open.bounds

    @property
    def departure(self):
        """How far patches leave their polygons: a Departure with the largest `distance`, its `face`, and the `room`
        there: the way along the face's normal to the next face across, through the solid or a gap (inf: none)."""
        return Departure(*self._open.departure)

    @property
    def tightest(self):
        """The same where a patch takes the largest share of its room, if that is beyond a third: else `departure`."""
        return Departure(*self._open.tightest)

    @property
    def backend(self):
        """What computes: "tbb", "serial" or "opencl"."""
        return self._open.backend

    @property
    def threads(self):
        """Number of threads that it computes with."""
        return self._open.threads

    @property
    def findings(self):
        """What the checks of the mesh found, dicts as ``gliss check --json`` prints them; of a cache: none."""
        return self._open.findings

    def __repr__(self):
        return (f"<gliss.Surface of {self.face_count} faces, {self.construction} {self.level}, {self.precision}, "
                f"unit {_gliss.unit_name(self.unit)}>")

    @_public()
    def save(self, path):
        """Keeps the patches in a cache, as ``gliss bake`` does: written whole or not at all. OSError."""
        self._open.save(_path(path))

    @_public()
    def nearest(self, points, method="gregory"):
        """The nearest point of the surface to each point.

        points: (n, 3), in the surface's unit; also (3,) and grids (..., 3), whose shape the results keep. ValueError
        names the first row with a number that is not finite or is beyond 1e60, where distances overflow. Those of float
        patches overflow earlier, from some 1e19 times the mesh's size: such contacts have no Flag.CONVERGED, and their
        distance may be inf or nan.
        method: "gregory", "shaded" or "flat".
        Contacts: point (n, 3), normal (n, 3) outward and unit, distance (n,) signed and negative inside, face (n,),
        domain (n, 2) as xi, eta on the patch, touching (n,) bool, flags (n,), iterations (n,). Points and distances
        are in the surface's unit.
        """
        points, shape = _grid(points, "points")
        found = _gliss.nearest(self._open, points, method)
        return Contacts({name: _shaped(array, shape) for name, array in found.items()})

    @_public()
    def contains(self, points, method="gregory"):
        """True for each point that lies inside: bool (n,), or of the shape of a grid (..., 3)."""
        return self.nearest(points, method).inside

    @_public()
    def force(self, points, stiffness="0.5N/mm", method="gregory"):
        """The force on a hand at each point, (n, 3) N: stiffness times the depth, outward; zero outside.

        points: as for nearest. stiffness: N/m, or text. method as for nearest.
        """
        points, shape = _grid(points, "points")
        return _shaped(_gliss.force(self._open, points, stiffness, method), shape)

    @_public()
    def evaluate(self, face, xi_eta):
        """Points of patches.

        face: (n,) or one number for all. xi_eta: (n, 2), in the regular polygon with as many sides as the face and
        corners on the unit circle, the first at (1, 0). ValueError outside.
        SurfacePoints: point, d_xi, d_eta in the surface's unit and normal, outward and unit, each (n, 3).
        """
        domain = _real(xi_eta, "xi_eta")
        face = _whole(face, "face")
        if face.size == 1 and face.ndim <= 1 and domain.ndim == 2:
            face = _np.full(len(domain), face.ravel()[0], _np.uint32)
        return SurfacePoints(_gliss.evaluate(self._open, face, domain))

    @_public()
    def tessellate(self, cells=8):
        """A mesh of triangles that lies on the surface, for drawing.

        cells: along half a side; a face of n sides becomes 2 n cells^2 triangles, one that is cut as it is not convex
            4 (n - 2) cells^2. 1 to 1000.
        Triangles: point (n, 3) in the surface's unit, normal (n, 3), triangles (m, 3). Creases are not kept in the
        normals. ValueError for a cache that does not keep its mesh: one with creases, or of a part.
        """
        return Triangles(_gliss.tessellate(self._open, cells))

    @_public()
    def sweep(self, depth, samples=None, *, rings=8, methods=("gregory", "shaded", "flat"), stiffness="0.5N/mm",
              output=None, parts=None, progress=None):
        """Samples the force beneath the whole surface, as ``gliss sweep`` does. A Sweep.

        depth: below the surface, in m or text such as "2mm"; one, or a list of them.
        samples: a depth, over all faces, at least; else `rings` of points on each patch.
        output: file for the samples, .h5, .csv or .npy, byte-identical to the one that ``gliss sweep`` writes. An .h5
        file has the command for that in its attribute command_line.
        parts: folder where finished parts wait until all is done; None: `output` with the ending .parts, where there
        is an output; "none": nowhere. A sweep that Ctrl-C ended goes on from there, in Python or by the program.
        progress: a function of (contacts done, of all), called a few times a second; True writes lines to sys.stderr.
        """
        methods = [methods] if isinstance(methods, str) else list(methods)
        path = "" if output is None else _path(output)
        if path and not path.endswith((".csv", ".h5", ".hdf5", ".npy")):
            raise ValueError(f"output: '{path}' must end in .csv, .npy, .h5 or .hdf5")
        if parts is None:
            parts = _os.path.splitext(path)[0] + ".parts" if path else ""
        folder = "" if parts == "none" else _path(parts)
        if self._open.path:
            command = ["gliss", "sweep", self._open.path, "--depth", ",".join(_gliss.depth_names(depth))]
            command += ["--rings", str(rings)] if samples is None else ["--samples", _text(samples)]
            command += ["--method", ",".join(methods)]
            command += [] if stiffness == "0.5N/mm" else ["--stiffness", _text(stiffness)]
            command += [*self._words, "-o", path]
            command_line = _shlex.join(command)
        else:
            command_line = "Python: Surface.sweep"
        swept = Sweep(_gliss.sweep(self._open, depth, dict(
            samples=samples, rings=rings, methods=methods, stiffness=stiffness, output=path, parts=folder,
            command_line=command_line, progress=_progress(progress, "sweep"))))
        for figures in swept.statistics:
            if figures["method"] == "gregory" and figures["may_be_sparse"]:
                _warn(f"at {figures['depth_m'] * 1e3:.6g} mm the samples may be too far apart to count jumps: if those "
                      "of gregory become fewer with four times as many, they are")
        return swept

    @_public()
    def compare(self, *, surfaces=("fair", "paper", "paper-ribbon", "paper-bezier", "paper-table", "shaded", "flat"),
                precisions=("float", "double"), solvers=("newton",), depth=None, stiffness="0.5N/mm", settle=0, walks=8,
                walk_ticks=2500, leaving=None, seed=1, dense_limit=500000, max_force_error=None, max_tick=None,
                max_memory=None, progress=None):
        """Measures what each surface of the mesh costs and how it feels, and recommends one, as ``gliss compare`` does.

        surfaces: also "fair-bezier", "paper-table:8" and the like. precisions, solvers: which to measure.
        depth: of the HIPs, in m or text such as "2mm"; one, or a list; None: 1 % of the diagonal. settle: s.
        walks: random walks of walk_ticks each, by `seed`; 0: none. leaving: hands that leave; None: 5 a walk.
        dense_limit: triangles of the densest mesh tried for flat and shaded; 0: none.
        max_force_error: a share of stiffness x depth. max_tick: s. max_memory: bytes. Budgets of the recommendation.
        progress: a function of (rows done, of all); True writes lines to sys.stderr.
        A dict as ``gliss compare --json`` has it: "rows", "dense", "recommended", "reason" and what was done. It takes
        seconds to minutes. ValueError, also for a cache that does not keep its mesh.
        """
        names = {"surfaces": surfaces, "precisions": precisions, "solvers": solvers}
        lists = {name: [value] if isinstance(value, str) else list(value) for name, value in names.items()}
        return _gliss.compare(self._open, dict(
            lists, depth=depth, stiffness=stiffness, settle=settle, walks=walks, walk_ticks=walk_ticks, leaving=leaving,
            seed=seed, dense_limit=dense_limit, max_force_error=max_force_error, max_tick=max_tick, max_memory=max_memory,
            progress=_progress(progress, "compare")))

    @_public(_touch_options)
    def trace(self, path, stiffness="0.5N/mm", method="gregory", *, time=None, progress=None, **options):
        """Tracks a HIP along a path, a tick a row, as a device loop does. A Trace.

        path: (n, 3), in the surface's unit. The forces are those of ``gliss trace``, byte for byte.
        stiffness: N/m. method as for nearest. These are keywords:
        time: (n,) s, when the HIP was there; None: 1 ms from row to row.
        progress: a function of (rows done, of all), called a few times a second; True writes lines to sys.stderr.
        settle: s. Where the nearest point jumps elsewhere, the contact slides there instead, and the force takes this
        time to change by 20 %. 0 lets it jump.
        friction: a coefficient, 0 to 5, or (at rest, slipping); friction_settle: s, from the one to the other.
        damping: s/m, 0 to 20. viscosity: N s/m, 0 to 20.
        magnet: (force, range), N and m: a pull from outside. texture: ("grating" or "noise", height, period) in m, and
        for a grating perhaps the way across its grooves, (x, y, z).
        Trace: force (n, 3) N, point (n, 3), normal (n, 3), distance (n,), face (n,), domain (n, 2), touching (n,),
        slipping (n,), cone_share (n,), flags (n,).
        """
        if time is not None:
            time = _np.atleast_1d(_real(time, "time"))[:, None]
        touch = _touch(stiffness, method, options)
        return Trace(*_gliss.trace(self._open, _real(path, "path"), time, touch, _progress(progress, "trace")))

    @_public(_touch_options)
    def hand(self, stiffness="0.5N/mm", method="gregory", **options):
        """A Hand on this surface, for simulators: hand.tick(hip) each ms. The keywords are described at trace."""
        return Hand(self, stiffness, method, **options)


class Hand:
    """A hand on a surface that keeps its contact from tick to tick; ``Surface.hand`` makes one.

    One thread at a time may tick it: RuntimeError otherwise. It has the surface live on.
    """

    @_public(_touch_options)
    def __init__(self, surface, stiffness="0.5N/mm", method="gregory", **options):
        touch = _touch(stiffness, method, options)
        self._open = _gliss.open_hand(surface._open, touch)
        self._tick = self._open.tick

    def tick(self, hip=None, dt=1e-3, **unknown):
        """The Contact after the HIP has moved to `hip`, (3,) in the surface's unit. It takes a microsecond.

        dt: s since the last tick, or text such as "2ms"; damping, viscosity, friction_settle and settle go by it. A
        way through the surface is met at any speed. ValueError for numbers that are not finite, and for points that
        are too far away, as for Surface.nearest: the hand stays as it was.
        """
        if unknown:  # @_public would do this, and cost 4 % of a tick
            _refuse(Hand.tick, unknown)
        return self._tick(hip, dt)

    tick.__signature__ = _inspect.signature(lambda self, hip, dt=1e-3: None)

    @_public()
    def ticks(self, path, dt=1e-3):
        """The same for each row of a path, (n, 3), while other Python threads run. Results as of Surface.trace."""
        return Results(self._open.ticks(_real(path, "path"), dt))


@_public(_surface_options)
def load(path, unit=None, **options):
    """A Surface of a mesh file (.obj, .off, .ply, .stl) or a cache of ``gliss bake``.

    unit: of a mesh's coordinates: "m" (default), "cm", "mm", "um", "nm", "in", or a number of metres. A cache has its
    own, and ValueError says so where another is given.

    These are keywords, also of Surface and check:
    level: "exact" (default), "ribbon", "bezier", "table" or "table:N". construction: "fair" (default) or "paper".
    precision: "double" (default) or "float". A cache must be of what is asked for: CacheError.
    crease: edges to keep sharp, such as "40deg", "auto", "normals", "groups", "edges:FILE"; crease_radius: m, or text,
    rounds them instead.
    weld: a length within which borders are welded; None: at the very same places; False: never.
    normals: "auto", "file" or "made". orient: of closed parts, "outward" or "file", which keeps a room that is wound
    inside out; flip: turn open parts over. strict, keep_non_manifold: refuse instead of mending.
    threads: 0 is as many as the machine has. backend: "tbb", "serial", "opencl", "auto" (a GPU if there is one);
    opencl_device: part of its name, or its number.
    progress: a function of (faces done, of all), called a few times a second while patches are built; True writes lines
    to sys.stderr. A cache has its patches, and nothing is called.

    MeshError, CacheError, DeviceError, OSError, each with the program's line.
    """
    options = _options(unit, **options)
    opened = _gliss.load(_path(path), options)
    if unit is None and opened.unit != 1:  # a cache's, which the program is to write in as well
        options["unit"] = opened.unit
    return Surface._of(opened, _words(options))


@_public(_surface_options)
def check(mesh, faces=None, unit=None, **options):
    """All that is wrong or odd about a mesh: a list of dicts as ``Surface.findings`` has them, errors among them.

    mesh: a file, as for gliss.load, or vertices (n, 3), with `faces` as for Surface. unit and the other keywords are
    described at gliss.load, and it takes as long as that. OSError.
    """
    try:
        if faces is None:
            return _gliss.load(_path(mesh), _options(unit, **options)).findings
        options = _options("m" if unit is None else unit, **options)
        return _gliss.from_arrays(_real(mesh, "vertices"), *_faces(faces), options).findings
    except MeshError as error:
        return list(error.findings)


_loops = _weakref.WeakSet()
_os.register_at_fork(after_in_child=lambda: [loop._abandon() for loop in list(_loops)])


class Loop:
    """A device loop over a scene file, 1000 times a second, in a C++ thread of its own that never waits for Python.

    with gliss.Loop("scene.toml", device="sim") as loop:
        while loop.running:
            ticks = loop.read()          # all since the last read; the ring holds half a minute

    device: "sim", "replay:FILE", "udp:PORT", "haply", as ``gliss run`` has it. seconds: 0 is until the device ends.
    wait=False: tick after tick as fast as it goes, in a time of its own, for sim and replay; no tick is lost then.
    realtime: the loop's thread gets real-time scheduling and the process locked memory, where the system permits;
    `refusals` says what was refused. cpu: the only processor that the thread runs on; None: any.
    A process may have several loops, one a device. In a child of os.fork() they are closed.

    The loop begins at once. SceneError, MeshError, CacheError, DeviceError, OSError. One thread at a time may read.
    """

    @_public()
    def __init__(self, scene, device="sim", *, seconds=0.0, wait=True, realtime=True, threads=0, cpu=None):
        self._open = _gliss.open_loop(_path(scene), device, seconds, wait, realtime, threads, -1 if cpu is None else cpu)
        self._end = _weakref.finalize(self, self._open.stop)  # also where Python ends
        _loops.add(self)

    @_public()
    def read(self):
        """The ticks since the last read, a structured array (n,).

        number; time, lateness, compute, age in s; missed periods before it; position (3,) m, orientation (4,) w x y z;
        rendered and sent (3,) N, rendered_torque and sent_torque (3,) N m; guard, its state, and reason, bytes;
        object (-1: none is near), touching, face, distance in m and negative inside, iterations, flags.
        The guard's state has its old name, state, as well, until 0.3.
        """
        return _also_named(self._open.read(), guard="state")

    @_public()
    def wait(self, timeout=None):
        """Waits for the loop to end, at most `timeout` s, and returns whether it has."""
        return self._open.wait(timeout)

    @_public()
    def engage(self):
        """Engages a guard that is safe again, as soon as it permits: with the hand in the open, and no fault.

        The largest force then rises from zero within half a second. A wish that finds the guard at work is met.
        """
        self._open.engage()

    def _abandon(self):
        self._end.detach()
        self._open.abandon()

    @_public()
    def close(self):
        """Ends the loop: the force goes to zero. DeviceError if the device failed. Once closed it reads no more."""
        self._open.close()

    @property
    def running(self):
        """True until the loop has ended."""
        return self._open.running

    @property
    def closed(self):
        """True after close."""
        return self._open.closed

    @property
    def lost(self):
        """Number of ticks that the ring had no room for: read more often."""
        return self._open.lost

    @property
    def device(self):
        """Name of the device."""
        return self._open.device

    @property
    def end(self):
        """How the loop ended, such as "the device has ended"; None while it runs."""
        return self._open.end

    @property
    def refusals(self):
        """What the system refused of real-time scheduling and locked memory, a line each."""
        return self._open.refusals

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        self.close()
