"""Running fissure2d and fissure3d."""
from __future__ import annotations

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from typing import Union

from . import results

Path = Union[str, "os.PathLike[str]"]
Settings = Mapping[str, Union[float, str, bool]]
FOLDER = pathlib.Path(__file__).resolve().parents[3]  # the sources' top level, when this file lies in them


class Error(RuntimeError):
    """What a program said when it ended with an error; `status` is its exit status, `folder` where the results of a run that broke off lie."""

    def __init__(self, message: str, status: int, folder: str | None = None):
        super().__init__(message)
        self.status = status
        self.folder = folder


def program(dimension: int, folder: Path | None = None) -> str:
    """The path of fissure2d or fissure3d: in `folder`, else in $FISSURE_PROGRAMS, else as built beside these sources, else in $PATH.

    A folder is one that holds the programs, or one that they were built in (src2d/fissure2d).
    """
    if dimension not in (2, 3):
        raise ValueError(f"dimension is 2 or 3, not {dimension!r}")
    dimension = int(dimension)
    name = f"fissure{dimension}d"
    given = folder or os.environ.get("FISSURE_PROGRAMS")
    for place in [given] if given else [FOLDER / "build"]:
        for path in (os.path.join(place, f"src{dimension}d", name), os.path.join(place, name)):
            if os.path.isfile(path) and os.access(path, os.X_OK):
                return path
    found = None if given else shutil.which(name)
    if found is None:
        where = f"in {os.fspath(given)}" if given else "in $PATH"
        raise FileNotFoundError(f"there is no program {name} {where}; build it: cmake --preset release && cmake --build --preset release --target {name}")
    return found


def _words(settings: Settings | None) -> list[str]:
    """Settings as the command line takes them."""
    told = {name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in (settings or {}).items()}
    return [word for name, value in told.items() for word in ("--set", f"{name}={value}")]


def _call(command: Sequence[str], quiet: bool, folder: str | None = None) -> str:
    """Standard output of a program; raises Error with what it said on the other one. Not quiet: both are shown as they come."""
    before = _written(folder)
    process = subprocess.Popen(command, stdout=subprocess.PIPE if quiet else None, stderr=subprocess.PIPE, text=True, errors="replace")
    assert process.stderr is not None
    try:
        said, complaint = "", ""
        if quiet:
            said, complaint = process.communicate()
        else:
            for line in process.stderr:
                print(line, end="", file=sys.stderr, flush=True)
                complaint += "" if line.startswith("[") else line  # progress
            process.wait()
    except KeyboardInterrupt:  # from a terminal Ctrl-C reached the program, too; elsewhere it did not
        process.send_signal(signal.SIGINT)
        process.wait()
        raise
    status = process.returncode
    if status not in (0, 1):
        ended = f"{os.path.basename(command[0])} " + (f"was killed by signal {-status}" if status < 0 else f"ended with status {status}")
        raise Error(complaint.strip() or ended, status, folder if _written(folder) != before else None)
    return said


def _written(folder: str | None) -> int | None:
    """When the record of a run was written."""
    record = os.path.join(folder or "", "run.json")
    return os.stat(record).st_mtime_ns if folder and os.path.exists(record) else None


def run(scene: Path, dimension: int = 2, settings: Settings | None = None, *, out: Path | None = None, precision: str = "double",
        backend: str = "auto", threads: int = 0, quiet: bool = True, programs: Path | None = None) -> results.Run:
    """Runs a scene to its end and opens what it wrote.

    `settings` are parameters of the scene in SI units, or keys of its tables: {"h": 2e-3, "run.safety": 0.4, "body.mesh.size": "*0.5"}.
    `out` is the folder of the run (default: the scene's name and the program's, here); one that an earlier run left is replaced.
    `threads` = 0 takes all. With `quiet` = False the program's words and progress go to the terminal.

    A missed expectation, or a verdict "do not trust", is a result: see `Run.ok`. An error is raised as `Error`, in the program's words.
    """
    name = program(dimension, programs)
    folder = os.fspath(out) if out is not None else f"{pathlib.Path(scene).stem}-fissure{dimension}d"
    words = ["--out", folder, "--precision", precision, "--backend", backend, "--threads", str(threads), *(["--quiet"] if quiet else [])]
    _call([name, "run", os.fspath(scene), *_words(settings), *words], quiet, folder)
    return results.open(folder)


def restart(run: results.Run | Path, time: float | None = None, *, backend: str = "auto", threads: int = 0, quiet: bool = True,
            programs: Path | None = None) -> results.Run:
    """Resumes a run from its last checkpoint, to its end or to `time` [s], and opens it anew."""
    opened = run if isinstance(run, results.Run) else results.open(run)
    name = program(opened.dimension, programs)
    words = ["--backend", backend, "--threads", str(threads), *(["--time", str(time)] if time is not None else [])]
    _call([name, "restart", opened.folder, *words], quiet, opened.folder)
    return results.open(opened.folder)


def check(scene: Path, dimension: int = 2, settings: Settings | None = None, *, threads: int = 0, programs: Path | None = None) -> str:
    """What would be modelled, with mesh, time step, memory and time, in the program's words; runs nothing."""
    return _call([program(dimension, programs), "check", os.fspath(scene), *_words(settings), "--threads", str(threads)], True)


def parameters(scene: Path, dimension: int = 2, settings: Settings | None = None, *, programs: Path | None = None) -> dict[str, float]:
    """The scene's parameters and their values, as `settings` leave them: those that `settings` may name."""
    said = _call([program(dimension, programs), "params", os.fspath(scene), *_words(settings)], True)
    return {name: float(value) for name, value in re.findall(r"^(\S+)\s+(\S+)\s+\(default ", said, re.M)}
