#!/usr/bin/env python3
"""What the programs do when something is wrong: exact messages, exit codes, and nothing lost.

    faults.py fissure2d fissure3d [case ...]

Every case is a function; the last line says how many passed and failed.
"""
import json
import os
import re
import resource
import shutil
import signal
import struct
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


# --------------------------------------------------------------------------------------------------- scenes that are wrong
def scripts_from_strangers(folder):
    for text, pattern in [
        ("while true do end", r"scene\.lua:1: the script ran for more than 10 s"),
        ("local t = {} for i = 1, 1e9 do t[i] = {i} end", r"memory"),
        ("os.execute('touch owned')", r'scene\.lua:1: unknown name "os"'),
        ("", r"scene\.lua: there is no body"),
        ("\x1bLua\x54\x00\x19\x93", r"scene\.lua: a compiled Lua program"),
        ("\x00\xff\xfe garbage \x80", r"scene\.lua:1: unexpected symbol"),
        ("run{ time = 1 }", r"scene\.lua: there is no body"),
    ]:
        path = os.path.join(folder, "scene.lua")
        with open(path, "w", encoding="latin-1") as file:
            file.write(text)
        for program in PROGRAMS:
            expect_error(run(program, "check", path), pattern)
    expect(not os.path.exists("owned"), "a scene reached the shell")


def misspelt_keys_are_all_named(folder):
    path = scene(folder, BLOCK.replace("young", "yong").replace("poisson = 0.3", "poisson = 0.7"))
    result = run(PROGRAMS[0], "check", path)
    expect_error(result, r'unknown key "yong" in elastic; did you mean "young"\?')
    expect(re.search(r"poisson", result.stderr), "the second mistake is not named: " + result.stderr)


def missing_file_and_bad_words(folder):
    for program in PROGRAMS:
        expect_error(run(program, "run", os.path.join(folder, "nowhere.lua")), r"nowhere\.lua")
        path = scene(folder, BLOCK)
        expect_error(run(program, "run", path, "--precision", "dubble"), r'unknown precision "dubble" \(known: double, single\); did you mean "double"\?')
        expect_error(run(program, "run", path, "--backend", "gpu"), r'unknown backend "gpu" \(known: auto, cpu, cuda\)')
        expect_error(run(program, "run", path, "--set", "speed"), r"--set speed: expected name=value")
        expect_error(run(program, "run", path, "--set", "sped=3"), r"sped")


def cuda_without_a_device(folder):
    if os.path.exists("/dev/nvidia0"):
        return
    result = run(PROGRAMS[0], "run", scene(folder, BLOCK), "--backend", "cuda")
    expect_error(result, r'backend "cuda" cannot be used \(.+\); run with --backend cpu\?')


# ----------------------------------------------------------------------------------------------------- runs that go wrong
def unstable_step_names_element_and_keeps_frames(folder):
    path = scene(folder, BLOCK.replace("run{ time = TIME }", "run{ time = 20*us, dt = 1.5*us }"))
    for program in PROGRAMS:
        out = os.path.join(folder, os.path.basename(program))
        result = run(program, "run", path, "--out", out)
        expect_error(result, r"step \d+, t = [\d.e-]+ s: element \d+ of body \"block\" (has turned inside out|is not a number)")
        expect(re.search(r"warning: dt = 1\.5e-06 s is above the stable step [\d.e-]+ s", result.stderr), result.stderr)
        record = open(os.path.join(out, "run.json")).read()
        expect("failed: step" in record, "run.json does not say why")
        expect(len([n for n in os.listdir(os.path.join(out, "frames")) if n[0].isdigit()]) >= 1, "no frame was kept")


def contacts_that_go_deep_are_named(folder):
    """D8: at 10 m/s 4 E' v/c_P is 1.8 GPa. A contact of 60 MPa stops the block only after about half of the way."""
    for program in PROGRAMS:
        for penalty, deep in ("1.8*GPa", False), ("60*MPa", True):
            text = BLOCK.replace("{ 0, -1 }", "{ 0, -10 }").replace("density = 7800,", "density = 7800, contact = { penalty = %s }," % penalty)
            path = scene(folder, text, "100*us")
            result = run(program, "run", path, "--out", os.path.join(folder, os.path.basename(program) + penalty[:2]))
            expect(result.returncode == 0, result.stderr)
            warning = re.search(r"warning: contacts went (\d+) % of the way to an element's centre; a larger contact penalty", result.stdout)
            expect(bool(warning) == deep, f"penalty {penalty}: {result.stdout}")
            expect(not deep or 25 < int(warning[1]) < 90, f"penalty {penalty}: {result.stdout}")


