#!/usr/bin/env python3
"""Runs that go wrong: they say so, with the element or the place, and keep what was written.

    runs.py fissure2d fissure3d [case ...]
"""
import json
import os
import re
import resource
import sys

from rig import cases, BLOCK, PROGRAMS, expect, expect_error, run, scene


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
            expect(result.returncode == (1 if named else 0), result.stderr)
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
            expect(status == 0 or balance["share of"] == "energy turned over" and "of the energy turned over" in result.stdout, what)


def bodies_that_go_through_each_other_are_told(folder):
    text = """
local m = material{ "m", density = 2500, elastic = { law = "neo_hookean", young = 5*GPa, poisson = 0.2 },
                         contact = { penalty = PENALTY } }
body{ "target", shape = box{ size = {20*mm, 4*mm, 4*mm} }, mesh = { size = 2*mm, structured = true }, material = m }
body{ "shot", shape = box{ size = {4*mm, 4*mm, 4*mm}, center = {0.3*mm, 4.1*mm} }, mesh = { size = 2*mm, structured = true }, material = m, velocity = { 0, -200 } }
run{ time = TIME }
"""
    for program in PROGRAMS:
        for penalty, status in (("50*MPa", 1), ("5*GPa", 0)):
            result = run(program, "run", scene(folder, text.replace("PENALTY", penalty), "30*us"), "--out", os.path.join(folder, "out"))
            expect(result.returncode == status, result.stdout + result.stderr)
            expect(("gone through each other" in result.stdout) == (status == 1), result.stdout)


if __name__ == "__main__":
    sys.exit(cases(globals()))
