#!/usr/bin/env python3
"""Scenes at the ends of what can be asked: each must give the right answer or a clear refusal, in 2D and 3D, in double and single precision.

    extremes.py FISSURE2D FISSURE3D [--long] [--table PAGE] [NAME ...]

A scene of tests/extremes says in its first lines

    -- asked: in words
    -- vary: NAME=A,B,C            the number that is taken to its ends
    -- long: NAME=A,B              ends that take minutes: only with --long
    -- outcome [WHEN ...]: WHAT    for runs that are not "ok": the verdict, with reasons that it must have (of "do not trust" no numbers are
                                   asked), or "refused: words";
                                   WHEN: 2d, 3d, double, single, NAME=A; the last line that fits counts
    -- limit: what sets the limits

and what must come out with expect{}. --table writes the page from what came out. Exit status: 0: all as said; 1: not.
"""
import argparse
import concurrent.futures
import glob
import json
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
FOLDER = os.path.join(HERE, "extremes")
PAGE = os.path.join(os.path.dirname(HERE), "docs", "extremes.md")


class Extreme:
    def __init__(self, path):
        self.path, self.name = path, os.path.splitext(os.path.basename(path))[0]
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        self.asked, self.limit = self.line("asked"), self.line("limit")
        self.parameter, _, values = self.line("vary").partition("=")
        self.values = values.split(",")
        _, _, slow = self.line("long", "").partition("=")
        self.slow = slow.split(",") if slow else []
        self.outcomes = re.findall(r"^-- outcome ?(.*?): (.*)$", self.text, re.M)

    def line(self, key, default=None):
        found = re.search(rf"^-- {key}: (.*)$", self.text, re.M)
        if not found and default is None:
            sys.exit(f"{self.path}: no line '-- {key}: ...'")
        return found[1] if found else default

    def outcome(self, dimension, precision, value):
        here = {f"{dimension}d", precision, f"{self.parameter}={value}"}
        return [what for when, what in self.outcomes if set(when.split()) <= here][-1:] or ["ok"]


def run(program, extreme, dimension, precision, value):
    """Runs one; returns (what came out in words for the table, what is wrong or None)."""
    wanted = extreme.outcome(dimension, precision, value)[0]
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out")
        words = [program, "run", extreme.path, "--set", f"{extreme.parameter}={value}", "--precision", precision, "--threads", "1", "--out", out, "--quiet"]
        result = subprocess.run(words, capture_output=True, text=True, errors="replace", timeout=3600)
        said = result.stdout + result.stderr
        if wanted.startswith("refused: "):
            message = wanted.removeprefix("refused: ")
            refused = result.returncode in (1, 2) and message in said
            return f"refused: {message}", None if refused else f"status {result.returncode}, not {wanted!r}: {said[-400:]}"
        try:
            with open(os.path.join(out, "run.json"), encoding="utf-8") as file:
                record = json.load(file)
        except OSError:
            return "-", f"status {result.returncode}: {said[-400:]}"
    reasons = ", ".join(dict.fromkeys(reason["what"] for reason in record["verdict"]["reasons"]))
    verdict = record["verdict"]["grade"] + (": " + reasons if reasons else "")
    numbers = ", ".join(f"{e['value']:.4g}" for e in record["expectations"])
    wrong = [f"{e['name']} = {e['value']:.6g}, wanted {e['least']:.6g} to {e['most']:.6g}" for e in record["expectations"]
             if not e["passed"] and not wanted.startswith("do not trust")]
    grade, _, known = wanted.partition(": ")
    if record["verdict"]["grade"] != grade or not set(known.split(", ") if known else []) <= set(reasons.split(", ")):
        wrong.append(f"{verdict}, wanted {wanted}")
    if not record["expectations"]:
        wrong.append("no expectation")
    return numbers + ("" if verdict == "ok" else f" ({verdict})"), "; ".join(wrong) or None


def write_page(extremes, rows, path):
    lines = ["# The extremes", "",
             "Made by `tests/extremes.py` from its own runs; do not edit. Each section is a scene of `tests/extremes` with one number taken to its ends, in both",
             "dimensions and precisions. Numbers are what came out, in the order of *asked of it*, where the bounds are; a verdict other than ok and refusals are in words.", ""]
    for extreme in extremes:
        lines += [f"## {extreme.name.replace('_', ' ').capitalize()}", "", f"{extreme.asked[0].upper()}{extreme.asked[1:]}.", ""]
        lines += [f"*Asked of it:* {'; '.join(rows[extreme.name]['expected'])}.", "", f"*What limits it:* {extreme.limit}.", ""]
        lines += [f"| {extreme.parameter} | 2D double | 2D single | 3D double | 3D single |", "|---|---|---|---|---|"]
        lines += ["| " + " | ".join([value, *cells]) + " |" for value, cells in rows[extreme.name]["values"].items()]
        lines.append("")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(lines).rstrip() + "\n")


def expected(extreme):
    """What the scene expects, as it says: name and bounds."""
    found = []
    for block in re.findall(r"^expect\{(.*?)\}$", extreme.text, re.M | re.S):
        name = re.match(r'\s*"([^"]*)"', block)[1]
        why = re.search(r'why = "([^"]*)"', block)[1]
        equals = re.search(r"equals = (.+?), tolerance = (.+?),", block)
        bounds = re.search(r"within = \{ ([^,]+), ([^}]+?) \}", block)
        found.append(f"{name}, {equals[1]} to within {equals[2]}" if equals else f"{name}, {bounds[1]} to {bounds[2]}")
        found[-1] += f" ({why})"
    return found


def missing_from_page(extremes):
    """Scenes and ends that the page does not have."""
    try:
        with open(PAGE, encoding="utf-8") as file:
            sections = dict(re.findall(r"^## (.*)\n([\s\S]*?)(?=^## |\Z)", file.read(), re.M))
    except OSError:
        return ["all"]
    return [f"{extreme.name} {value}" for extreme in extremes for value in extreme.values + extreme.slow
            if f"\n| {value} |" not in sections.get(extreme.name.replace("_", " ").capitalize(), "")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs=2)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--table", metavar="PAGE")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    asked = parser.parse_args()
    extremes = [Extreme(path) for path in sorted(glob.glob(os.path.join(FOLDER, "*.lua")))]
    problems = [] if asked.table or asked.names else [f"docs/extremes.md lacks {what}" for what in missing_from_page(extremes)]
    extremes = [extreme for extreme in extremes if not asked.names or extreme.name in asked.names]
    rows = {extreme.name: {"expected": expected(extreme), "values": {}} for extreme in extremes}
    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        jobs = [(extreme, value, dimension, precision,
                 pool.submit(run, os.path.abspath(asked.programs[dimension - 2]), extreme, dimension, precision, value))
                for extreme in extremes for value in extreme.values + (extreme.slow if asked.long else [])
                for dimension in (2, 3) for precision in ("double", "single")]
        for extreme, value, dimension, precision, job in jobs:
            said, wrong = job.result()
            rows[extreme.name]["values"].setdefault(value, []).append(said)
            print(f"{'FAILED' if wrong else 'ok    '} {extreme.name} {extreme.parameter}={value} {dimension}D {precision}: {wrong or said}", flush=True)
            if wrong:
                problems.append(f"{extreme.name} {value} {dimension}D {precision}: {wrong}")
    if asked.table and not problems:
        write_page(extremes, rows, asked.table)
    print(f"{len(jobs)} runs, {len(problems)} not as said")
    for problem in problems[:40]:
        print(f"  {problem}")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
