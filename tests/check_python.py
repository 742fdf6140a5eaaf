#!/usr/bin/python3
"""The package fissure on short runs in both dimensions, and docs/python.md, which it runs: check_python.py FISSURE2D FISSURE3D"""
import doctest
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import traceback

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAMS = {2: os.path.abspath(sys.argv[1]), 3: os.path.abspath(sys.argv[2])}
sys.path.insert(0, str(ROOT / "scripts" / "python"))
import fissure

STONE = """
local size = param("size", dim == 2 and 4*mm or 9*mm, "of elements (m)")
local thickness = 10*mm
local rock = material{ "rock", density = 2700, elastic = { young = 50*GPa, poisson = 0.25 },
  fracture = { tension = 3*MPa, shear = 10*MPa, G1 = 5*J/m2, G2 = 20*J/m2, penalty = 500*GPa }, contact = { penalty = 50*GPa, friction = 0.3 } }
local stone = body{ "stone", shape = disc{ radius = 25*mm, thickness = thickness }, mesh = { size = size }, material = rock, velocity = { 0, -10 } }
local floor = plate{ "floor", below(stone), velocity = { 0, 0 } }
measure{ "load", unit = "N", function(now) return now.force(floor) end }
measure{ "crack", unit = "m2", function(now) return now.crack_area() end }
output{ every = 10*us, fields = { "principal", "stress", "damage", "velocity" } }
expect{ "load", of = "peak", within = { LEAST, 1e9 }, why = "a test" }
run{ time = 30*us }
"""


def opened_and_compared(dimension, folder):
    """Every number of a run against another source of the same number."""
    scene = folder / "stone.lua"
    scene.write_text(STONE.replace("LEAST", "1"))
    assert fissure.parameters(scene, dimension, {"size": 0.011}, programs=folder) == {"size": 0.011}
    assert "time step" in fissure.check(scene, dimension, threads=1, programs=folder)
    run = fissure.run(scene, dimension, threads=1, out=folder / "run", programs=folder)
    assert run.ok and run.finished == "end of time" and run.dimension == dimension, run
    with h5py.File(folder / "run" / "history.h5") as file:
        told = {name: values[()] for name, values in file["history"].items()}
    assert set(told) == set(run.history) and all(np.array_equal(told[name], run.history[name]) for name in told)
    assert list(run.measures) == ["load", "crack"] and (run.units["load"], run.units["energy kinetic"]) == ("N", "J")
    assert {name: values[-1] for name, values in run.energies.items()} == run.record["energy"]
    assert [one["name"] for one in run.expectations] == ["load"] and run.expectations[0]["value"] == run.history["load"].max()
    assert run.verdict.grade == run.record["verdict"]["grade"] == "ok" and str(run.verdict) == "ok"

    frame = run.frames[-1]
    assert len(run.frames) == run.record["frames"] == len(run.frames.times) and run.frames[1:3].times.tolist() == run.frames.times[1:3].tolist()
    assert frame.time == run.history["time"][-1] and run.frames.at(11e-6).time == run.frames[1].time
    cells = sum(len(numbers) for _, numbers in run.mesh.kinds.values())
    assert cells == run.record["cells"] == len(frame.fields["principal"]) and frame.fields["velocity"].shape == frame.points.shape
    assert (frame.units["stress"], frame.where["stress"], frame.where["velocity"]) == ("Pa", "cell", "point")
    # "principal" is written in single precision, as the stress is.
    most = np.abs(frame.fields["principal"]).max()
    assert np.abs(frame.cell_values("stress") - frame.fields["principal"]).max() < 1e-5 * most
    speed = run.frames[0].cell_values("velocity")
    assert np.allclose(speed, 10, rtol=1e-6)
    # Cracks have grown by less than the stretch of the stone since they broke, a few times ft/E.
    area = frame.cracks.size[frame.cracks.broken].sum() * (10e-3 if dimension == 2 else 1)
    assert area > 0 and abs(area / run.history["crack"][-1] - 1) < 0.01, (area, run.history["crack"][-1])
    assert frame.cracks.broken.sum() == run.history["broken joints"][-1] and frame.rigid.shape == (1, 2 ** dimension, 3)
    conversions(run)

    longer = fissure.restart(run, 40e-6, threads=1, programs=folder)
    assert longer.history["time"][-1] >= 40e-6 * (1 - 1e-9) and np.array_equal(longer.history["load"][:100], run.history["load"][:100])

    scene.write_text(STONE.replace("LEAST", "1e8"))
    missed = fissure.run(scene, dimension, {"size": 0.012}, threads=1, out=folder / "missed", programs=folder)
    assert not missed.ok and missed.expectations[0]["passed"] is False


