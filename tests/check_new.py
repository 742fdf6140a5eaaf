#!/usr/bin/python3
"""Starting scenes and what the programs say of themselves: check_new.py FISSURE2D FISSURE3D

`new` lists, writes, refuses; each scene that it writes passes `check` in both dimensions and runs: to its end in 2D, and in 3D where that takes seconds. Then what is
printed without a command, --version, the manual page and completion.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts" / "python"))
import fissure

PROGRAMS = {2: os.path.abspath(sys.argv[1]), 3: os.path.abspath(sys.argv[2])}
KINDS = sorted(path.stem for path in (ROOT / "examples/start").glob("*.lua"))
LONG_IN_3D = {"bend", "brazilian", "ring"}  # 10 to 30 s of one core: there a tenth of the time
problems = []


def expect(true, what):
    if not true:
        problems.append(what)
        print("FAILED", what, flush=True)


def said(dimension, *words, status=0, folder=None):
    done = subprocess.run([PROGRAMS[dimension], *words], capture_output=True, text=True, cwd=folder, check=False)
    expect(done.returncode == status, f"{words}: status {done.returncode}, not {status}: {done.stdout[-300:]}{done.stderr[-300:]}")
    return done.stdout + done.stderr


def writes_and_refuses(folder):
    listed = said(2, "new")
    expect(re.findall(r"^  (\w+)  +\S", listed, re.M) == KINDS, listed)
    for kind in KINDS:
        said(2 + (kind == KINDS[0]), "new", kind, folder=folder)
        expect((folder / f"{kind}.lua").read_text() == (ROOT / "examples/start" / f"{kind}.lua").read_text(), f"{kind}.lua is another")
    (folder / "bend.lua").write_text("mine")
    text = said(2, "new", "bend", status=2, folder=folder)
    expect("bend.lua is there already" in text and (folder / "bend.lua").read_text() == "mine", text)
    said(2, "new", "bend", "other.lua", folder=folder)
    expect((folder / "other.lua").read_text() == (ROOT / "examples/start/bend.lua").read_text(), "another name")
    expect('did you mean "brazilian"?' in said(2, "new", "brasilian", status=2), "nearest kind")
    expect("cannot be written" in said(2, "new", "bend", folder / "none" / "bend.lua", status=2), "a folder that is not there")


def runs(folder):
    os.environ["FISSURE_PROGRAMS"] = str(folder)
    for program in PROGRAMS.values():
        os.symlink(program, folder / os.path.basename(program))
    for kind in KINDS:
        scene = ROOT / "examples/start" / f"{kind}.lua"
        for dimension in (2, 3):
            expect("verdict as far" in fissure.check(scene, dimension, threads=1), f"check of {kind}")
            short = dimension == 3 and kind in LONG_IN_3D
            run = fissure.run(scene, dimension, {"run.time": "*0.1"} if short else {}, threads=1, out=folder / "run")
            print(f"{kind} {dimension}D: {run.record['processor seconds']:.1f} s, {run.verdict}", flush=True)
            expect(run.finished == "end of time" if short else run.ok and run.verdict.grade == "ok", f"{kind} in {dimension}D: {run}, {run.expectations}")
            expect(run.record["plots"] and len(run.frames) > 1 and run.frames[-1].fields, f"{kind} in {dimension}D has nothing to look at")


def pages(folder):
    for dimension in (2, 3):
        name = f"fissure{dimension}d"
        commands = re.findall(r"^  (\w+)  +\S", said(dimension, "--help").partition("Subcommands:")[2].partition("\n\n")[0], re.M)
        alone = said(dimension, status=2)
        expect("new" in commands and all(word in alone for word in [*commands, f"{name} new", "Exit status"]), alone)
        version = said(dimension, "--version")
        for line in (rf"^{name} \d+\.\d+\.\d+$", r"^compiler +\w+ \d+", r"^kernels +-O", r"^precision +double and single", r"^cuda +\S", r"^meshes +\S"):
            expect(re.search(line, version, re.M), f"no {line} in {version}")
        manual = said(dimension, "reference", "--manual")
        for command in commands:
            options = re.findall(r"(--[\w-]+)", re.sub(r"(?s).*\nOptions:", "", said(dimension, command, "--help").partition("\nBegin")[0]))
            for word in [f".SS {command}\n", *(f"\\fB{o}\\fR".replace("-", "\\-") for o in options if o != "--help" and command != "compare")]:
                expect(word in manual, f"{word} is not in the manual of {name}")
        if shutil.which("groff"):
            warned = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z"], input=manual, capture_output=True, text=True, check=False).stderr
            expect(not warned, warned)
        completion = folder / f"{name}.bash"
        completion.write_text(said(dimension, "reference", "--completion"))
        for typed, wanted in ((["ne"], {"new"}), (["new", "b"], {"bar", "bend", "brazilian"}), (["run", "--pre"], {"--precision"}),
                              (["run", "--backend", "c"], {"cpu", "cuda"}), (["--field", "pl"], {"plastic_strain", "plastic_rate"}), (["check", str(ROOT / "examples/start/bend.lua"), "--set", "s"], {"size=", "speed="}),
                              (["run", str(ROOT / "examples/start/be")], {str(ROOT / "examples/start/bend.lua")})):
            function = "_fissure_plot" if typed[0] == "--field" else f"_{name}"
            shell = f'compopt() {{ :; }}; source {completion}; COMP_WORDS=({name} {" ".join(typed)}); COMP_CWORD={len(typed)}; {function}; printf "%s\\n" "${{COMPREPLY[@]}}"'
            path = os.path.dirname(PROGRAMS[dimension]) + ":" + os.environ["PATH"]
            found = subprocess.run(["bash", "-c", shell], capture_output=True, text=True, check=False, env={**os.environ, "PATH": path})
            expect(set(found.stdout.split()) == wanted and not found.stderr, f"{typed}: {found.stdout} {found.stderr}")


def main():
    for case in (writes_and_refuses, pages, runs):
        with tempfile.TemporaryDirectory() as folder:
            case(pathlib.Path(folder))
            print("done", case.__name__, flush=True)
    sys.exit(bool(problems))


if __name__ == "__main__":
    main()