def springs_that_hold_too_much_are_named(folder):
    """A beam one cell thick that bends: nearly all that one-point blocks hold is held by springs; other blocks have none to name."""
    text = """
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 } }
body{ "beam", shape = box{ size = {20*mm, 2*mm, 2*mm}, center = {0, 0, 0} }, mesh = { size = 2*mm, cells = "block", integration = "HOW" },
      material = steel, velocity = function(x, y, z) return { 0, 2e4*x*x, 0 } end }
output{ every = 20*us }
run{ time = TIME }
"""
    for program in PROGRAMS:
        for how, named in ("one_point", True), ("assumed_strain", False), ("full", False):
            result = run(program, "run", scene(folder, text.replace("HOW", how), "40*us"), "--out", os.path.join(folder, os.path.basename(program) + how))
            expect(result.returncode == 0, result.stderr)
            warning = re.search(r"warning: springs against hourglass modes held up to ([\d.]+) % of what bodies held", result.stdout)
            expect(bool(warning) == ("springs against hourglass" in open(os.path.join(folder, os.path.basename(program) + how, "run.json")).read()), how)
            expect(bool(warning) == named, f"{how}: {result.stdout}")
            expect(not named or 5 < float(warning[1]) <= 100, f"{how}: {result.stdout}")


def a_balance_that_is_broken_is_named(folder):
    """A given step that bulk survives and a contact of 2000 GPa does not: each bounce gains energy."""
    for program in PROGRAMS:
        for penalty, broken in ("20*GPa", False), ("2000*GPa", True):
            text = BLOCK.replace("density = 7800,", "density = 7800, contact = { penalty = %s }," % penalty).replace("run{ time = TIME }", "run{ time = TIME, dt = 0.1*us }")
            result = run(program, "run", scene(folder, text), "--out", os.path.join(folder, os.path.basename(program) + penalty[:2]))
            expect(result.returncode == (1 if broken else 0), result.stdout[-300:] + result.stderr)
            expect(("warning: the balance of energy is off by " in result.stdout) == broken, f"{penalty}: {result.stdout}")


def corners_pushed_through_their_blocks_are_named(folder):
    """A block of one point sees only its mean strain: a corner is pushed through it beneath a plate."""
    text = """
local soft = material{ "soft", density = 1000, elastic = { young = 1*MPa, poisson = 0.3, law = "neo_hookean" } }
local block = body{ "block", shape = box{ size = {10*mm, 10*mm, 10*mm}, center = {0, 0, 0} }, mesh = { size = 5*mm, cells = "block" }, material = soft }
hold{ block, at = "bottom", velocity = { 0, 0, 0 } }
hold{ block, at = function(x, y, z) return x > 4.9*mm and y > 4.9*mm end, velocity = { -1, -1, 0 } }
plate{ "roof", above(block), velocity = { 0, -1 } }
output{ every = 1*ms }
run{ time = TIME }
"""
    for program in PROGRAMS:
        result = run(program, "run", scene(folder, text, "20*ms"), "--out", os.path.join(folder, os.path.basename(program)))
        expect_error(result, r"a corner of element \d of body \"block\" has turned inside out where it touches something; .*another integration may help")


def a_step_that_falls_without_end_stops_the_run(folder):
    """A soft layer between a floor and a plate that comes down on it: the step follows its thickness."""
    text = """
local clay = material{ "clay", density = 1000, elastic = { young = 1*GPa, poisson = 0.3 }, plastic = { law = "j2", yield = 1*MPa } }
local layer = body{ "layer", shape = box{ size = {10*mm, 2*mm, 10*mm}, center = {0, 0, 0} }, mesh = { size = 2*mm, structured = true }, material = clay }
for _, side in ipairs{ "left", "right" } do hold{ layer, at = side, velocity = { 0 } } end
for _, side in ipairs{ "back", "front" } do if dim == 3 then hold{ layer, at = side, velocity = { nil, nil, 0 } } end end
hold{ layer, at = "bottom", velocity = { nil, 0 } }
hold{ layer, at = "top", velocity = { nil, -1 } }
output{ every = 1*ms }
run{ time = TIME }
"""
    for program in PROGRAMS:
        result = run(program, "run", scene(folder, text, "2*ms"), "--out", os.path.join(folder, os.path.basename(program)))
        expect_error(result, r"the stable step has fallen from [\d.e-]+ to [\d.e-]+ s \(element \d+, its size and shape\): what limits it is crushed")


def folders_that_cannot_be_written(folder):
    path = scene(folder, BLOCK)
    expect_error(run(PROGRAMS[0], "run", path, "--out", "/proc/fissure"), r"/proc/fissure")
    other = os.path.join(folder, "precious")
    os.mkdir(other)
    open(os.path.join(other, "thesis.txt"), "w").write("do not lose")
    expect_error(run(PROGRAMS[0], "run", path, "--out", other), r"precious")
    expect(open(os.path.join(other, "thesis.txt")).read() == "do not lose", "a user's file was touched")
    expect_error(run(PROGRAMS[0], "run", path, "--out", path), r"scene\.lua")


