#!/usr/bin/python3
"""scripts/study on a bar that rings: its table, order of convergence and advice; and killed at twenty moments it loses and repeats no run.

    check_study.py fissure2d
"""
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

STUDY = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "scripts", "study")
BUILD = os.path.dirname(os.path.dirname(os.path.abspath(sys.argv[1])))
# An eighth of a period of the first mode: half of the energy is elastic. The error is that of the frequency: the square of mesh size and step.
BAR = """
local h = param("h", 5, "element size (mm)")
local steel = material{ "steel", density = 8000, elastic = { young = 200*GPa, poisson = 0 } }
local bar = body{ "bar", shape = box{ size = { 40*mm, 5*mm, 5*mm } }, mesh = { size = h*mm, structured = true }, material = steel,
                  velocity = function(x, y, z) return { math.sin(math.pi/2*(x/(40*mm) + 0.5)), 0, 0 } end }
hold{ bar, at = "left", velocity = { 0, 0, 0 } }
measure{ "share", function(now) return now.energy("elastic")/(now.energy("elastic") + now.energy("kinetic")) end }
run{ time = 4*us }
"""
problems = []


def expect(true, what):
    if not true:
        problems.append(what)


def study(folder, *words, status=0):
    result = subprocess.run([STUDY, "bar.lua", "--programs", BUILD, *words], cwd=folder, capture_output=True, text=True, timeout=600)
    expect(result.returncode == status, f"{words}: status {result.returncode}: {result.stdout[-500:]} {result.stderr[-500:]}")
    return result.stdout + result.stderr


def tells_what_it_should(folder):
    words = ["--vary", "h=5,2.5,1.25,0.625", "--vary", "precision=double,single", "--measure", "share:last", "--set", "run.safety=0.2"]
    said = study(folder, *words)
    order = re.search(r"order of convergence in h at precision=double: ([\d.]+); limit ([\d.]+)", said)
    expect(order and abs(float(order[1]) - 2) < 0.2, said)
    expect(order and abs(float(order[2]) - 0.5) < 1e-4, said)                    # what is left is the step's, a fifth of the limit
    expect(re.search(r"^h=\S+ precision=\S+: \S+ % off for \S+ % of the cell-steps", said, re.M), said)
    record = json.load(open(os.path.join(folder, "bar-study", "study.json")))
    expect(len(record["rows"]) == 8 and all(row["answer"] for row in record["rows"]), record)
    expect(os.path.getsize(os.path.join(folder, "bar-study", "study.png")) > 10000, "no picture")
    again = study(folder, *words)
    expect("8 of 8 runs have finished before" in again and "[1/" not in again, again)
    # The command of a row repeats it.
    row = record["rows"][0]
    expect(subprocess.run(row["command"], shell=True, cwd=folder, capture_output=True).returncode == 0, row["command"])


def varies_keys_and_names_what_fails(folder):
    said = study(folder, "--vary", "run.safety=0.8,0.4", "--vary", "body.mesh.size=*1,*0.5", "--measure", "share", "--out", "keys")
    expect("safety=0.4 size=*0.5" in said and "[4/4]" in said, said)
    said = study(folder, "--vary", "run.dt=1e-8,1e-3", "--measure", "share", "--out", "fails", status=1)
    expect(re.search(r"dt=1e-3 .*do not trust|dt=1e-3 .*failed", said), said)
    said = study(folder, "--vary", "run.saftey=0.8,0.4", "--measure", "share", "--out", "wrong", status=2)
    expect('did you mean "run.safety"' in said and "nothing was run" in said, said)
    said = study(folder, "--vary", "h=5,x", "--measure", "share", "--out", "letters", status=2)
    expect("nothing was run" in said, said)
    said = study(folder, "--vary", "h=5,2.5", "--set", "h=1", "--measure", "share", "--out", "both", status=2)
    expect("varied and --set at once" in said, said)
    said = study(folder, "--vary", "h=5,2.5,1.25", "--measure", "share:last", "--set", "run.safety=0.8", "--reference", "limit", "--out", "none")
    expect("for there is no limit" in said and "no order of convergence in h: the answer does not run to one side" in said, said)
    said = study(folder, "--vary", "h=5,2.5", "--measure", "shares", "--out", "unknown", status=2)
    expect("no measure shares (known: share)" in said, said)
    said = study(folder, "--vary", "h=5,2.5", "--measure", "share", "--out", "array", "--emit", "slurm")
    job = os.path.join(folder, "array", "study.slurm")
    for task in "1", "2":
        expect(subprocess.run(["bash", job], cwd=folder, env=dict(os.environ, SLURM_ARRAY_TASK_ID=task), capture_output=True).returncode == 0, "slurm task")
    said = study(folder, "--vary", "h=5,2.5", "--measure", "share", "--out", "array", "--collect")
    expect(re.search(r"h=2.5 +[\d.]+ ", said), said)


