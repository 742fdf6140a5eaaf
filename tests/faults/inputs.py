#!/usr/bin/env python3
"""Scenes, command lines and files that are wrong or hardly meant: exact messages and exit codes.

    inputs.py fissure2d fissure3d [case ...]
"""
import os
import re
import sys

from rig import cases, BLOCK, CRACKING, ELASTIC, PROGRAMS, expect, expect_error, run, scene


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


def measures_named_like_columns_are_refused(folder):
    for name in ("energy kinetic", "time step", "broken joints", "energy residual"):
        text = ELASTIC + 'measure{ "%s", function(now) return 1 end }\n' % name
        for program in PROGRAMS:
            expect_error(run(program, "check", scene(folder, text)), 'the history has a column "%s" already' % name)
    text = ELASTIC + 'measure{ "a/b", function(now) return 1 end }\nmeasure{ "a|b", function(now) return 1 end }\n'
    expect_error(run(PROGRAMS[0], "check", scene(folder, text)), "stored under the same name")


def command_lines_that_are_wrong(folder):
    for program in PROGRAMS:
        for words, pattern in [([], r"(?s)run a scene.*restart"), (["rn", "x.lua"], r'unknown command "rn" \(known: run, check.*did you mean "run"\?'),
                               (["run"], r"scene is required; fissure.d run --help"), (["run", "x.lua", "--thread", "1"], r"--thread.*--help lists"),
                               (["run", "x.lua", "--threads", "many"], r"threads.*--help"), (["--versoin"], r"--help lists")]:
            result = run(program, *words)
            expect(result.returncode == 2, f"{words}: status {result.returncode}")
            expect(re.search(pattern, result.stderr), f"{words}: {result.stderr}")
        expect(run(program, "--help").returncode == 0 and run(program, "--version").returncode == 0, "help or version")


def slivers_are_named_with_what_they_cost(folder):
    slit = BLOCK.replace("shape = box{", "shape = difference{ box{").replace("center = {0, 0, 0} }", "center = {0, 0, 0} }, notch{ from = {-2*mm, 0}, to = {2*mm, 0}, width = 0.02*mm } }")
    result = run(PROGRAMS[0], "check", scene(folder, slit.replace("2.5*mm, structured = true", "1*mm")))
    expect(result.returncode == 0, result.stderr)
    expect(re.search(r'warning: .*body "block": cell \d+ near .* is a sliver .* time step is about \d+ times shorter', result.stdout), result.stdout)
    expect(re.search(r" steps, [\d.e-]+ ms each as measured now on this machine: about ", result.stdout), result.stdout)


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
    weak = run(PROGRAMS[0], "check", scene(folder, re.sub(r"young = [^,}]*", "young = 10*MPa", CRACKING), "20*us"))
    expect(re.search(r'warning: .*body "disc": a tensile strength of .* of Young.s modulus.*is a unit missing', weak.stdout), weak.stdout)
    for time, cracks in (("1*us", False), ("60*us", True)):  # said again at the end where joints softened
        for energy, how in (("0.05", "shorter than an edge"), ("0.5", "shorter than three edges")):
            brittle = run(PROGRAMS[0], "run", scene(folder, CRACKING.replace("G1 = 5*J/m2", f"G1 = {energy}*J/m2"), time), "--out", os.path.join(folder, time + energy))
            unresolved = rf'warning: .*body "disc": its process zone .* is {how} .*a mesh.size of '
            expect(re.search(unresolved, brittle.stderr) and bool(re.search(unresolved, brittle.stdout)) == cracks, brittle.stdout + brittle.stderr)
    usual = run(PROGRAMS[0], "check", scene(folder, BLOCK, "20*us"))
    expect("warning" not in usual.stdout, usual.stdout)


def joints_that_hold_more_than_they_take_are_named(folder):
    text = """
local rock = material{ "rock", density = 2700, elastic = { young = 30*GPa, poisson = 0.25 },
                       fracture = { tension = 3*MPa, shear = 10*MPa, G1 = 10.5*J/m2, G2 = ENERGY, penalty = PENALTY } }
body{ "stone", shape = box{ size = { 40*mm, 40*mm, 40*mm } }, mesh = { size = 10*mm }, material = rock }
run{ time = 4*us }
"""
    for program in PROGRAMS:
        for penalty, energy, key in (("2*GPa", "2000", "G1"), ("300*GPa", "2000", None), ("50*GPa", "2", "G2")):
            checked = run(program, "check", scene(folder, text.replace("PENALTY", penalty).replace("ENERGY", energy)))
            named = re.findall(r'warning: .*body "stone": its joints hold about .* and (G\d) is', checked.stdout + checked.stderr)
            expect(named == ([key] if key else []), f"{penalty} {energy}: {checked.stdout}{checked.stderr}")


def friction_that_a_body_lacks_is_named(folder):
    text = """
local rock = material{ "rock", density = 2700, elastic = { young = 30*GPa, poisson = 0.25 } CONTACT }
local stone = body{ "stone", shape = box{ size = { 4*mm, 4*mm, 4*mm } }, mesh = { size = 2*mm }, material = rock }
plate{ "floor", below(stone), contact = { penalty = 30*GPa, friction = FRICTION } }
run{ time = 1*us }
"""
    for program in PROGRAMS:
        for contact, friction, named in (("", "0.5", True), ("", "0", False), (", contact = { penalty = 1*GPa, friction = 0.1 }", "0.5", False)):
            checked = run(program, "check", scene(folder, text.replace("CONTACT", contact).replace("FRICTION", friction)))
            said = re.search(r'warning: .*plate "floor" has friction 0.5, but "stone" touches without', checked.stdout + checked.stderr)
            expect(bool(said) == named, checked.stdout + checked.stderr)


def points_outside_a_body_are_refused(folder):
    text = """
local rock = material{ "rock", density = 2700, elastic = { young = 30*GPa, poisson = 0.25 } }
local stone = body{ "stone", shape = box{ size = { 4*mm, 4*mm, 4*mm } }, mesh = { size = 1*mm }, material = rock, velocity = { 1, 0 } }
measure{ "m", function(now) return ASK end }
output{ fields = { "pressure" } }
run{ time = 1*us }
"""
    asked = ("now.displacement(stone, { AT, 0 }).x", "now.velocity(stone, { AT, 0 }).x", "now.stress(stone, { AT, 0 }).xx", 'now.field("pressure", stone, { AT, 0 })')
    for program in PROGRAMS:
        for ask in asked:
            for at, outside in (("2*mm", False), ("0.3*mm", False), ("2", True), ("-4*mm", True)):
                ran = run(program, "run", scene(folder, text.replace("ASK", ask).replace("AT", at)), "--out", os.path.join(folder, "out"))
                expect((ran.returncode == 2) == outside, f"{ask} {at}: {ran.returncode} {ran.stderr}")
                expect(not outside or re.search(r'scene\.lua:\d+: .*lies outside body "stone"', ran.stderr), ran.stderr)


if __name__ == "__main__":
    sys.exit(cases(globals()))
