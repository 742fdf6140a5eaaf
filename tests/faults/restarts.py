#!/usr/bin/env python3
"""Stopping, killing and going on: nothing is lost, and the bits are the same.

    restarts.py fissure2d fissure3d [case ...]
"""
import json
import os
import re
import signal
import struct
import subprocess
import sys
import time

from rig import (cases, BLOCK, CRACKING, DIMENSION, ELASTIC, PROGRAMS, expect, expect_error, interrupted_at,
                 numbers_of, run, scene, unhurried)


# Most joints break between 10 and 30 us.
BREAKING = unhurried(CRACKING.replace("every = 10*us, checkpoint_every = 20*us", "every = 5*us, checkpoint_every = 8*us"))


def ctrl_c_leaves_a_run_to_go_on_from(folder):
    path = scene(folder, BREAKING, "26*us")
    whole, broken = os.path.join(folder, "whole"), os.path.join(folder, "broken")
    for dimension, program in DIMENSION.items():
        a, b = whole + str(dimension), broken + str(dimension)
        expect(run(program, "run", path, "--out", a, "--threads", "1").returncode == 0, "the whole run failed")
        status = interrupted_at("000004.h5", program, path, b, "1", signal.SIGINT)
        expect(status == 130, f"exit status {status}")
        expect('"finished": "interrupted"' in open(os.path.join(b, "run.json")).read(), "run.json does not say that it was interrupted")
        result = run(program, "restart", b, "--threads", "2")
        expect(result.returncode == 0, result.stderr)
        compare(numbers_of(a), numbers_of(b), f"{dimension}D after Ctrl-C and restart")


