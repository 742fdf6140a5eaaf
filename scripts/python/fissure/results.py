"""What a run left in its folder (docs/results.md), read when it is asked for. All numbers are in SI units.

A run that still goes on can be read, too: as far as it has come when it is opened.
"""
from __future__ import annotations

import builtins
import csv
import functools
import glob
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union, overload

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas
    import pyvista
    import xarray

Numbers = NDArray[np.float64]
Whole = NDArray[np.int64]

TRIANGLE, QUADRILATERAL, TETRAHEDRON, HEXAHEDRON = 5, 9, 10, 12  # VTK's numbers of cells
CORNERS = {TRIANGLE: 3, QUADRILATERAL: 4, TETRAHEDRON: 4, HEXAHEDRON: 8}



def opened(path: str) -> Any:
    """An HDF5 file to read. h5py takes as long to load as many a run takes: only who asks for frames waits for it."""
    import h5py
    return h5py.File(path, "r")


@dataclass(frozen=True)
class Verdict:
    """What the program thinks of a run (docs/verdict.md)."""
    grade: str                     # "ok", "look again", "do not trust"; "" where the run has not ended
    reasons: list[dict[str, Any]]  # each with "what" in a few words, as run.json has it

    def __str__(self) -> str:
        what = ", ".join(dict.fromkeys(reason["what"] for reason in self.reasons))
        return f"{self.grade}: {what}" if what else self.grade


@dataclass(frozen=True)
class Mesh:
    """What does not change during a run. Cells are triangles, quadrilaterals, tetrahedra or hexahedra, which may be mixed."""
    types: NDArray[np.uint8]  # [cells], as VTK numbers them
    connectivity: Whole       # [corners of all cells], numbers of vertices
    offsets: Whole            # [cells + 1], where each cell's corners begin in connectivity
    held: Whole               # [n], vertices whose motion is prescribed

    @functools.cached_property
    def kinds(self) -> dict[int, tuple[Whole, Whole]]:
        """By type: the corners of its cells [n, corners of one], and the numbers of these cells [n]."""
        return {int(kind): (self.connectivity[self.offsets[:-1][self.types == kind][:, None] + np.arange(CORNERS[int(kind)])],
                            np.flatnonzero(self.types == kind)) for kind in np.unique(self.types)}


@dataclass(frozen=True)
class Cracks:
    """Joints that are broken or soften, in one frame; n of them."""
    points: Numbers             # [n, dimension, 3], corners [m]
    damage: Numbers             # [n], 1 where it is broken
    mode: Numbers               # [n], what broke it: 0 opening, 1 slip
    opening: Numbers            # [n], faces moved apart [m]
    slip: Numbers               # [n], faces moved along each other [m]
    slip_out_of_plane: Numbers  # [n], share of mode III in the slip
    time_broken: Numbers        # [n], -1 while it softens [s]

    @property
    def broken(self) -> NDArray[np.bool_]:
        """[n], which are broken and not only softening."""
        return self.damage >= 1

    @property
    def size(self) -> Numbers:
        """[n], lengths [m] in 2D and areas [m2] in 3D."""
        edges = self.points[:, 1:] - self.points[:, :1]
        size: Numbers = np.linalg.norm(edges[:, 0] if edges.shape[1] == 1 else np.cross(edges[:, 0], edges[:, 1]) / 2, axis=1)
        return size


