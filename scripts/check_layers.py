#!/usr/bin/python3
"""Checks who may include whom: the order of the layers, the two dimensions apart, and no question about D in common/.

    check_layers.py [--draw] [FOLDER_OF_THE_PROJECT]

It draws them, too, as docs/pictures/layers.svg: --draw writes the picture, else it must be the one that is there.
"""
import pathlib
import re
import sys

LAYERS = {  # in the order in which they may use each other; the number is the column in the picture
    "base": ("errors, small matrices, lanes", 1.5),
    "backend": ("devices, arrays, loops over them", 2.5),
    "laws": ("formulas of materials", 1),
    "kernels": ("what runs over cells, vertices, pairs", 2),
    "scene": ("what was asked for", 0),
    "lua": ("a script becomes a scene", 0),
    "mesh": ("cells, neighbours, places", 1),
    "model": ("the arrays of a run", 1.5),
    "contact": ("who may touch, and its forces", 1.5),
    "solver": ("the step and its stages", 1.5),
    "output": ("frames, histories, checkpoints", 3),
    "app": ("the command line", 1.5),
}
ORDER = list(LAYERS)
PICTURE = "docs/pictures/layers.svg"
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
            return f"include it as one of {', '.join(ORDER)}/..."
        if included != "lua/library.inc" and not (root / "common" / included).exists():  # that one is made by CMake
            return "no such file in common/"
        if included in PLAIN_DATA:
            return None
        if ORDER.index(target[0]) > ORDER.index(layer):
            return f"{layer} may use only {', '.join(ORDER[:ORDER.index(layer) + 1])}"
        if target[0] in NOT_TOGETHER.get(layer, ()):
            return f"{layer} does without {target[0]}"
    else:
        other = DIMENSIONS[1 - DIMENSIONS.index(part[0])]
        if other in target or ".." in target:
            return f"{part[0]} does without {other}"
    return None


def drawn(uses):
    """The layers as SVG, each above all that it uses; of the arrows those that no others imply. `uses`: {layer: set of layers}."""
    row = {}  # from the top: as high as its users let it
    for layer in reversed(ORDER):
        row[layer] = 1 + max((row[user] for user in ORDER if layer in uses[user]), default=-1)
    width, height, gap = 236, 54, 40
    across, down = 4 * (width + gap) - gap + 20, (max(row.values()) + 1) * (height + gap) - gap + 20
    at = {layer: (10 + width / 2 + LAYERS[layer][1] * (width + gap), 10 + height / 2 + row[layer] * (height + gap)) for layer in ORDER}
    reach = {}  # all that a layer uses, however far
    for layer in ORDER:
        reach[layer] = set(uses[layer]).union(*(reach[used] for used in uses[layer]))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {across:.0f} {down:.0f}" font-family="sans-serif">',
           f'<rect width="{across:.0f}" height="{down:.0f}" fill="#ffffff"/>']
    for layer in ORDER:
        for used in sorted(uses[layer], key=ORDER.index):
            if any(used in reach[other] for other in uses[layer] if other != used):
                continue
            (x, y), (a, b) = at[layer], at[used]
            y, b = y + height / 2, b - height / 2
            out.append(f'<path d="M{x:.0f} {y:.0f} V{b - gap:.0f} C{x:.0f} {b - gap / 2:.0f} {a:.0f} {b - gap / 2:.0f} {a:.0f} {b:.0f}" '
                       f'fill="none" stroke="#8aa0b4" stroke-width="1.5"/>')
    for layer, (x, y) in at.items():
        out.append(f'<rect x="{x - width / 2:.0f}" y="{y - height / 2:.0f}" width="{width}" height="{height}" rx="8" fill="#eef3f7" '
                   f'stroke="#4c6a86"/>')
        out.append(f'<text x="{x:.0f}" y="{y - 5:.0f}" text-anchor="middle" font-size="17" font-weight="bold" fill="#1d3448">{layer}</text>')
        out.append(f'<text x="{x:.0f}" y="{y + 15:.0f}" text-anchor="middle" font-size="12" fill="#3c4c5a">{LAYERS[layer][0]}</text>')
    return "\n".join(out) + "\n</svg>\n"


def main():
    words = [word for word in sys.argv[1:] if word != "--draw"]
    root = pathlib.Path(words[0] if words else pathlib.Path(__file__).parent.parent).resolve()
    problems, count = [], 0
    uses = {layer: set() for layer in ORDER}
    for folder in ("common",) + DIMENSIONS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix not in SOURCES:
                continue
            count += 1
            where = path.relative_to(root)
            if folder == "common" and path.parent.name not in LAYERS:
                problems.append(f"{where}: belongs to no layer (known: {', '.join(ORDER)})")
                continue
            text = path.read_text(encoding="utf-8")
            for number, line in enumerate(strip_comments(text), 1):
                found = re.match(r'\s*#include\s+"([^"]+)"', line)
                if found and (problem := check_include(root, path, found.group(1))):
                    problems.append(f'{where}:{number}: includes "{found.group(1)}" ({problem})')
                elif found and folder == "common" and found.group(1) not in PLAIN_DATA:
                    uses[path.parent.name].add(found.group(1).split("/")[0])
                if folder == "common":
                    problems += [f"{where}:{number}: {what} (name what differs in Dim<D>): {line.strip()}"
                                 for pattern, what in QUESTIONS if pattern.search(line)]

    names = [{str(p.relative_to(root / d)) for p in (root / d).rglob("*") if p.is_file()} for d in DIMENSIONS]
    for this, that, mine, theirs in ((*DIMENSIONS, *names), (*DIMENSIONS[::-1], *names[::-1])):
        problems += [f"{this}/{name}: has no twin in {that}/" for name in sorted(mine - theirs)]

    for layer in ORDER:
        uses[layer].discard(layer)
    picture = root / PICTURE
    if "--draw" in sys.argv:
        picture.write_text(drawn(uses), encoding="utf-8")
    elif not problems and picture.read_text(encoding="utf-8") != drawn(uses):
        problems.append(f"{PICTURE} is not the picture of these layers; scripts/check_layers.py --draw")

    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{count} files, {len(problems)} problems")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
