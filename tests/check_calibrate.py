#!/usr/bin/python3
"""scripts/calibrate on a bar that flows: it finds the numbers again that made its targets, loses and repeats no run when it is killed, and says what is wrong.

    check_calibrate.py fissure2d
"""
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

CALIBRATE = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "scripts", "calibrate")
PROGRAM = os.path.abspath(sys.argv[1])
BUILD = os.path.dirname(os.path.dirname(PROGRAM))
# Plane stress of a cube that is pulled by a tenth: its stress at the end is about yield + hardening 0.1, its work the area under that line.
BAR = """
local numbers = require "numbers"
local yield, hardening = param("yield", 200, "(MPa)"), param("hardening", 2, "(GPa)")
local idle = param("idle", 1, "changes nothing")
local metal = material{ "metal", density = 8000, elastic = { young = numbers.young, poisson = 0.3 }, plastic = { yield = yield*MPa, hardening = hardening*GPa } }
local a, v = 10*mm, 2
local cube = body{ "cube", shape = box{ size = { a, a, a } }, mesh = { size = a/2, structured = true }, material = metal,
                   velocity = function(x, y) return { 0, v*(y/a + 0.5), 0 } end }
hold{ cube, at = "bottom", velocity = { nil, 0 } }
hold{ cube, at = "top", velocity = { nil, v } }
assume{ two_d = "plane stress", thickness = a }
measure{ "pull", unit = "MPa", function(now) return now.stress(cube, { 0, 0 }).yy/MPa end }
measure{ "work", unit = "J", function(now) return now.energy("plastic") end }
output{ measure_every = 5*us }
run{ time = 0.1*a/v }
"""
problems = []


def expect(true, what):
    if not true:
        problems.append(what)


def calibrate(folder, *words, status=0):
    result = subprocess.run([CALIBRATE, "bar.lua", "--programs", BUILD, *words], cwd=folder, capture_output=True, text=True, timeout=600)
    expect(result.returncode == status, f"{words}: status {result.returncode}: {result.stdout[-800:]} {result.stderr[-500:]}")
    return result.stdout + result.stderr


def targets_of(folder, yielded, hardening):
    out = os.path.join(folder, "truth")
    subprocess.run([PROGRAM, "run", "bar.lua", "--quiet", "--out", out, "--set", f"yield={yielded}", "--set", f"hardening={hardening}"],
                   cwd=folder, check=True, capture_output=True)
    rows = [line.split(",") for line in open(os.path.join(out, "history.csv"))]
    peak = lambda column: max(float(row[column]) for row in rows[1:])
    return ["--target", f"pull={peak(1)}", "--target", f"work:last={float(rows[-1][2])}"]


def finds_the_numbers_again(folder, targets):
    said = calibrate(folder, *targets, "--vary", "yield=50..1000,hardening")
    record = json.load(open(os.path.join(folder, "bar-calibration", "calibration.json")))
    for name, truth in (("yield", 320), ("hardening", 0.8)):
        found = record["parameters"][name]
        expect(abs(found["value"] / truth - 1) < 0.01, f"{name}: {found}")       # ends when steps are a thousandth; the targets have no noise
        expect(found["interval"][0] < truth < found["interval"][1], f"{name}: {found}")
    # Both raise both targets: what one is too large the other is too small.
    expect(record["correlation"]["matrix"][0][1] < -0.5, record)
    lua = open(os.path.join(folder, "bar-calibration", "calibration.lua")).read()
    expect(re.search(r'^  \["yield"\] = 3(1|2)\d', lua, re.M), lua)
    again = calibrate(folder, *targets, "--vary", "yield=50..1000,hardening")
    expect(f"{record['runs']} runs are known from before" in again and "[1]" not in again, again)
    return said


def goes_on_after_a_kill(folder, targets):
    words = [CALIBRATE, "bar.lua", "--programs", BUILD, "--jobs", "1", "--out", "killed", *targets, "--vary", "yield=50..1000,hardening"]
    path = os.path.join(folder, "killed", "runs.jsonl")
    search = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while search.poll() is None and (not os.path.exists(path) or open(path).read().count("\n") < 4):
        time.sleep(0.01)
    search.send_signal(signal.SIGKILL)
    search.wait()
    known = open(path).read().count("\n")
    with open(path, "a") as file:
        file.write('{"of": "half a li')                                       # as a kill may leave it
    said = calibrate(folder, "--jobs", "1", "--out", "killed", *targets, "--vary", "yield=50..1000,hardening")
    expect(f"{known} runs are known from before" in said, said)
    keys = [json.loads(line)["key"] for line in open(path) if line.endswith("}\n") and not line.startswith('{"of": "half')]
    expect(len(keys) == len(set(keys)), "a run was repeated")
    # Another module, other answers: what was known does not count.
    with open(os.path.join(folder, "numbers.lua"), "w") as file:
        file.write("return { young = 100*GPa }\n")
    said = calibrate(folder, "--out", "killed", "--runs", "4", *targets, "--vary", "yield=50..1000,hardening", status=1)
    expect("known from before" not in said and "not yet at the end after 4 runs" in said, said)


def says_what_is_wrong(folder, targets):
    for words, told in (
        (["--target", "pul=1", "--vary", "yield"], r'no measure pul \(known: pull, work\); did you mean "pull"\?'),
        ([*targets, "--vary", "yeild"], r'no such parameter \(known: yield, hardening, idle\); did you mean "yield"\?'),
        ([*targets, "--vary", "yield,material.elastic.young"], r"a key of a table needs its range"),
        ([*targets, "--vary", "yield=3..2"], r"a number above 0 to a larger one"),
        (["--target", "pull=1", "--vary", "yield,hardening"], r"2 parameters cannot be told from 1 target:"),
        (["--target", "pull=3*MPa", "--vary", "yield"], r'"3\*MPa" is not a number'),
        (["--target", "pull=0", "--vary", "yield"], r"a target of 0 needs its error"),
        ([*targets, "--vary", "yield", "--set", "yield=3"], r"yield is varied and --set at once"),
        ([*targets, "--vary", "yield", "--set", "hardning=3"], r'did you mean "hardening"\?'),
    ):
        said = calibrate(folder, *words, status=2)
        expect(re.search(told, said), f"{words}: {said}")
    said = calibrate(folder, *targets, "--vary", "yield,idle", status=1)
    expect(re.search(r"idle = 1  \(the targets do not tell\)", said) and re.search(r"yield = \S+  \(\S+ to \S+\)", said), said)


def main():
    with tempfile.TemporaryDirectory() as folder:
        for name, text in (("bar.lua", BAR), ("numbers.lua", "return { young = 200*GPa }\n")):
            with open(os.path.join(folder, name), "w") as file:
                file.write(text)
        targets = targets_of(folder, 320, 0.8)
        finds_the_numbers_again(folder, targets)
        says_what_is_wrong(folder, targets)
        goes_on_after_a_kill(folder, targets)
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{len(problems)} problems")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