def full_disk(folder):
    """A limit on file sizes stands for the disk: writing fails in the middle of a run."""
    path = scene(folder, BLOCK.replace("2.5*mm", "1*mm"))
    out = os.path.join(folder, "out")
    result = run(PROGRAMS[1], "run", path, "--out", out, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000)))
    expect_error(result, r"cannot be written|File too large|No space")


# ------------------------------------------------------------------------------------------------- stopping and going on
def ctrl_c_leaves_a_run_to_go_on_from(folder):
    path = scene(folder, unhurried(CRACKING), "50*us")  # most joints break between 10 and 30 us
    whole, broken = os.path.join(folder, "whole"), os.path.join(folder, "broken")
    for dimension, program in DIMENSION.items():
        a, b = whole + str(dimension), broken + str(dimension)
        expect(run(program, "run", path, "--out", a, "--threads", "1").returncode == 0, "the whole run failed")
        status = interrupted_at("000002.h5", program, path, b, "1", signal.SIGINT)
        expect(status == 130, f"exit status {status}")
        expect('"finished": "interrupted"' in open(os.path.join(b, "run.json")).read(), "run.json does not say that it was interrupted")
        result = run(program, "restart", b, "--threads", "2")
        expect(result.returncode == 0, result.stderr)
        compare(numbers_of(a), numbers_of(b), f"{dimension}D after Ctrl-C and restart")


