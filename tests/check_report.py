#!/usr/bin/python3
"""Makes a page of a run and looks at it: it asks nothing of a network and holds what the run left; where there is a
chromium, it shows the bodies, in another picture at another time, and without fields, too.

    check_report.py RUN_FOLDER
"""
import base64
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zlib

import h5py
import numpy as np
from PIL import Image

SCRIPT = pathlib.Path(__file__).parent.parent / "scripts" / "report"


def unpacked(blob):
    return np.frombuffer(zlib.decompress(base64.b64decode(blob["data"])), blob["kind"])


def report(*arguments):
    return subprocess.run([sys.executable, SCRIPT, *arguments], capture_output=True, text=True)


def canvas(chromium, page, place, fragment):
    """The picture of the bodies at a frame."""
    picture = os.path.join(place, "page.png")
    subprocess.run([chromium, "--headless", "--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader",
                    "--hide-scrollbars", "--window-size=1000,700", "--virtual-time-budget=8000",
                    f"--user-data-dir={place}/chromium", f"--screenshot={picture}", f"file://{page}#{fragment}"],
                   capture_output=True, timeout=120, check=True)
    with Image.open(picture) as image:
        return np.asarray(image.convert("RGB"), int)


def data_of(page):
    text = pathlib.Path(page).read_text(encoding="utf-8")
    return text, json.loads(re.search(r'id="data">(.*?)</script>', text, re.S).group(1))


def look(folder, place, problems):
    page = os.path.join(folder, "report.html")
    text, data = data_of(page)
    own = text.split('id="data"')[0] + text.split("</script>", 1)[1]  # the page itself, without the run
    if re.search(r"(src|href)\s*=|@import|url\(|https?://", own):
        problems.append("the page asks for something from elsewhere")
    if len(text) > 20e6:
        problems.append(f"the page has {len(text)} bytes")
    with open(os.path.join(folder, "run.json"), encoding="utf-8") as file:
        record = json.load(file)
    if data["verdict"] != record["verdict"] or len(data["expectations"]) != len(record["expectations"]):
        problems.append("the page has another verdict or other expectations than run.json")
    view = data["view"]
    rest, triangles, cell = (unpacked(view[name]) for name in ("rest", "triangles", "cell"))
    fields = [len(unpacked(blob)) for frame in view["frames"] for blob in frame["fields"]]
    if (triangles.max() + 1, len(cell), set(fields)) != (len(rest) // 3, len(triangles) // 3, {int(cell.max()) + 1}):
        problems.append("vertices, triangles, cells and fields do not fit together")
    moved = [np.abs(unpacked(frame["moved"])).max() * frame["scale"] / 32767 for frame in view["frames"]]
    if not 0 < max(moved) < 100 * view["size"] or moved[0] > moved[-1]:
        problems.append(f"bodies move by {moved} m")
    chromium = shutil.which("chromium")
    if chromium:
        early, late = (canvas(chromium, page, place, f"frame={k}") for k in (0, len(view["frames"]) - 1))
        drawn = (late[120:560] < 250).any(axis=2).mean()
        if drawn < 0.03:
            problems.append(f"the bodies fill {100 * drawn:.1f} % of their picture")
        if (early[120:560] != late[120:560]).any(axis=2).mean() < 1e-3:
            problems.append("the first and the last frame look alike")
    return data


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    problems = []
    with tempfile.TemporaryDirectory() as place:
        folder = os.path.join(place, "run")
        shutil.copytree(sys.argv[1], folder)
        done = report(folder, "--frames", "5")
        if done.returncode != 0:
            sys.exit(f"report ended with {done.returncode}: {done.stderr.strip()}")
        data = look(folder, place, problems)

        # Without fields, and with one frame alone: the bodies are drawn all the same.
        bare = os.path.join(place, "bare")
        shutil.copytree(folder, bare)
        frames = sorted(pathlib.Path(bare, "frames").glob("[0-9]*.h5"))
        for path in frames[:-1]:
            path.unlink()
        with h5py.File(frames[-1], "a") as file:
            for where in ("cell", "point"):
                for name in list(file["body/" + where]):
                    del file["body/" + where][name]
        chromium = shutil.which("chromium")
        if report(bare).returncode != 0:
            problems.append("there is no page without fields")
        elif chromium and (canvas(chromium, os.path.join(bare, "report.html"), place, "")[120:560] < 250).mean() < 0.03:
            problems.append("without fields nothing is drawn")

        # A second run, and a table of measured values, beside the first.
        other = os.path.join(place, "other")
        shutil.copytree(sys.argv[1], other)
        name = data["charts"][0]["title"]
        measured = os.path.join(place, "measured.csv")
        with open(measured, "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([["time [s]", name], [0, 1], [1e-6, 2]])
        done = report(folder, other, "--measured", measured)
        _, both = data_of(os.path.join(folder, "report.html"))
        titles = [line["title"] for line in both["charts"][0]["lines"]]
        if done.returncode != 0 or titles != ["run", "other", "measured"]:
            problems.append(f"beside each other: status {done.returncode}, lines {titles}")

        # A run that has just begun: a line of names and no row yet.
        begun = os.path.join(place, "begun")
        shutil.copytree(folder, begun)
        history = pathlib.Path(begun, "history.csv")
        history.write_text(history.read_text(encoding="utf-8").splitlines()[0] + "\n", encoding="utf-8")
        os.remove(os.path.join(begun, "run.json"))
        if report(begun).returncode != 0 or not data_of(os.path.join(begun, "report.html"))[1]["ending"]:
            problems.append("a run that has just begun has no page, or one that does not say so")

        for arguments, words in (([folder + "-not-there"], "no such folder"),
                                 ([folder, "--measured", folder + ".csv"], "no such file"),
                                 ([folder, "--measured", os.path.join(folder, "run.json")], "has no measure"),
                                 ([folder, "--frames", "1"], "at least 2")):
            wrong = report(*arguments)
            if wrong.returncode != 1 or words not in wrong.stderr or "Traceback" in wrong.stderr:
                problems.append(f"{arguments}: status {wrong.returncode}, said: {wrong.stderr.strip()}")
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
