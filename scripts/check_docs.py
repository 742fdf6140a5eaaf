#!/usr/bin/python3
"""Checks the pages: generated ones are up to date, links lead somewhere, scenes that are shown can be read.

    check_docs.py FISSURE2D FISSURE3D [--write]

--write brings the generated pages up to date instead: docs/reference/scene.md and scripts/lua/fissure.lua.
A code block that opens with ```lua scene is a whole scene: both programs must be able to read it.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
GENERATED = {"docs/reference/scene.md": ["reference"], "scripts/lua/fissure.lua": ["reference", "--annotations"]}


def written_by(program, words):
    return subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout


def pages():
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), *sorted((ROOT / "examples").rglob("*.md"))]


def anchors(text):
    """The names that a page's headings get."""
    titles = re.findall(r"^#+ (.*)$", text, flags=re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-") for title in titles}


def check_links(page, problems):
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        there = (page.parent / path).resolve() if path else page
        if not there.exists():
            problems.append(f"{page.relative_to(ROOT)}: links to {target}, which does not exist")
        elif anchor and there.suffix == ".md" and anchor not in anchors(there.read_text(encoding="utf-8")):
            problems.append(f"{page.relative_to(ROOT)}: links to {target}, which has no such heading")


def check_scenes(page, programs, problems):
    for number, scene in enumerate(re.findall(r"```lua scene\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.S), 1):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "scene.lua"
            path.write_text(scene, encoding="utf-8")
            for program in programs:
                done = subprocess.run([program, "params", str(path)], capture_output=True, text=True)
                if done.returncode != 0:
                    said = done.stderr.strip().replace(folder + "/", "")
                    problems.append(f"{page.relative_to(ROOT)}: scene {number}: {said}")


def main():
    programs = [word for word in sys.argv[1:] if not word.startswith("--")]
    if len(programs) != 2:
        sys.exit(__doc__)
    problems = []
    for name, words in GENERATED.items():
        texts = {written_by(program, words) for program in programs}
        if len(texts) != 1:
            problems.append(f"{name}: the two programs write different pages")
        elif "--write" in sys.argv:
            (ROOT / name).write_text(texts.pop(), encoding="utf-8")
        elif not (ROOT / name).exists() or (ROOT / name).read_text(encoding="utf-8") != texts.pop():
            problems.append(f"{name}: is not what the program writes (scripts/check_docs.py FISSURE2D FISSURE3D --write)")
    found = pages()
    for page in found:
        check_links(page, problems)
        check_scenes(page, programs, problems)
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{len(found)} pages, {len(problems)} problems")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
