#!/usr/bin/python3
"""`require "lab"` and "materials": every experiment can be read and meshed in both dimensions, with every kind of material it is for; the list of
materials; and a program that was copied away from its sources has them. Runs of them are tests of examples/laboratory.

    check_laboratory.py fissure2d fissure3d
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

PROGRAMS = [os.path.abspath(path) for path in sys.argv[1:3]]
BRITTLE, METAL = "granite limestone concrete alumina ice".split(), ["OFHC copper", "mild steel", "42CrMo4"]
MATERIALS = {"ucs": BRITTLE, "triaxial": BRITTLE, "brazilian": BRITTLE, "direct_shear": BRITTLE, "three_point_bend": BRITTLE, "dcb": BRITTLE, "ring": BRITTLE,
             "taylor": METAL, "shpb": ["granite", *METAL], "cube": ["granite", "PMMA", *METAL]}
# What a user may well change, beside the material.
CHANGED = {"ucs": "width = 38*mm, height = 76*mm, friction = 0.2, seed = 3", "triaxial": "confine = 0", "brazilian": "diameter = 54*mm, thickness = 27*mm",
           "direct_shear": "plane = 0, normal = 1*MPa", "three_point_bend": "notch = 0, span = 200*mm", "dcb": "crack = 30*mm, length = 120*mm", "ring": "modulus = 10, speed = 80",
           "taylor": "speed = 300", "shpb": "striker = 5, length = 5*mm", "cube": "crossings = 100"}
# Scenes that cannot be meant, and what is said of them.
REFUSED = {
    'local m = require "materials".granite m.me = m require "lab".ucs{ material = m }': "a table holds itself",
    'require "lab".direct_shear{ material = "sandstone", normal = 0, plane = 0 }': "normal and plane are 0: nothing would resist",
    'require "lab".direct_shear{ material = "sandstone", plane = 2 }': "plane must be at most 1",
    'require "lab".ucs{ material = "granite", speed = 0.1, crossings = 30 }': "speed and crossings say the same",
    'local m = require "materials"["4340 steel"] m.plastic = 5 require "lab".taylor{ material = m }': "plastic must be a table, not a number",
    'local m = require "materials".granite m.density = "2700" require "lab".ucs{ material = m }': "density must be a number, not a string",
    'require "lab".ucs{ material = "granit" }': 'did you mean "granite"?',
    'require "lab".ucs{ material = "granite", widht = 1*mm }': 'did you mean "width"?',
}
# A bar that is stretched by 2e-4 everywhere: instruments on it, and their mistakes.
BAR = """local lab = require "lab"
local rock = material{ "rock", density = 2700, elastic = { young = 50*GPa, poisson = 0 } }
local bar = body{ "bar", shape = box{ size = { 100*mm, 20*mm, 20*mm } }, mesh = { size = 10*mm, structured = true }, material = rock,
                  velocity = function(x) return { 2*x, 0, 0 } end }
for _, side in ipairs{ "left", "right" } do hold{ bar, at = side, velocity = { side == "left" and -0.1 or 0.1, 0, 0 } } end
run{ time = 100*us }
measure{ "strain", lab.extensometer(bar, { -20*mm, 0 }, { 30*mm, 0 }) }
measure{ "opening", lab.opening(bar, { -20*mm, 0 }, { 30*mm, 0 }) }
local stress = lab.profile("von_mises", bar, { -45*mm, 1*mm, 1*mm }, { 45*mm, 1*mm, 1*mm }, 7)
finish{ function(now) for _, at in ipairs(stress(now)) do print(string.format("%.1f mm %.3f MPa", at.s/mm, at.value/MPa)) end end }
expect{ "strain", of = "last", equals = 2e-4, tolerance = 2e-8, why = "all of it stretches alike" }
expect{ "opening", of = "last", equals = 1e-5, tolerance = 1e-9, why = "of 50 mm" }
"""
MISUSED = {
    "lab.opening(rock, { 0, 0 }, { 1, 0 })": "value 1 must be a body",
    "lab.opening(5, { 0, 0 }, { 1, 0 })": "lab.opening: value 1 must be a body, not a number",
    "lab.opening(bar, { 0, 0 })": "lab.opening: value 3 must be a point",
    "lab.opening(bar, { 0, 'a' }, { 1, 0 })": "lab.opening: value 2 must be a point",
    "lab.extensometer(bar, { 1, 1 }, { 1, 1 })": "lab.extensometer: both points are the same",
    "lab.profile('von_mises', bar, { 0, 0 }, { 1, 0 }, 1)": "lab.profile: value 5 must be a whole number",
}
problems = []


def instruments(folder):
    path = os.path.join(folder, "bar.lua")
    for program in PROGRAMS:
        with open(path, "w") as file:
            file.write(BAR)
        result = run(program, "run", path, "--threads", "1", "--out", os.path.join(folder, "bar"))
        told = re.findall(r"^([\d.]+) mm ([\d.]+) MPa$", result.stdout, re.M)
        expect(result.returncode == 0 and [float(s) for s, _ in told] == [15.0 * k for k in range(7)] and all(abs(float(v) - 10) < 0.01 for _, v in told),
               f"instruments on a bar: {result.stdout[-600:]} {result.stderr}")
    for call, words in MISUSED.items():
        with open(path, "w") as file:
            file.write(BAR + "measure{ \"m\", " + call + " }\n")
        result = run(PROGRAMS[0], "check", path)
        expect(result.returncode == 2 and words in result.stderr, f"{call}: status {result.returncode}, {result.stderr.strip()}")


def expect(true, what):
    if not true:
        problems.append(what)


def run(program, *words):
    return subprocess.run([program, *words], capture_output=True, text=True, timeout=600)


def checks(folder, name, material, keys=""):
    path = os.path.join(folder, "scene.lua")
    with open(path, "w") as file:
        file.write(f'local lab = require "lab"\nlocal test = lab.{name}{{ material = "{material}", {keys} }}\n')
    for program in PROGRAMS:
        result = run(program, "check", path, "--threads", "1")
        foreseen = re.search(r"^verdict as far as it can be foreseen: (ok|look again)", result.stdout, re.M)
        expect(result.returncode == 0 and foreseen, f"{name} {material} {keys} {os.path.basename(program)}: {result.stderr.strip()} {result.stdout[-200:]}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        instruments(folder)
        for name, materials in MATERIALS.items():
            checks(folder, name, materials[0], CHANGED[name])
            for material in materials:
                checks(folder, name, material)
        checks(folder, "dcb", "PMMA", "mesh = 3*mm")                           # made to fit: arms need a node in their middle
        path = os.path.join(folder, "scene.lua")
        for text, said in REFUSED.items():
            open(path, "w").write(text)
            result = run(PROGRAMS[0], "check", path, "--threads", "1")
            expect(result.returncode == 2 and said in result.stderr, f"{text}: {result.stderr}")
        own = os.path.join(folder, "lab.lua")                                  # never to be taken for the library's, nor left out unsaid
        open(own, "w").write("return {}")
        result = run(PROGRAMS[0], "check", path, "--threads", "1")
        expect(result.returncode == 2 and "has its name" in result.stderr, result.stderr)
        os.remove(own)
        away = os.path.join(folder, "fissure2d")
        shutil.copy(PROGRAMS[0], away)
        lines = run(away, "materials").stdout.splitlines()
        expect(len(lines) == 26 and "nil" not in "".join(lines) and any(re.match(r"granite +2650 +60 +0.25 +8 +joints", line) for line in lines), lines)
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{len(problems)} problems")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
