#!/usr/bin/python3
"""Draws the pictures of a run and looks at them: each is an image of some size that shows something.

    check_plot.py RUN_FOLDER
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import shutil

import numpy as np
from PIL import Image

SCRIPT = pathlib.Path(__file__).parent.parent / "scripts" / "plot.py"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    problems = []
    with tempfile.TemporaryDirectory() as place:
        folder = os.path.join(place, "run")
        shutil.copytree(sys.argv[1], folder)
        done = subprocess.run([sys.executable, SCRIPT, folder, "--frames", "4"], capture_output=True, text=True)
        if done.returncode != 0:
            problems.append(f"plot.py ended with {done.returncode}: {done.stderr.strip()}")
        for name in ("curves.png", "energy.png", "cracks.png", "animation.gif"):
            path = os.path.join(folder, name)
            if not os.path.exists(path):
                problems.append(f"{name} was not drawn")
                continue
            with Image.open(path) as image:
                pixels = np.asarray(image.convert("L"), float)
            if min(pixels.shape) < 200 or pixels.std() < 5:
                problems.append(f"{name} shows nothing: {pixels.shape} pixels, contrast {pixels.std():.1f}")

        missing = subprocess.run([sys.executable, SCRIPT, folder + "-not-there"], capture_output=True, text=True)
        if missing.returncode != 1 or "no such folder" not in missing.stderr or "Traceback" in missing.stderr:
            problems.append(f"a folder that is not there: status {missing.returncode}, said: {missing.stderr.strip()}")
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
