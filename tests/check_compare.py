#!/usr/bin/python3
"""Compares a tiny scene in 2D and 3D and checks what comes out: the table against numbers taken from both histories by other
means, the picture, the exit status, and what is said when something is wrong.

    check_compare.py FISSURE2D FISSURE3D
"""
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image

COMPARE = pathlib.Path(__file__).parent.parent / "scripts" / "compare"
SCENE = """
local v = param("speed", 1, "speed of the floor (m/s)")
local steel = material{ "steel", density = 7800, elastic = { young = 200*GPa, poisson = 0.3 } }
local block = body{ "block", shape = box{ size = { 10*mm, 10*mm, 10*mm } }, mesh = { size = 5*mm, structured = true }, material = steel }
local floor = plate{ "floor", below(block), velocity = { 0, v } }
measure{ "load", unit = "N", function(now) return now.force(floor) end }
measure{ "lift", unit = "m", function(now) return v*now.time end }
measure{ "height", unit = "m", function(now) return now.size(block).y end }
if dim == 3 then measure{ "depth", unit = "m", function(now) return now.size(block).z end } end
measure{ "sway", function(now) return 1.5*math.sin(now.time/us) - now.time/us end }   -- falls, and turns back on its way
plot{ "load", against = "lift" }
plot{ "load", against = "sway" }
output{ measure_every = dim == 2 and 0.1*us or 0.13*us }
run{ time = dim == 2 and 10*us or 8*us }
"""
problems = []


def expect(condition, what):
    if not condition:
        problems.append(what)


def compare(*words):
    return subprocess.run([sys.executable, COMPARE, *map(str, words), "--threads", "1"], capture_output=True, text=True)


def expect_refusal(done, status, *said):
    expect(done.returncode == status, f"status {done.returncode}, expected {status}: {done.stderr}")
    for text in said:
        expect(text in done.stderr, f'"{text}" is not in: {done.stderr}')
    expect("Traceback" not in done.stderr, done.stderr)


def history(folder):
    with open(folder / "history.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return {title.rpartition(" [")[0]: [float(row[i]) for row in rows[1:]] for i, title in enumerate(rows[0])}


def sooner(xs, ys):
    """What x and y were whenever x went lower than ever before, with x turned upward."""
    lowest, found = float("inf"), []
    for x, y in zip(xs, ys):
        if x < lowest:
            lowest = x
            found.append((-x, y))
    return [x for x, _ in found], [y for _, y in found]


def value_at(x, xs, ys):
    """Linear between samples; xs grows."""
    i = next(i for i in range(1, len(xs)) if xs[i] >= x)
    return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1])


def check_numbers(out):
    """The table of a comparison that went well, number by number."""
    with open(out / "compare.csv", newline="", encoding="utf-8") as file:
        table = {(row["measure"], row["against"], row["quantity"]): row for row in csv.DictReader(file)}
    two, three = history(out / "2D"), history(out / "3D")

    def expect_row(key, expected_two, expected_three, unit):
        row = table.get(key)
        if row is None:
            problems.append(f"compare.csv has no {key}")
            return
        expect(row["unit"] == unit, f"{key} has the unit {row['unit']}, expected {unit}")
        for name, expected in (("2D", expected_two), ("3D", expected_three)):
            if expected is None:
                expect(row[name] == "", f"{key}, {name}: {row[name]} where nothing should be")
            else:
                expect(abs(float(row[name] or "nan") - expected) <= 1e-9 * abs(expected) + 1e-30, f"{key}, {name}: {row[name]}, expected {expected:.12g}")

    expect_row(("", "", "elements"), 8, 48, "")
    expect_row(("", "", "expectations missed"), 0, 0, "")
    for measure, against, unit, x_unit in (("load", "lift", "N", "m"), ("load", "sway", "N", ""), ("height", "time", "m", "s")):
        ends, peaks, places = [], [], []
        for run in (two, three):
            size, place = max((abs(y), -i) for i, y in enumerate(run[measure]))
            ends.append(run[measure][-1]), peaks.append(size), places.append(run[against][-place])
        (x2, y2), (x3, y3) = (sooner(run[against], run[measure]) if against == "sway" else (run[against], run[measure]) for run in (two, three))
        xs = sorted({x for x in x2 + x3 if x <= min(x2[-1], x3[-1])})
        pairs = [(value_at(x, x2, y2), value_at(x, x3, y3)) for x in xs]
        share = max(abs(a - b) for a, b in pairs) / max(max(abs(a), abs(b)) for a, b in pairs)
        expect(share > 1e-6, f"{measure}: 2D and 3D are the same; this scene shows nothing")
        expect_row((measure, against, "final"), *ends, unit)
        expect_row((measure, against, "peak"), *peaks, unit)
        expect_row((measure, against, f"peak at {against}"), *places, x_unit)
        expect_row((measure, against, "largest difference from 2D"), None, 100 * share, "%")
    expect(not any(key[0] == "depth" for key in table), "depth is measured in 3D only, yet compared")

    for name in ("2D", "3D"):
        with open(out / name / "run.json", encoding="utf-8") as file:
            record = json.load(file)
        expect(int(table["", "", "steps"][name]) == record["steps"] > 0, f"{name}: steps")
        wall, stepping, busy, memory = (
            float(table["", "", quantity][name]) for quantity in ("wall clock", "of it in steps", "processor time", "peak memory"))
        expect(0 < stepping == record["wall seconds"] < wall, f"{name}: wall clock {wall}, in steps {stepping}")
        expect(0 < busy < 1.5 * wall, f"{name}: one thread was busy for {busy} s of {wall}")
        expect(15 < memory < 1000, f"{name}: {memory} MB")
    with open(out / "compare.json", encoding="utf-8") as file:
        record = json.load(file)
    expect([variant["name"] for variant in record["variants"]] == ["2D", "3D"], "compare.json names other variants")
    load = next(row for row in record["table"] if row["quantity"] == "peak" and row["measure"] == "load")
    expect(f"{load['values']['3D']:.9g}" == f"{max(three['load']):.9g}", "compare.json and history.csv differ")