class Frame:
    """The bodies at one time."""
    time: float                # [s]
    step: int
    points: Numbers            # [vertices, 3], where they are now [m]
    fields: dict[str, NDArray[Any]]  # by name: [cells or vertices], vectors [.., 3], tensors [.., 6] as xx, yy, zz, xy, yz, zx
    units: dict[str, str]      # of fields: "Pa"; "" for mere numbers
    where: dict[str, str]      # of fields: "cell" or "point"
    cracks: Cracks
    rigid: Numbers             # [plates and walls, 4 in 2D or 8 in 3D, 3], corners [m]

    def __init__(self, run: Run, path: str):
        self.run = run
        self.fields, self.units, self.where = {}, {}, {}
        with opened(path) as file:
            self.time, self.step = float(file.attrs["time"]), int(file.attrs["step"])
            self.points = file["body/points"][()]
            for where in ("cell", "point"):
                for name, values in file["body/" + where].items():
                    unit = values.attrs.get("unit", b"")
                    self.fields[name], self.where[name] = values[()], where
                    self.units[name] = (unit.decode() if isinstance(unit, bytes) else str(unit)).rstrip("\0")
            real = file["cracks/cell/damage"][()] > 0  # before the first crack there is one cell without damage
            told = {name: file["cracks/cell"][name][()][real] for name in Cracks.__annotations__ if name != "points"}
            self.cracks = Cracks(points=file["cracks/points"][()].reshape(-1, run.dimension, 3)[real], **told)
            rigid = file["rigid/points"][()] if "rigid" in file else np.empty((0, 3))
            self.rigid = rigid.reshape(-1, 2 ** run.dimension, 3)

    def __repr__(self) -> str:
        return f"<frame at {self.time:.6g} s of {self.run.folder}: {', '.join(self.fields) or 'no fields'}>"

    def cell_values(self, name: str) -> Numbers:
        """[cells], one number for each: a vector's length, a tensor's largest principal value, the mean over a cell's vertices."""
        values = self.fields[name]
        if values.ndim == 2 and values.shape[1] == 6:
            xx, yy, zz, xy, yz, zx = values.T
            tensor = np.stack([np.stack(row, -1) for row in ((xx, xy, zx), (xy, yy, yz), (zx, yz, zz))], -2)
            values = np.linalg.eigvalsh(tensor)[:, 2]
        elif values.ndim == 2:
            values = np.linalg.norm(values, axis=1)
        if self.where[name] == "cell":
            return values
        means = np.empty(len(self.run.mesh.types))
        for cells, numbers in self.run.mesh.kinds.values():
            means[numbers] = values[cells].mean(axis=1)
        return means

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """The bodies as a grid of pyvista, with all fields and their names."""
        grid = _package("pyvista", "from PyPI").UnstructuredGrid
        mesh = self.run.mesh
        sizes = np.diff(mesh.offsets)
        cells = np.insert(mesh.connectivity, mesh.offsets[:-1], sizes)  # as VTK has them: a number of corners before the corners
        result: pyvista.UnstructuredGrid = grid(cells, mesh.types, self.points)
        for name, values in self.fields.items():
            (result.cell_data if self.where[name] == "cell" else result.point_data)[name] = values
        return result


class Frames(Sequence[Frame]):
    """The frames of a run in order; each is read from its file when it is taken out, and again the next time."""

    def __init__(self, run: Run, paths: list[str]):
        self._run, self._paths = run, paths

    def __len__(self) -> int:
        return len(self._paths)

    @overload
    def __getitem__(self, number: int) -> Frame: ...
    @overload
    def __getitem__(self, number: slice) -> Frames: ...

    def __getitem__(self, number: Union[int, slice]) -> Union[Frame, Frames]:
        if isinstance(number, slice):
            return type(self)(self._run, self._paths[number])
        return self._run.frame_type(self._run, self._paths[number])

    def __iter__(self) -> Iterator[Frame]:
        return (self[number] for number in range(len(self)))

    @functools.cached_property
    def times(self) -> Numbers:
        """[frames], [s]"""
        times = []
        for path in self._paths:
            with opened(path) as file:
                times.append(float(file.attrs["time"]))
        return np.array(times)

    def at(self, time: float) -> Frame:
        """The frame nearest to a time [s]."""
        return self[int(np.abs(self.times - time).argmin())]


