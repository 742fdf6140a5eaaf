#!/usr/bin/python3
"""Checks that C++ is as .clang-format says, and that no line is longer than 120 characters.

    check_format.py [FOLDER_OF_THE_PROJECT]

Mend with: clang-format -i FILES. Ends with 77, skipped, without clang-format.
"""
import pathlib
import shutil
import subprocess
import sys

SOURCES = {".h", ".cpp", ".cu", ".cuh"}
WIDTH = 120


def main(root):
    files = sorted(path for part in ("common", "src2d", "src3d", "tests") for path in (root / part).rglob("*") if path.suffix in SOURCES)
    long = [f"{path}:{number}: {len(line)} characters" for path in files
            for number, line in enumerate(path.read_text().splitlines(), 1) if len(line) > WIDTH]
    for line in long:
        print(line)
    if not shutil.which("clang-format"):
        return 1 if long else 77
    formatted = subprocess.run(["clang-format", "--dry-run", "--Werror", *files], cwd=root, check=False)
    print(f"{len(files)} files")
    return 1 if long or formatted.returncode else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1] if sys.argv[1:] else pathlib.Path(__file__).resolve().parent.parent)))
