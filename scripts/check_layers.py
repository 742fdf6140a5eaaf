#!/usr/bin/python3
"""Checks who may include whom: the order of the layers, the two dimensions apart, and no question about D in common/.

    check_layers.py [FOLDER_OF_THE_PROJECT]
"""
import pathlib
import re
import sys

LAYERS = ["base", "backend", "laws", "kernels", "scene", "lua", "mesh", "model", "contact", "solver", "output", "app"]
# Plain data that an earlier layer fills in for a later one.
PLAIN_DATA = {"output/results.h"}
# Layers that stand side by side: what was asked for reaches them as scene/, what came out leaves them as plain data.
NOT_TOGETHER = {"mesh": {"lua"}, "model": {"lua"}, "solver": {"lua"}, "output": {"lua", "mesh", "model", "contact", "solver"}}
DIMENSIONS = ("src2d", "src3d")
# Only templates are meant: the scene language (lua/) says by itself what a scene may say in 2D and in 3D.
QUESTIONS = [
    (re.compile(r"\bD\s*[=!<>]=?\s*[123]\b(?!\s*\*)"), "asks for the dimension"),
    (re.compile(r"\b[123]\s*==\s*D\b"), "asks for the dimension"),
    (re.compile(r"if\s+constexpr\s*\(\s*!?\s*D\b"), "asks for the dimension"),
    (re.compile(r"Dim<D>::value\s*[=!<>]"), "asks for the dimension"),
]
SOURCES = {".h", ".cpp", ".cu", ".cuh"}


def strip_comments(text):
    """The same lines without comments and without what stands in quotes; include lines keep theirs."""
    text = re.sub(r"/\*.*?\*/", lambda found: "\n" * found.group().count("\n"), text, flags=re.S)
    lines = []
    for line in text.split("\n"):
        if not line.lstrip().startswith("#include"):
            line = re.sub(r'"(\\.|[^"\\])*"', '""', line)
            line = line.split("//")[0]
        lines.append(line)
    return lines


def check_include(root, path, included):
    """What is wrong with this include line, or None."""
    part = path.relative_to(root).parts
    target = pathlib.PurePosixPath(included).parts
    if part[0] == "common":
        layer = part[1]
        if target[0] in DIMENSIONS or ".." in target:
            return "common/ knows no dimension"
        if len(target) < 2 or target[0] not in LAYERS:
            return f"include it as one of {', '.join(LAYERS)}/..."
        if included != "lua/library.inc" and not (root / "common" / included).exists():  # that one is made by CMake
            return "no such file in common/"
        if included in PLAIN_DATA:
            return None
        if LAYERS.index(target[0]) > LAYERS.index(layer):
            return f"{layer} may use only {', '.join(LAYERS[:LAYERS.index(layer) + 1])}"
        if target[0] in NOT_TOGETHER.get(layer, ()):
            return f"{layer} does without {target[0]}"
    else:
        other = DIMENSIONS[1 - DIMENSIONS.index(part[0])]
        if other in target or ".." in target:
            return f"{part[0]} does without {other}"
    return None


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    problems, count = [], 0
    for folder in ("common",) + DIMENSIONS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in SOURCES:
                continue
            count += 1
            where = path.relative_to(root)
            if folder == "common" and path.parent.name not in LAYERS:
                problems.append(f"{where}: belongs to no layer (known: {', '.join(LAYERS)})")
                continue
            text = path.read_text(encoding="utf-8")
            for number, line in enumerate(strip_comments(text), 1):
                found = re.match(r'\s*#include\s+"([^"]+)"', line)
                if found and (problem := check_include(root, path, found.group(1))):
                    problems.append(f'{where}:{number}: includes "{found.group(1)}" ({problem})')
                if folder == "common":
                    problems += [f"{where}:{number}: {what} (name what differs in Dim<D>): {line.strip()}"
                                 for pattern, what in QUESTIONS if pattern.search(line)]

    names = [{str(p.relative_to(root / d)) for p in (root / d).rglob("*") if p.is_file()} for d in DIMENSIONS]
    for this, that, mine, theirs in ((*DIMENSIONS, *names), (*DIMENSIONS[::-1], *names[::-1])):
        problems += [f"{this}/{name}: has no twin in {that}/" for name in sorted(mine - theirs)]

    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{count} files, {len(problems)} problems")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