def a_folder_has_one_run(folder):
    """A second run and a restart are refused while the first writes; it loses nothing, and afterwards the folder is free."""
    path = scene(folder, unhurried(ELASTIC), "20*us")
    for dimension, program in DIMENSION.items():
        a, b = os.path.join(folder, f"a{dimension}"), os.path.join(folder, f"b{dimension}")
        expect(run(program, "run", path, "--out", a, "--threads", "1").returncode == 0, "the run alone failed")
        first = subprocess.Popen([program, "run", path, "--out", b, "--threads", "1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while first.poll() is None and not os.path.exists(os.path.join(b, "frames", "000001.h5")):
            time.sleep(0.005)
        first.send_signal(signal.SIGSTOP)
        expect_error(run(program, "run", path, "--out", b), "a run is going on there")
        expect_error(run(program, "restart", b), "a run is going on there")
        first.send_signal(signal.SIGCONT)
        expect(first.wait(timeout=300) == 0, "the first run failed")
        compare(numbers_of(a), numbers_of(b), f"{dimension}D beside a second run")
        expect(run(program, "run", path, "--out", b).returncode == 0, "the folder is not free")


def a_stopped_run_goes_on_past_its_stop(folder):
    for dimension, program in DIMENSION.items():
        whole, stopped = os.path.join(folder, f"a{dimension}"), os.path.join(folder, f"b{dimension}")
        early = ELASTIC.replace("time = TIME", "time = TIME, stop = function(now) return now.time > 4*us end")
        expect(early != ELASTIC, "no run{ time = TIME } in the scene")
        path = scene(folder, ELASTIC, "20*us", "whole.lua")
        expect(run(program, "run", path, "--out", whole).returncode == 0, "the whole run failed")
        result = run(program, "run", scene(folder, early, "20*us"), "--out", stopped)
        expect("stop condition" in result.stdout and f"restart {stopped} --time" in result.stdout, result.stdout)
        last = {}
        for until in ("1.9999999999999998e-05", "3e-5"):  # 20*us, as the whole run; twice: the second goes on from where the first ended
            result = run(program, "restart", stopped, "--time", until)
            expect(result.returncode == 0 and "end of time" in result.stdout, result.stdout + result.stderr)
            last[until] = list(open(os.path.join(stopped, "history.csv")))[-1]
            expect(abs(float(last[until].split(",")[0]) - float(until)) < 1e-12 * float(until), f"{dimension}D: ended at {last[until]}")
        expect_error(run(program, "restart", stopped, "--time", "1e-5"), "already at .* give a later time")
        expect(last["1.9999999999999998e-05"] == list(open(os.path.join(whole, "history.csv")))[-1], f"{dimension}D: {last} is not the whole run's end")


def a_run_ends_when_it_should(folder):
    """Also when it is shorter than a step, when its last step is a sliver, and with a step of the user's own."""
    for program in PROGRAMS:
        for asked, dt in ("5e-9", ""), ("5e-6", ""), ("1.0000001e-6", ", dt = 1e-7"), ("0.95e-6", ", dt = 1e-7"):
            out = os.path.join(folder, os.path.basename(program) + asked)
            result = run(program, "run", scene(folder, BLOCK.replace("time = TIME", "time = TIME" + dt), asked), "--out", out)
            expect(result.returncode == 0, result.stdout + result.stderr)
            ended = float(list(open(os.path.join(out, "history.csv")))[-1].split(",")[0])
            expect(abs(ended - float(asked)) <= 2e-12 * float(asked), f"{asked}: ended at {ended}")


def a_restart_knows_what_the_run_read(folder):
    """From any folder; refused when a required module or a mesh file has changed, when a row of history is damaged."""
    text = 'local lib = require "lib"\n' + ELASTIC.replace("200*GPa", "lib.young")
    for program in PROGRAMS:
        place = os.path.join(folder, os.path.basename(program))
        os.mkdir(place)
        module = os.path.join(place, "lib.lua")
        def write(young):
            with open(module, "w") as file:
                file.write("return { young = %s }\n" % young)
        write("200e9")
        scene(place, text, "10*us")
        expect(run(program, "run", "scene.lua", "--out", "out", cwd=place).returncode == 0, "the run failed")
        restart = lambda until: run(program, "restart", os.path.join(place, "out"), "--time", until, cwd="/")
        result = restart("1.2e-5")
        expect(result.returncode == 0, result.stderr)
        write("20e9")
        expect_error(restart("1.4e-5"), "does not read as it did")
        write("200e9")
        rows = list(open(os.path.join(place, "out", "history.csv")))
        for damage in ("garbage\n", rows[5].replace(",", ",12x,", 1), ",".join(rows[5].split(",")[:3]) + "\n", rows[5].split(",")[0] + "x," + rows[5].split(",", 1)[1]):
            with open(os.path.join(place, "out", "history.csv"), "w") as file:
                file.writelines(rows[:5] + [damage] + rows[6:])
            expect_error(restart("1.4e-5"), "history.csv:6: this row cannot be read")
        with open(os.path.join(place, "out", "history.csv"), "w") as file:
            file.writelines(rows)
        expect(restart("1.4e-5").returncode == 0, "a mended history is not taken")


def measures_named_like_columns_are_refused(folder):
    for name in ("energy kinetic", "time step", "broken joints", "energy residual"):
        text = ELASTIC + 'measure{ "%s", function(now) return 1 end }\n' % name
        for program in PROGRAMS:
            expect_error(run(program, "check", scene(folder, text)), 'the history has a column "%s" already' % name)
    text = ELASTIC + 'measure{ "a/b", function(now) return 1 end }\nmeasure{ "a|b", function(now) return 1 end }\n'
    expect_error(run(PROGRAMS[0], "check", scene(folder, text)), "stored under the same name")


def a_dt_that_contact_makes_too_long_is_named(folder):
    """Half the step that is stable at rest, until the block meets another and contact asks for a shorter one."""
    text = """local s = material{ "s", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 }, contact = { penalty = 2000*GPa } }
body{ "a", shape = box{ size = { 10*mm, 10*mm, 10*mm }, center = { 0, -5*mm } }, mesh = { size = 5*mm, structured = true }, material = s }
body{ "b", shape = box{ size = { 10*mm, 10*mm, 10*mm }, center = { 0, 5.1*mm } }, mesh = { size = 5*mm, structured = true }, material = s,
      velocity = { 0, -20 } }
run{ time = TIME, dt = 0.15*us, allowed_residual = 100 }
"""
    for program in PROGRAMS:
        result = run(program, "run", scene(folder, text, "8*us"), "--out", os.path.join(folder, os.path.basename(program)))
        warnings = re.findall(r"warning: dt = 1.5e-07 s is above the stable step ([0-9.e-]+) s", result.stdout + result.stderr)
        expect(len(warnings) == 1 and float(warnings[0]) < 1.5e-7, result.stdout + result.stderr)


def kill_leaves_a_run_to_go_on_from(folder):
    path = scene(folder, unhurried(CRACKING), "50*us")  # most joints break between 10 and 30 us
    for dimension, program in DIMENSION.items():
        a, b = os.path.join(folder, f"a{dimension}"), os.path.join(folder, f"b{dimension}")
        expect(run(program, "run", path, "--out", a, "--threads", "2").returncode == 0, "the whole run failed")
        status = interrupted_at("000003.h5", program, path, b, "2", signal.SIGKILL)
        expect(status == -signal.SIGKILL, f"exit status {status}")
        result = run(program, "restart", b, "--threads", "1")
        expect(result.returncode == 0, result.stderr)
        compare(numbers_of(a), numbers_of(b), f"{dimension}D after a kill and restart")


def a_block_that_nothing_touches_goes_on(folder):
    path = scene(folder, unhurried(ELASTIC), "40*us")
    for dimension, program in DIMENSION.items():
        a, b = os.path.join(folder, f"a{dimension}"), os.path.join(folder, f"b{dimension}")
        expect(run(program, "run", path, "--out", a).returncode == 0, "the whole run failed")
        expect(interrupted_at("000003.h5", program, path, b, "1", signal.SIGINT) == 130, "not interrupted")
        result = run(program, "restart", b)
        expect(result.returncode == 0, result.stderr)
        compare(numbers_of(a), numbers_of(b), f"{dimension}D after Ctrl-C and restart")


def killed_before_its_second_checkpoint_it_goes_on_from_the_start(folder):
    path = scene(folder, unhurried(ELASTIC.replace("checkpoint_every = 3*us", "checkpoint_every = 1")), "10*us")
    for dimension, program in DIMENSION.items():
        a, b = os.path.join(folder, f"a{dimension}"), os.path.join(folder, f"b{dimension}")
        expect(run(program, "run", path, "--out", a).returncode == 0, "the whole run failed")
        expect(interrupted_at("000001.h5", program, path, b, "1", signal.SIGKILL) == -signal.SIGKILL, "not killed")
        result = run(program, "restart", b)
        expect(result.returncode == 0, result.stderr)
        compare(numbers_of(a), numbers_of(b), f"{dimension}D after a kill and restart from the start")


def same_bits_and_goes_on(folder, dimension, program, path, happened):
    """One and two threads give the same bits, a run killed at its fourth frame goes on to them, and a column is above zero."""
    runs = []
    for threads in ("1", "2"):
        out = os.path.join(folder, f"{dimension}d-{threads}")
        expect(run(program, "run", path, "--out", out, "--threads", threads, timeout=900).returncode == 0, "run failed")
        runs.append(numbers_of(out))
    compare(runs[0], runs[1], f"{dimension}D, 1 and 2 threads")
    rows = [line.rstrip("\n").split(",") for line in open(os.path.join(out, "history.csv"))]
    expect(float(rows[-1][rows[0].index(happened)]) > 0, f"{happened} is zero")
    b = os.path.join(folder, f"killed{dimension}")
    expect(interrupted_at("000003.h5", program, path, b, "1", signal.SIGKILL) == -signal.SIGKILL, "not killed")
    result = run(program, "restart", b, "--threads", "1")
    expect(result.returncode == 0, result.stderr)
    compare(runs[0], numbers_of(b), f"{dimension}D after a kill and restart")


def blocks_that_crack_give_the_same_bits_and_go_on(folder):
    for dimension, program in DIMENSION.items():
        size = "1.2*mm" if dimension == 2 else "2*mm"  # at least the 256 blocks from which on threads share them
        path = scene(folder, unhurried(CRACKING.replace("size = 2.5*mm", f'size = {size}, cells = "block"')), "40*us", f"scene{dimension}.lua")
        same_bits_and_goes_on(folder, dimension, program, path, "broken joints []")


def compare(a, b, what):
    expect(a.keys() == b.keys(), f"{what}: files differ: {sorted(a.keys() ^ b.keys())}")
    for name in a:
        expect(a[name] == b[name], f"{what}: {name} differs")


def any_number_of_threads_gives_the_same_bits(folder):
    for dimension, program in DIMENSION.items():
        path = scene(folder, CRACKING.replace("2.5*mm", "1.2*mm" if dimension == 2 else "1.7*mm"), "30*us")
        runs = []
        for threads in ("1", "2", "8"):
            out = os.path.join(folder, f"{dimension}d-{threads}")
            expect(run(program, "run", path, "--out", out, "--threads", threads, timeout=900).returncode == 0, "run failed")
            runs.append(numbers_of(out))
        compare(runs[0], runs[1], f"{dimension}D, 1 and 2 threads")
        compare(runs[0], runs[2], f"{dimension}D, 1 and 8 threads")


def equal_runs_give_equal_bytes(folder):
    """Every file but run.json, which says when: numbers, checkpoints, HDF5's own bookkeeping."""
    path = scene(folder, CRACKING, "20*us")
    for dimension, program in DIMENSION.items():
        bytes_of = []
        for turn in ("one", "two"):
            out = os.path.join(folder, f"{turn}{dimension}")
            expect(run(program, "run", path, "--out", out, "--threads", "1").returncode == 0, "run failed")
            files = [os.path.join(place, name) for place, _, names in os.walk(out) for name in names if name != "run.json"]
            bytes_of.append({os.path.relpath(file, out): open(file, "rb").read() for file in files})
            time.sleep(1.1)  # time stamps count seconds
        expect(bytes_of[0].keys() == bytes_of[1].keys() and len(bytes_of[0]) > 5, str(bytes_of[0].keys()))
        differ = [name for name, content in bytes_of[0].items() if content != bytes_of[1][name]]
        expect(not differ, f"{dimension}D: {differ} differ")


def command_lines_that_are_wrong(folder):
    for program in PROGRAMS:
        for words, pattern in [([], r"(?s)run a scene.*restart"), (["rn", "x.lua"], r'unknown command "rn" \(known: run, check.*did you mean "run"\?'),
                               (["run"], r"scene is required; fissure.d run --help"), (["run", "x.lua", "--thread", "1"], r"--thread.*--help lists"),
                               (["run", "x.lua", "--threads", "many"], r"threads.*--help"), (["--versoin"], r"--help lists")]:
            result = run(program, *words)
            expect(result.returncode == 2, f"{words}: status {result.returncode}")
            expect(re.search(pattern, result.stderr), f"{words}: {result.stderr}")
        expect(run(program, "--help").returncode == 0 and run(program, "--version").returncode == 0, "help or version")


def checkpoints_that_are_not(folder):
    path = scene(folder, CRACKING, "30*us")
    out = os.path.join(folder, "out")
    expect(run(PROGRAMS[0], "run", path, "--out", out).returncode == 0, "run failed")
    checkpoint = os.path.join(out, "checkpoint.bin")
    good = open(checkpoint, "rb").read()
    for bad, pattern in [
        (b"", r"checkpoint\.bin: is no checkpoint"),
        (b"not a checkpoint", r"checkpoint\.bin: is no checkpoint"),
        (good[: len(good) // 2], r"checkpoint\.bin: is cut off \(\d+ of \d+ bytes\)"),
        (good[:-1], r"checkpoint\.bin: is cut off \(\d+ of \d+ bytes\)"),
        (good[:100] + b"\x01" + good[101:], r"checkpoint\.bin: is damaged \(its checksum is wrong\)"),
        (without_values(good, b"runner"), r"fissure2d: unexpected failure \(.+\); please report it"),
    ]:
        open(checkpoint, "wb").write(bad)
        expect_error(run(PROGRAMS[0], "restart", out), pattern)
    open(checkpoint, "wb").write(good)
    expect_error(run(PROGRAMS[1], "restart", out), r"the checkpoint was written by fissure2d; restart it with that program\?")
    os.remove(checkpoint)
    expect_error(run(PROGRAMS[0], "restart", out), r"checkpoint\.bin: cannot be read \(No such file or directory\)")


def without_values(checkpoint, name):
    """A whole checkpoint, with a checksum that is right, whose entry `name` has no values: what the program cannot foresee."""
    key = struct.pack("<Q", len(name)) + name
    at = checkpoint.index(key) + len(key)
    (size,) = struct.unpack_from("<Q", checkpoint, at)
    length = checkpoint.index(b"\n") + 1 + 8
    body = checkpoint[:length] + struct.pack("<Q", len(checkpoint) - size) + checkpoint[length + 8 : at] + bytes(8) + checkpoint[at + 8 + size : -8]
    checksum = 0xCBF29CE484222325
    for byte in body:
        checksum = (checksum ^ byte) * 0x100000001B3 % 2**64
    return body + struct.pack("<Q", checksum)


def slivers_are_named_with_what_they_cost(folder):
    slit = BLOCK.replace("shape = box{", "shape = difference{ box{").replace("center = {0, 0, 0} }", "center = {0, 0, 0} }, notch{ from = {-2*mm, 0}, to = {2*mm, 0}, width = 0.02*mm } }")
    result = run(PROGRAMS[0], "check", scene(folder, slit.replace("2.5*mm, structured = true", "1*mm")))
    expect(result.returncode == 0, result.stderr)
    expect(re.search(r'warning: .*body "block": cell \d+ near .* is a sliver .* time step is about \d+ times shorter', result.stdout), result.stdout)
    expect(re.search(r" steps, [\d.e-]+ ms each as measured now on this machine: about ", result.stdout), result.stdout)


FLOWING = CRACKING.replace("fracture = {", """plastic = { law = "johnson_cook", A = 40*MPa, B = 20*MPa, n = 0.3, C = 0.01, pressure = "averaged",
  heat = { capacity = 800 } }, fracture = {""")


def flow_beside_fracture_gives_the_same_bits_and_goes_on(folder):
    for dimension, program in DIMENSION.items():  # enough elements for two threads to share them
        path = scene(folder, unhurried(FLOWING.replace("2.5*mm", "1.2*mm" if dimension == 2 else "1.6*mm").replace("every = 10*us", "every = 4*us")
                                       .replace("checkpoint_every = 20*us", "checkpoint_every = 6*us")), "16*us", f"scene{dimension}.lua")
        same_bits_and_goes_on(folder, dimension, program, path, "energy plastic [J]")


def what_overlaps_or_touches_nothing_is_named(folder):
    for program in PROGRAMS:
        deep = BLOCK.replace("below(block)", "box = box{ size = {20*mm, 2*mm, 20*mm}, center = {0, -5*mm} }")
        for command in ("check", "run"):
            expect_error(run(program, command, scene(folder, deep)), r'scene\.lua:5: plate "floor" and body "block" overlap by 0\.001 m at the start')
        overlapping = BLOCK.replace("local floor", """body{ "low", shape = box{ size = {20*mm, 10*mm, 10*mm}, center = {0, -9.99*mm, 0} }, mesh = { size = 2.5*mm, structured = true }, material = steel }
local floor""").replace("below(block)", "box = box{ size = {20*mm, 2*mm, 20*mm}, center = {0, -16.99*mm} }")
        path = scene(folder, overlapping, "20*us")
        named = r'warning: .*scene\.lua:5: body "block" and body "low" overlap by 1e-05 m at the start'
        gap = r'plate "floor" touches nothing: body "low" is nearest, 0\.001 m away'
        checked = run(program, "check", path)
        expect(re.search(named, checked.stdout) and re.search(gap, checked.stdout), checked.stdout)
        result = run(program, "run", path, "--out", os.path.join(folder, "out"))
        expect(re.search(named, result.stderr), result.stderr)
        expect(result.returncode == 0 and "balance of energy is off" not in result.stdout, result.stdout)  # what the overlap held is booked
        clear = run(program, "run", scene(folder, BLOCK.replace("below(block)", "box = box{ size = {20*mm, 2*mm, 20*mm}, center = {0, -7*mm} }"), "2*us"), "--out", os.path.join(folder, "clear"))
        expect(re.search(r'warning: .*scene\.lua:\d+: plate "floor" was never touched', clear.stdout), clear.stdout)
        touched = run(program, "run", scene(folder, BLOCK, "2*us"), "--out", os.path.join(folder, "touched"))
        expect("never touched" not in touched.stdout and "touches nothing" not in touched.stdout, touched.stdout)


def holds_that_contradict_each_other_are_refused(folder):
    def with_holds(*holds):
        return scene(folder, re.sub(r"\nbody\{", "\nlocal b = body{", ELASTIC).replace("output{", "\n".join(holds) + "\noutput{"), "1*us")
    at = 'hold{ b, at = "%s", velocity = { %s } }'
    for program in PROGRAMS:
        for one, other, numbers in (("nil, 0", "0, 1", "along y: 1 and 0 m/s at t = 0 s"), ("nil, -1", "0, 1", "along y: 1 and -1 m/s"),
                                    ("2, 0", "3", "along x: 3 and 2 m/s"), ("nil, 0", "0, function(t) return 1e6*t end", "along y: .* at t = 1.5625e-08 s")):
            for command in ("check", "run"):
                expect_error(run(program, command, with_holds(at % ("bottom", one), at % ("left", other))),
                             r'scene\.lua:\d+: this hold and the one at .*scene\.lua:\d+ ask a vertex of body "block" for different velocities ' + numbers)
        for one, other, places in (("nil, 0", "0", ("bottom", "left")), ("nil, 0", "nil, 1", ("bottom", "top")), ("0, 0", "0", ("bottom", "left")),
                                   ("nil, function(t) return t end", "0, function(t) return t end", ("bottom", "left"))):
            result = run(program, "check", with_holds(at % (places[0], one), at % (places[1], other)))
            expect(result.returncode == 0, result.stderr)


def a_balance_that_is_off_is_told_by_the_exit_status(folder):
    for program in PROGRAMS:
        for allowed, status in (("", 0), (", allowed_residual = 0.5", 0), (", allowed_residual = 1e-15", 1)):  # rounding alone exceeds 1e-15
            result = run(program, "run", scene(folder, BLOCK.replace("time = TIME", "time = TIME" + allowed), "2*us"), "--out", os.path.join(folder, "out"))
            expect(result.returncode == status, f"exit status {result.returncode}, expected {status}: {result.stdout[-300:]}{result.stderr[-300:]}")
            expect(("balance of energy is off" in result.stdout) == (status == 1), result.stdout[-300:])
        for bad, why in (("0/0", "not a number"), ("-1", "must be > 0"), ("0", "must be > 0"), ("'much'", "number")):
            expect_error(run(program, "check", scene(folder, BLOCK.replace("time = TIME", f"time = TIME, allowed_residual = {bad}"), "2*us")), why)


# Blocks that meet with a step too long for their contact, while all flies at 1000 m/s or as given.
MEETING = """
local s = material{ "s", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 }, contact = { penalty = 200*GPa, friction = 0.2 } }
body{ "a", shape = box{ size = { 10*mm, 10*mm, 10*mm }, center = { 0, -5*mm } }, mesh = { size = 2.5*mm }, material = s, velocity = { 1000, 0 } }
body{ "b", shape = box{ size = { 10*mm, 10*mm, 10*mm }, center = { 0, 5.01*mm } }, mesh = { size = 2.5*mm }, material = s, velocity = { 1000, SPEED } }
run{ time = TIME, DT }
"""


def a_bad_balance_does_not_hide_behind_a_flight(folder):
    for program in PROGRAMS:
        for speed, dt, precision, status in (("-1", "dt = 0.16*us", "double", 1), ("-1", "safety = 0.2", "double", 0),
                                             ("0", "safety = 0.8", "double", 0), ("0", "safety = 0.8", "single", 0)):
            text = MEETING.replace("SPEED", speed).replace("DT", dt)
            result = run(program, "run", scene(folder, text, "18*us"), "--precision", precision, "--out", os.path.join(folder, "out"))
            what = f"{speed} {dt} {precision}: exit status {result.returncode}, expected {status}: {result.stdout[-600:]}{result.stderr[-300:]}"
            expect(result.returncode == status, what)
            with open(os.path.join(folder, "out", "run.json")) as file:
                balance = json.load(file)["balance"]
            expect((balance["off by"] >= 0.05) == (status == 1), what)
            expect(speed == "0" or balance["share of"] == "energy turned over" and "of the energy turned over" in result.stdout, what)


def the_plan_declares_what_takes_energy(folder):
    for program in PROGRAMS:
        for text, there in ((CRACKING, True), (CRACKING.replace(", damping = { share = 0.1 }", ""), True), (ELASTIC, False)):
            checked = run(program, "check", scene(folder, text, "2*us"))
            expect(bool(re.search(r"yes joint damper .*booked as viscous", checked.stdout)) == there, checked.stdout + checked.stderr)


def intervals_below_the_step_come_every_step(folder):
    for key in ("every", "measure_every", "checkpoint_every"):
        for tiny in ("1e-30", "1e-300", "1e-12"):
            text = re.sub(r"output\{.*\}", f"output{{ {key} = {tiny} }}", ELASTIC)
            result = run(PROGRAMS[0], "run", scene(folder, text, "1*us"), "--out", os.path.join(folder, "out"), timeout=60)
            expect(result.returncode == 0, result.stderr)
    for bad, why in (("0/0", "not a number"), ("1/0", "infinite"), ("-1", "must be > 0"), ("0", "must be > 0")):
        for text in (re.sub(r"output\{.*\}", f"output{{ every = {bad} }}", ELASTIC), ELASTIC.replace("time = TIME", f"time = 1*us, dt = {bad}"), ELASTIC.replace("TIME", bad)):
            for command in ("check", "run"):
                expect_error(run(PROGRAMS[0], command, scene(folder, text, "1*us")), why)


def what_is_hardly_meant_is_asked_about(folder):
    in_millimetres = run(PROGRAMS[0], "check", scene(folder, ELASTIC.replace("*mm", ""), "20*us"))
    expect(re.search(r'warning: .*body "block" is 10 m wide, .*are its lengths in millimetres', in_millimetres.stdout), in_millimetres.stdout)
    one_cell = run(PROGRAMS[0], "check", scene(folder, ELASTIC.replace("size = 2.5*mm", "size = 2.5"), "20*us"))
    expect(re.search(r'warning: .*body "block": mesh.size = 2.5 m, and the body is 0.01 m wide; is a unit missing', one_cell.stdout), one_cell.stdout)
    rubber = run(PROGRAMS[0], "check", scene(folder, CRACKING.replace("G1 = 5*J/m2", "G1 = 5*kJ/m2"), "20*us"))
    expect(re.search(r'warning: .*body "disc": its process zone .* times as long as the body: .*is a unit wrong', rubber.stdout), rubber.stdout)
    brittle = run(PROGRAMS[0], "run", scene(folder, CRACKING.replace("G1 = 5*J/m2", "G1 = 0.05*J/m2"), "1*us"), "--out", os.path.join(folder, "out"))
    unresolved = r'warning: .*body "disc": its process zone .* is shorter than an edge .*a mesh.size of '
    expect(re.search(unresolved, brittle.stderr) and re.search(unresolved, brittle.stdout), brittle.stdout + brittle.stderr)
    usual = run(PROGRAMS[0], "check", scene(folder, BLOCK, "20*us"))
    expect("warning" not in usual.stdout, usual.stdout)


CASES = [value for name, value in list(globals().items()) if callable(value) and getattr(value, "__module__", "") == "__main__"
         and value.__code__.co_varnames[: value.__code__.co_argcount] == ("folder",) and value is not numbers_of]


def main():
    failed = 0
    cases = [case for case in CASES if not sys.argv[3:] or case.__name__ in sys.argv[3:]]
    for case in cases:
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
    print(f"{len(cases) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