def takes_what_the_scene_says(folder):
    path = os.path.join(folder, "bar.lua")
    with open(path, "a") as file:
        file.write('study{ "share", vary = { "h=10,5" }, of = "last", reference = 0.5, tolerance = 0.5 }\n')
    said = study(folder)
    expect("h=10" in said and "[2/2]" in said and "Reference: 0.5 (given)" in said and "share:last" in said, said)
    said = study(folder, "--vary", "precision=double,single", "--out", "other")  # the command line goes first
    expect("precision=single" in said and "h=10" not in said and "share:last" in said, said)
    with open(path, "w") as file:
        file.write(BAR)
    said = study(folder, "--measure", "share", status=2)
    expect("what to vary" in said, said)
    strange = "it's a:b"                                                          # a name that a shell and the colon of --measure could take apart
    with open(path, "w") as file:
        file.write(BAR.replace('"share"', f'"{strange}"') + f'study{{ "{strange}", vary = {{ "h=10,5" }}, of = "last" }}\n')
    expect(f"{strange}:last" in study(folder, "--out", "strange"), "a strange name")
    said = study(folder, "--reference", "nan", status=2)
    expect("finest, limit, a number" in said, said)


def loses_nothing_when_killed(folder):
    words = [STUDY, "bar.lua", "--programs", BUILD, "--vary", "h=2,1,0.8,0.6", "--vary", "run.safety=0.8,0.5,0.2", "--measure", "share", "--jobs", "2"]
    random.seed(1)
    ended = {}
    for attempt in range(100):
        if attempt >= 20 and len(ended) > 2:
            break
        process = subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        time.sleep(random.uniform(0.05, 2.0 + attempt / 4))  # later on a machine that is busy with other things
        process.send_signal(signal.SIGKILL)
        process.wait()
        time.sleep(0.05)
        for path, _, files in os.walk(os.path.join(folder, "bar-study")):
            if "run.json" in files:
                record = json.load(open(os.path.join(path, "run.json")))
                moment = os.stat(os.path.join(path, "run.json")).st_mtime_ns
                if path in ended:
                    expect(ended[path] == moment, f"{path} was run again")
                elif record["finished"] == "end of time":
                    ended[path] = moment
    expect(len(ended) > 2, f"only {len(ended)} runs ended between kills: nothing is shown")
    said = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=600)
    expect(said.returncode == 0 and said.stdout.count(" ok") >= 12, said.stdout + said.stderr)
    for path, moment in ended.items():
        expect(os.stat(os.path.join(path, "run.json")).st_mtime_ns == moment, f"{path} was run again at the end")


def main():
    for case in tells_what_it_should, varies_keys_and_names_what_fails, takes_what_the_scene_says, loses_nothing_when_killed:
        folder = tempfile.mkdtemp(prefix="fissure-study-")
        with open(os.path.join(folder, "bar.lua"), "w") as file:
            file.write(BAR)
        began = time.time()
        case(folder)
        shutil.rmtree(folder, ignore_errors=True)
        print(f"{case.__name__} ({time.time() - began:.1f} s)", flush=True)
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