def a_signal_sent_twice_loses_no_checkpoint(folder):
    path, out = scene(folder, unhurried(CRACKING), "50*us"), os.path.join(folder, "out")
    process = subprocess.Popen([PROGRAMS[0], "run", path, "--out", out, "--threads", "1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and not os.path.exists(os.path.join(out, "frames", "000001.h5")):
        time.sleep(0.005)
    process.send_signal(signal.SIGTERM)
    process.send_signal(signal.SIGTERM)
    expect(process.wait(timeout=300) == 130 and os.path.exists(os.path.join(out, "checkpoint.bin")), f"status {process.returncode}")
    os.remove(os.path.join(out, "checkpoint.bin"))
    expect_error(run(PROGRAMS[0], "restart", out), r"no checkpoint has been written there; output\{ checkpoint_every = ")


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


def what_was_taken_away_is_named(folder):
    """Rows of the history and frames that are gone when a run goes on, and times that are none."""
    path = scene(folder, BREAKING, "26*us")
    out = os.path.join(folder, "out")
    program = PROGRAMS[0]
    expect(interrupted_at("000004.h5", program, path, out, "1", signal.SIGINT) == 130, "not interrupted")
    for moment in "-1", "0", "nan", "inf", "soon":
        expect_error(run(program, "restart", out, "--time", moment), f"--time: {moment} is no time after 0")
    frames, history = os.path.join(out, "frames"), os.path.join(out, "history.csv")
    for name, reason in (("mesh.h5", "mesh.h5: "),
                         ("000002.h5", "000002.h5: is missing, and later frames are there; put it back")):
        os.rename(os.path.join(frames, name), os.path.join(folder, name))
        expect_error(run(program, "restart", out), reason)
        os.rename(os.path.join(folder, name), os.path.join(frames, name))
    os.rename(history, history + "_")
    expect_error(run(program, "restart", out), r"history.csv: ")
    rows = open(history + "_").readlines()
    open(history, "w").writelines(rows[:4] + [rows[5], rows[4]] + rows[6:])
    expect_error(run(program, "restart", out), r"history.csv:6: its time, \S+ s, is not after that of the row before")
    open(history, "w").writelines(rows[:5] + rows[7:])
    result = run(program, "restart", out)
    told = re.search(r"2 of the \d+ rows of the history written before the checkpoint", result.stderr)
    expect(result.returncode == 0 and told, result.stderr)


def a_restart_knows_what_the_run_read(folder):
    """From any folder; goes on with the modules it began with, also when they have changed or gone; refused when a row of history is damaged."""
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
        result = restart("1.3e-5")
        expect(result.returncode == 0 and "lib.lua has changed since" in result.stderr, result.stderr)
        with open(os.path.join(place, "out", "run.json")) as file:
            expect("200e9" in json.load(file)["scene"]["modules"]["lib"], "run.json has the module of the start")
        os.remove(module)
        result = restart("1.35e-5")
        expect(result.returncode == 0 and "changed" not in result.stderr, result.stderr)
        write("200e9")
        rows = list(open(os.path.join(place, "out", "history.csv")))
        for damage in ("garbage\n", rows[5].replace(",", ",12x,", 1), ",".join(rows[5].split(",")[:3]) + "\n", rows[5].split(",")[0] + "x," + rows[5].split(",", 1)[1]):
            with open(os.path.join(place, "out", "history.csv"), "w") as file:
                file.writelines(rows[:5] + [damage] + rows[6:])
            expect_error(restart("1.4e-5"), "history.csv:6: this row cannot be read")
        with open(os.path.join(place, "out", "history.csv"), "w") as file:
            file.writelines(rows)
        expect(restart("1.4e-5").returncode == 0, "a mended history is not taken")


def kill_leaves_a_run_to_go_on_from(folder):
    path = scene(folder, BREAKING, "26*us")
    for dimension, program in DIMENSION.items():
        a, b = os.path.join(folder, f"a{dimension}"), os.path.join(folder, f"b{dimension}")
        expect(run(program, "run", path, "--out", a, "--threads", "2").returncode == 0, "the whole run failed")
        status = interrupted_at("000003.h5", program, path, b, "2", signal.SIGKILL)
        expect(status == -signal.SIGKILL, f"exit status {status}")
        result = run(program, "restart", b, "--threads", "1")
        expect(result.returncode == 0, result.stderr)
        compare(numbers_of(a), numbers_of(b), f"{dimension}D after a kill and restart")


def what_was_excavated_stays_away(folder):
    """One part leaves before the run is stopped, one after it has gone on."""
    dig = "".join(f"excavate{{ disc, time = {t}*us, within = function(x, y) return {where} end }}\n"
                  for t, where in ((12, "x > 7*mm"), (22, "x < -7*mm")))
    path = scene(folder, BREAKING.replace("run{ time", dig + "run{ time"), "30*us")
    for dimension, program in DIMENSION.items():
        a, b = os.path.join(folder, f"a{dimension}"), os.path.join(folder, f"b{dimension}")
        expect(run(program, "run", path, "--out", a, "--threads", "1").returncode == 0, "the whole run failed")
        expect(interrupted_at("000004.h5", program, path, b, "1", signal.SIGINT) == 130, "not interrupted")
        result = run(program, "restart", b, "--threads", "2")
        expect(result.returncode == 0, result.stderr)
        compare(numbers_of(a), numbers_of(b), f"{dimension}D after Ctrl-C and restart")
        rows = open(os.path.join(a, "history.csv")).read().splitlines()
        at = rows[0].split(",").index("energy excavated [J]")
        expect(len({row.split(",")[at] for row in rows[1:]}) == 3, "not two parts left")


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
        path = scene(folder, CRACKING.replace("2.5*mm", "1.2*mm" if dimension == 2 else "1.7*mm"), "20*us")
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
        (without_values(good, b"runner"), r'the checkpoint\'s "runner" is damaged'),
    ]:
        open(checkpoint, "wb").write(bad)
        expect_error(run(PROGRAMS[0], "restart", out), pattern)
    open(checkpoint, "wb").write(good)
    expect_error(run(PROGRAMS[1], "restart", out), r"the checkpoint was written by fissure2d; restart it with that program\?")
    os.remove(checkpoint)
    expect_error(run(PROGRAMS[0], "restart", out), r"no checkpoint has been written there")


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


FLOWING = CRACKING.replace("fracture = {", """plastic = { law = "johnson_cook", A = 40*MPa, B = 20*MPa, n = 0.3, C = 0.01, pressure = "averaged",
  heat = { capacity = 800 } }, fracture = {""")


def flow_beside_fracture_gives_the_same_bits_and_goes_on(folder):
    for dimension, program in DIMENSION.items():  # enough elements for two threads to share them
        path = scene(folder, unhurried(FLOWING.replace("2.5*mm", "1.2*mm" if dimension == 2 else "1.6*mm").replace("every = 10*us", "every = 4*us")
                                       .replace("checkpoint_every = 20*us", "checkpoint_every = 6*us")), "16*us", f"scene{dimension}.lua")
        same_bits_and_goes_on(folder, dimension, program, path, "energy plastic [J]")


if __name__ == "__main__":
    sys.exit(cases(globals()))