class Run:
    """A run's folder."""
    frame_type = Frame

    folder: str
    record: dict[str, Any]      # run.json: scene, plan, mesh, time step, energy, fragments, warnings, ...
    history: dict[str, Numbers] # columns of history.csv by name, each [rows]: time, measures, energies, time step, broken joints
    units: dict[str, str]       # of these: "N"; "" for mere numbers
    frames: Frames

    def __init__(self, folder: Union[str, os.PathLike[str]]):
        self.folder = os.fspath(folder)
        if not os.path.isdir(self.folder):
            raise FileNotFoundError(f"{self.folder}: no such folder")
        self.record = {}
        if os.path.exists(self.path("run.json")):
            with builtins.open(self.path("run.json"), encoding="utf-8") as file:
                self.record = json.load(file)
        self.history, self.units = self._read_history()
        self.frames = Frames(self, sorted(glob.glob(glob.escape(self.path("frames")) + "/[0-9]*.h5")))
        if not self.history and not self.frames:
            raise FileNotFoundError(f"{self.folder}: holds neither history.csv nor frames; is it the folder of a run?")

    def __repr__(self) -> str:
        return f"<run {self.folder}: {self.verdict or self.finished or 'has not ended'}, {len(self.frames)} frames>"

    def path(self, *names: str) -> str:
        """Of a file in the folder."""
        return os.path.join(self.folder, *names)

    def _read_history(self) -> tuple[dict[str, Numbers], dict[str, str]]:
        if not os.path.exists(self.path("history.csv")):
            return {}, {}
        with builtins.open(self.path("history.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        rows = [row for row in rows if len(row) == len(rows[0])]  # the last one may be half written
        columns, units = {}, {}
        for i, title in enumerate(rows[0] if rows else []):
            name, _, unit = title.rpartition(" [")
            columns[name] = np.array([float(row[i]) for row in rows[1:]])
            units[name] = unit.rstrip("]")
        return columns, units

    @functools.cached_property
    def mesh(self) -> Mesh:
        with opened(self.path("frames", "mesh.h5")) as file:
            types, connectivity, offsets = (file["body/" + name][()] for name in ("types", "connectivity", "offsets"))
            held = file["body/held"][()] if "held" in file["body"] else np.empty(0, np.int64)
        return Mesh(types, connectivity, offsets, held)

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return 2 if self.mesh.types[0] in (TRIANGLE, QUADRILATERAL) else 3

    @property
    def energies(self) -> dict[str, Numbers]:
        """Terms of the energy balance by name ("kinetic", "fracture", ...), each [rows] [J]."""
        return {name[7:]: values for name, values in self.history.items() if name.startswith("energy ")}

    @property
    def measures(self) -> dict[str, Numbers]:
        """What the scene's measure{} recorded, each [rows] in `units`."""
        return {name: values for name, values in self.history.items()
                if name not in ("time", "time step", "broken joints") and not name.startswith("energy ")}

    @property
    def verdict(self) -> Verdict:
        told = self.record.get("verdict", {})
        return Verdict(told.get("grade", ""), told.get("reasons", []))

    @property
    def expectations(self) -> list[dict[str, Any]]:
        """What expect{} asked: each with name, value, least, most, passed, why."""
        return list(self.record.get("expectations", []))

    @property
    def finished(self) -> str:
        """Why it ended: "end of time", "stop condition", "interrupted" or what failed; "running" while it goes on or after a kill."""
        return str(self.record.get("finished", ""))

    @property
    def ok(self) -> bool:
        """Whether it ended, every expectation was met and the verdict is not "do not trust": exit status 0."""
        return self.verdict.grade in ("ok", "look again") and all(one["passed"] for one in self.expectations)

    def table(self) -> pandas.DataFrame:
        """The history as a data frame of pandas; its attrs["units"] has the units."""
        table: pandas.DataFrame = _package("pandas", "Debian: python3-pandas").DataFrame(self.history)
        table.attrs["units"] = dict(self.units)
        return table

    def to_xarray(self, fields: Sequence[str] | None = None) -> xarray.Dataset:
        """History and frames as a data set of xarray: measures and energies over `time`, fields (all, or those named) and `points` over
        `frame_time` and `cell` or `vertex`; vectors and tensors have a last dimension x, y, z or xx, yy, zz, xy, yz, zx. Reads all frames."""
        package = _package("xarray", "Debian: python3-xarray")
        data: dict[str, Any] = {name: ("time", values, {"units": self.units[name]}) for name, values in self.history.items() if name != "time"}
        coordinates: dict[str, Any] = {"time": ("time", self.history.get("time", np.empty(0)), {"units": "s"})}
        if self.frames:
            frames, directions = list(self.frames), {3: list("xyz"), 6: ["xx", "yy", "zz", "xy", "yz", "zx"]}
            first = frames[0]
            coordinates["frame_time"] = ("frame_time", self.frames.times, {"units": "s"})
            coordinates["direction"] = directions[3]
            data["points" if "points" not in data else "field points"] = (
                ("frame_time", "vertex", "direction"), np.stack([frame.points for frame in frames]), {"units": "m"})
            for name in first.fields if fields is None else fields:
                values = np.stack([frame.fields[name] for frame in frames])
                along = ["frame_time", "cell" if first.where[name] == "cell" else "vertex"]
                if values.ndim == 3:
                    along.append("direction" if values.shape[2] == 3 else "component")
                    coordinates[along[2]] = directions[values.shape[2]]
                data[name if name not in data else "field " + name] = (along, values, {"units": first.units[name]})
        result: xarray.Dataset = package.Dataset(data, coordinates, {"folder": self.folder, "verdict": str(self.verdict)})
        return result


def open(folder: Union[str, os.PathLike[str]]) -> Run:
    """Opens the folder of a run."""
    return Run(folder)


def _package(name: str, where: str) -> Any:
    import importlib
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"{name} is not installed ({where}); all it would show is there as numpy arrays") from error