def conversions(run):
    """To packages that are installed; others are named."""
    frame = run.frames[-1]
    for package, convert, same in (
            ("pandas", run.table, lambda table: np.array_equal(table["load"].to_numpy(), run.history["load"]) and table.attrs["units"]["load"] == "N"),
            ("xarray", run.to_xarray, lambda data: np.array_equal(data["principal"][-1], frame.fields["principal"]) and data["load"].attrs["units"] == "N"
             and data["stress"].dims == ("frame_time", "cell", "component") and np.array_equal(data["points"][-1], frame.points)),
            ("pyvista", frame.to_pyvista, lambda grid: grid.n_cells == len(run.mesh.types) and np.array_equal(grid.cell_data["principal"], frame.fields["principal"])
             and np.array_equal(grid.points, frame.points) and abs(grid.compute_cell_sizes()["Area" if run.dimension == 2 else "Volume"].sum() - volume(run)) < 1e-6 * volume(run))):
        try:
            __import__(package)
        except ImportError:
            try:
                convert()
                raise AssertionError(f"there is no {package}, and nobody said so")
            except ImportError as error:
                assert package in str(error) and "not installed" in str(error)
        else:
            assert same(convert()), package
            print(f"{package}: converted")


def volume(run):
    """Of triangles [m2] or tetrahedra [m3] in the last frame."""
    (cells, _), = run.mesh.kinds.values()
    corners = run.frames[-1].points[cells]
    edges = corners[:, 1:] - corners[:, :1]
    return (np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 2 if run.dimension == 2 else np.abs(np.linalg.det(edges)) / 6).sum()


def what_is_wrong_is_raised(dimension, folder):
    scene = folder / "stone.lua"
    scene.write_text(STONE.replace("LEAST", "1"))
    said = subprocess.run([PROGRAMS[dimension], "run", scene, "--set", "sise=1"], capture_output=True, text=True, check=False)
    error = raised(fissure.Error, lambda: fissure.run(scene, dimension, {"sise": 1}, programs=folder))
    assert str(error) == said.stderr.strip() and 'did you mean "size"?' in str(error) and (error.status, error.folder) == (2, None)
    # Far above the stable step it breaks off at work, and what there is can be opened; a scene that cannot be read leaves it alone.
    error = raised(fissure.Error, lambda: fissure.run(scene, dimension, {"run.dt": 2e-6}, out=folder / "broken", programs=folder))
    assert error.status == 2 and error.folder == str(folder / "broken") and len(fissure.open(error.folder).history["time"]) > 0
    error = raised(fissure.Error, lambda: fissure.run(scene, dimension, {"run.ddt": 1}, out=folder / "broken", programs=folder))
    assert error.folder is None
    raised(fissure.Error, lambda: fissure.run(folder / "none.lua", dimension, programs=folder))
    raised(FileNotFoundError, lambda: fissure.open(folder / "none"))
    raised(FileNotFoundError, lambda: fissure.open(folder))
    raised(FileNotFoundError, lambda: fissure.run(scene, dimension, programs=folder / "broken"))
    raised(ValueError, lambda: fissure.run(scene, 4, programs=folder))


def raised(kind, call):
    try:
        call()
    except kind as error:
        return error
    raise AssertionError(f"no {kind.__name__}")


def the_notebook(folder):
    """The cells of examples/first_steps.ipynb, one after the other."""
    os.environ["FISSURE_PROGRAMS"], os.environ["MPLBACKEND"] = str(folder), "Agg"
    os.chdir(ROOT / "examples")
    cells = json.loads((ROOT / "examples/first_steps.ipynb").read_text(encoding="utf-8"))["cells"]
    names = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            assert not cell["outputs"], "the notebook is kept without what came out"
            exec("".join(cell["source"]), names)  # pylint: disable=exec-used
    assert names["run"].ok and all(1 < peak < 10 for peak in names["peaks"]), names.get("peaks")
    shutil.rmtree(names["out"])


def the_page(folder):
    """docs/python.md beside the scene that it runs."""
    shutil.copy(ROOT / "examples/brazilian/brazilian.lua", folder)
    os.environ["FISSURE_PROGRAMS"] = str(folder)
    os.chdir(folder)
    text = (ROOT / "docs/python.md").read_text(encoding="utf-8").replace("```", "")  # where a fence stood the output ends
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    failed, tried = runner.run(doctest.DocTestParser().get_doctest(text, {}, "python.md", "docs/python.md", 0))
    assert not failed and tried > 20 and os.path.getsize("stress.png") > 10000, f"{failed} of {tried} examples of docs/python.md failed"


def main():
    failed = 0
    cases = [(opened_and_compared, 2), (opened_and_compared, 3), (what_is_wrong_is_raised, 2), (what_is_wrong_is_raised, 3), (the_page,), (the_notebook,)]
    for case, *words in cases:
        with tempfile.TemporaryDirectory() as place:
            for program in PROGRAMS.values():
                os.symlink(program, os.path.join(place, os.path.basename(program)))
            try:
                case(*words, pathlib.Path(place))
                print("passed", case.__name__, *words, flush=True)
            except Exception:
                failed += 1
                print("FAILED", case.__name__, *words, traceback.format_exc(), flush=True)
            finally:
                os.chdir(ROOT)
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