def check_picture(path):
    with Image.open(path) as image:
        pixels = np.asarray(image.convert("RGB"), float)
    expect(min(pixels.shape[:2]) > 200 and pixels.std() > 5, f"{path.name} shows nothing: {pixels.shape}, contrast {pixels.std():.1f}")
    for name, colour in (("2D", (0x00, 0x72, 0xB2)), ("3D", (0xD5, 0x5E, 0x00))):
        drawn = int((np.abs(pixels - colour).max(axis=2) < 8).sum())
        expect(drawn > 200, f"{path.name} has {drawn} pixels in the colour of {name}")


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        build = place / "build"
        for program in sys.argv[1:]:
            folder = build / ("src" + program[-2:])
            folder.mkdir(parents=True)
            (folder / os.path.basename(program)).symlink_to(os.path.abspath(program))

        def scene(name, more="", text=SCENE):
            path = place / f"{name}.lua"
            path.write_text(text + more, encoding="utf-8")
            return path

        programs = ("--programs", build)
        tiny, out = scene("tiny"), place / "out"
        done = compare(tiny, *programs, "--out", out)
        expect(done.returncode == 0, f"status {done.returncode}: {done.stderr}")
        if done.returncode == 0:
            expect("load over lift" in done.stdout and "largest difference from 2D" in done.stdout, f"printed: {done.stdout}")
            check_numbers(out)
            check_picture(out / "compare.png")

        before = (out / "compare.csv").read_bytes()
        expect_refusal(compare(tiny, *programs, "--out", out), 2, "there already")
        expect((out / "compare.csv").read_bytes() == before, "an existing folder was changed")

        fast = compare(tiny, *programs, "--out", place / "three", "--set", "speed=2", "--variant", "slow one: 2d --set speed=1",
                       "--variant", "2D: 2d", "--variant", "3D: 3d")
        expect(fast.returncode == 0, f"three variants: status {fast.returncode}: {fast.stderr}")
        if fast.returncode == 0:
            lift = [history(place / "three" / name)["lift"][-1] / history(place / "three" / name)["time"][-1] for name in ("slow-one", "2D", "3D")]
            expect(np.allclose(lift, (1, 2, 2)), f"speeds of three variants: {lift}")

        missed = compare(scene("missed", 'expect{ "no load", value = function(now) return now.peak("load") end, within = { 0, 1 }, why = "a test" }'),
                         *programs, "--out", place / "missed")
        expect(missed.returncode == 1 and "3D missed its expectation: no load" in missed.stdout, f"missed: {missed.returncode}: {missed.stdout}{missed.stderr}")

        # What is refused before anything runs leaves no folder.
        for words, status, said in (
                ((place / "nowhere.lua",), 2, ("nowhere.lua", "cannot read the scene")),
                ((tiny, "--set", "sped=1"), 2, ('did you mean "speed"', "nothing was run")),
                ((tiny, "--variant", "a: 2d", "--variant", "b: 3d --set sped=1"), 2, ('did you mean "speed"', "b: ")),
                ((tiny, "--variant", "alone: 2d"), 2, ("one variant alone",)),
                ((tiny, "--variant", "a: 2d", "--variant", "a: 3d"), 2, ("share the name",)),
                ((tiny, "--variant", "a: 2d", "--variant", "b: 4d"), 2, ("4d",)),
                ((tiny, "--variant", "2d", "--variant", "b: 3d"), 2, ("NAME",)),
                ((tiny, "--programs", place / "unbuilt"), 2, ("there is no program", "--target fissure2d"))):
            expect_refusal(compare(*(programs if "--programs" not in words else ()), *words, "--out", place / "refused"), status, *said)
            expect(not (place / "refused").exists(), f"{words}: left a folder")

        broken = scene("broken", 'measure{ "odd", function(now) return now.time > 4*us and dim == 3 and nothing.at_all or 0 end }')
        expect_refusal(compare(broken, *programs, "--out", place / "broken"), 2, "broken.lua:", "3D: the run ended with status 2", str(place / "broken" / "3D"))
        expect((place / "broken" / "3D" / "history.csv").exists(), "what the failed run left is gone")

        strange = SCENE[:SCENE.index("measure{")] + 'measure{ "in" .. dim .. "d", function(now) return now.time end }\nrun{ time = 1*us }'
        expect_refusal(compare(scene("strange", text=strange), *programs, "--out", place / "strange"), 2, "no two runs have a measure in common")

    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
