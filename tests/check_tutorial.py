#!/usr/bin/python3
"""What the tutorial and the README show comes out: check_tutorial.py FISSURE2D FISSURE3D

Runs every command of the tutorial ("    $ ...") in order, in a copy of its folder, and looks for the lines printed below it: in that order,
"..." for what is left out. Then runs the whole scenes of both pages in both dimensions. Seconds and threads belong to a machine and are
not compared; nor is a number to more than TOLERANCE, since meshes may differ in their last bits from one processor to another and cracks
make more of it.
"""
import os
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TUTORIAL = ROOT / "docs/tutorial.md"
TOLERANCE = 0.01
OF_A_MACHINE = [r"[\d.]+ ms each", r"about [\d.]+ (s|min|h)\b", r"\d+ threads?"]
NUMBER = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:e[-+]?\d+)?(?![\w])")


def commands(page):
    """Pairs of a command and the lines shown below it."""
    for block in re.findall(r"(?m)(?:^    .*\n)+", page):
        lines = [line[4:] for line in block.splitlines()]
        starts = [i for i, line in enumerate(lines) if line.startswith("$ ")]
        for start, end in zip(starts, [*starts[1:], len(lines)]):
            yield lines[start][2:], lines[start + 1:end]


def scenes(page):
    return re.findall(r"```lua scene\n(.*?)```", page, flags=re.S)


def pieces(line):
    """What a line says, and the numbers in it."""
    for pattern in OF_A_MACHINE:
        line = re.sub(pattern, "~", line)
    return NUMBER.sub("#", line).strip(), [float(number) for number in NUMBER.findall(line)]


def alike(shown, printed):
    """Whether a line is the one shown, whose " ..." stands for anything."""
    words, numbers = pieces(printed)
    shown_words, shown_numbers = zip(*map(pieces, shown.split(" ...")))
    head, tail = shown_numbers[0], shown_numbers[-1] if len(shown_numbers) > 1 else []
    if len(shown_words) == 1 and words != shown_words[0] or not (words.startswith(shown_words[0]) and words.endswith(shown_words[-1])):
        return False
    compared = zip([*head, *tail], [*numbers[:len(head)], *numbers[len(numbers) - len(tail):]])
    return all(abs(a - b) <= TOLERANCE * max(abs(a), abs(b)) for a, b in compared)


def missing(shown, printed):
    """The first shown line that was not printed in its place, or nothing."""
    at, gap = 0, False
    for line in shown:
        if line.strip() == "...":
            gap = True
            continue
        found = next((i for i in range(at, len(printed)) if alike(line, printed[i])), None)
        if found is None or (found > at and not gap):
            return line
        at, gap = found + 1, False
    return None


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(command, folder):
    start = processor_time()
    done = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    print(f"{processor_time() - start:6.1f} s  {shlex.join(map(str, command))}", flush=True)
    return done


def changed_scenes(page, folder):
    """mine.lua and typo.lua, as the page has them made from brazilian.lua."""
    scene = (folder / "brazilian.lua").read_text(encoding="utf-8")
    contact, measure = re.findall(r"```lua\n(.*?)```", page, flags=re.S)
    mine, times = re.subn(r"(?m)^  contact  = .*\n", contact, scene)
    typo = scene.replace("{ tension =", "{ tensoin =")
    assert times == 1 and typo != scene, "the page changes lines that brazilian.lua does not have"
    (folder / "mine.lua").write_text(mine + measure, encoding="utf-8")
    (folder / "typo.lua").write_text(typo, encoding="utf-8")


def main(programs):
    programs = [pathlib.Path(program).resolve() for program in programs]
    os.environ["PATH"] = ":".join([*(str(program.parent) for program in programs), str(ROOT / "scripts"), os.environ["PATH"]])
    page, problems = TUTORIAL.read_text(encoding="utf-8"), []
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(shutil.copytree(ROOT / "examples/brazilian", pathlib.Path(scratch) / "brazilian"))
        changed_scenes(page, folder)
        for command, shown in commands(page):
            if command.startswith("cd "):
                continue
            done = run(shlex.split(command), folder)
            line = missing(shown, done.stdout.splitlines())
            if line:
                problems.append(f"{command}\nshown:   {line}\nprinted:\n{done.stdout}")
            if not shown and done.returncode != 0:
                problems.append(f"{command}: status {done.returncode}\n{done.stdout}")
        for path in (ROOT / "README.md", TUTORIAL):
            for number, scene in enumerate(scenes(path.read_text(encoding="utf-8")), 1):
                (folder / f"{path.stem}{number}.lua").write_text(scene, encoding="utf-8")
                for program in programs:
                    done = run([program, "run", f"{path.stem}{number}.lua"], folder)
                    if done.returncode != 0:
                        problems.append(f"{path.name}, scene {number}: status {done.returncode}\n{done.stdout}")
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(bool(problems))


if __name__ == "__main__":
    main(sys.argv[1:])
