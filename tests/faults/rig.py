"""What tests of faults share: scenes, how to run and judge them, and the list of cases: every function of a folder is one."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

import h5py

ELASTIC = """
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 } }
body{ "block", shape = box{ size = {10*mm, 10*mm, 10*mm}, center = {0, 0, 0} }, mesh = { size = 2.5*mm, structured = true },
      material = steel, velocity = function(x, y, z) return { 100*x, 0, 0 } end }
output{ every = 2*us, checkpoint_every = 3*us }
run{ time = TIME }
"""

PROGRAMS = [os.path.abspath(path) for path in sys.argv[1:3]]
DIMENSION = {2: PROGRAMS[0], 3: PROGRAMS[1]}

BLOCK = """
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3, law = "neo_hookean" } }
local block = body{ "block", shape = box{ size = {10*mm, 10*mm, 10*mm}, center = {0, 0, 0} }, mesh = { size = 2.5*mm, structured = true },
                    material = steel, velocity = { 0, -1 } }
local floor = plate{ "floor", below(block), velocity = { 0, 0 } }
measure{ "load", unit = "N", function(now) return now.force(floor) end }
output{ every = 2*us, checkpoint_every = 3*us }
run{ time = TIME }
"""

CRACKING = """
local rock = material{ "rock", density = 2700, elastic = { young = 50*GPa, poisson = 0.25, damping = { share = 0.1 } },
  fracture = { tension = 3*MPa, shear = 10*MPa, G1 = 5*J/m2, G2 = 20*J/m2, penalty = 500*GPa, friction_angle = 30*deg },
  contact = { penalty = 50*GPa, friction = 0.3 } }
local disc = body{ "disc", shape = disc{ radius = 10*mm, thickness = 4*mm }, mesh = { size = 2.5*mm }, material = rock }
local top    = plate{ "top",    above(disc), velocity = { 0, -2 } }
local bottom = plate{ "bottom", below(disc), velocity = { 0,  2 } }
measure{ "load", unit = "N", function(now) return now.force(top) end }
output{ every = 10*us, checkpoint_every = 20*us, fields = { "stress", "damage", "velocity" } }
run{ time = TIME }
"""


def run(program, *words, **options):
    environment = dict(os.environ, **options.pop("environment", {}))
    return subprocess.run([program, *words], capture_output=True, text=True, errors="replace", timeout=options.pop("timeout", 600), env=environment,
                          **options)


def scene(folder, text, time_="20*us", name="scene.lua"):
    path = os.path.join(folder, name)
    with open(path, "w") as file:
        file.write(text.replace("TIME", time_))
    return path


def unhurried(text):
    """The same scene with a measure that takes its time, so that a signal finds the run at work."""
    return text + 'measure{ "slow", function(now) local s = 0 for i = 1, 100000 do s = s + i end return s end }\n'


def interrupted_at(frame, program, path, out, threads, how):
    """Starts a run and sends it a signal when it has written a frame; returns its exit status."""
    process = subprocess.Popen([program, "run", path, "--out", out, "--threads", threads], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.time() + 300
    while time.time() < deadline and process.poll() is None and not os.path.exists(os.path.join(out, "frames", frame)):
        time.sleep(0.005)
    expect(process.poll() is None, "the run ended before it could be interrupted")
    process.send_signal(how)
    return process.wait(timeout=300)


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


def expect_error(result, pattern):
    expect(result.returncode == 2, f"exit status {result.returncode}, expected 2: {result.stderr[-500:]}")
    expect(re.search(pattern, result.stderr), f"no /{pattern}/ in: {result.stderr[-500:]}")
    for bad in ("terminate called", "Sanitizer", "Segmentation"):
        expect(bad not in result.stderr, result.stderr[-500:])


def numbers_of(folder):
    """Everything that a run computed: its history, and every dataset of every frame, bit for bit."""
    found = {"history.csv": open(os.path.join(folder, "history.csv"), "rb").read()}
    frames = os.path.join(folder, "frames")
    for name in sorted(os.listdir(frames)):
        with h5py.File(os.path.join(frames, name)) as file:
            file.visititems(lambda path, item: found.update({f"{name}:{path}": item[()].tobytes()}) if isinstance(item, h5py.Dataset) else None)
    return found


def cases(of):
    """Runs the functions of a folder in `of`, a script's globals, or those named on the command line; returns the exit status."""
    known = [f for f in of.values() if callable(f) and f.__module__ == "__main__" and f.__code__.co_varnames[: f.__code__.co_argcount] == ("folder",)]
    failed, chosen = 0, [case for case in known if not sys.argv[3:] or case.__name__ in sys.argv[3:]]
    for case in chosen:
        folder = tempfile.mkdtemp(prefix="fissure-")
        started = time.time()
        try:
            case(folder)
            print(f"passed {case.__name__} ({time.time() - started:.1f} s)", flush=True)
        except (AssertionError, subprocess.TimeoutExpired, OSError) as error:
            failed += 1
            print(f"FAILED {case.__name__}: {error}", flush=True)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    print(f"{len(chosen) - failed} passed, {failed} failed")
    return 1 if failed or not chosen else 0
