#!/usr/bin/python3
"""Watches a run: before it begins, while it writes, and when it has ended; where there is a chromium, its page
follows by itself.

    check_watch.py RUN_FOLDER
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request

MOST = 60  # frames that a page has
SCRIPT = pathlib.Path(__file__).parent.parent / "scripts" / "watch"


def asked(address, what=""):
    with urllib.request.urlopen(address + what, timeout=60) as answer:
        return answer.read().decode()


def frames_of(page):
    return len(json.loads(re.search(r'id="data">(.*?)</script>', page, re.S).group(1))["view"]["frames"])


def until(holds, seconds=60):
    """Waits for what must come."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if holds():
            return True
        time.sleep(0.1)
    return False


def follow(whole, place, problems):
    folder, frames = os.path.join(place, "run"), sorted(pathlib.Path(whole, "frames").glob("[0-9]*.h5"))
    watch = subprocess.Popen([sys.executable, SCRIPT, folder, "--port", "0"], stdout=subprocess.PIPE, text=True)
    try:
        if "waited for" not in watch.stdout.readline():
            problems.append("of a folder that does not exist nothing is said")
        address = watch.stdout.readline().split()[0]
        if "has not begun" not in asked(address):
            problems.append("of a run that has not begun, the page does not say so")
        os.mkdir(folder)
        if "holds nothing to show yet" not in asked(address):
            problems.append("of a run that has written nothing, the page does not say so")

        # Half of it is there.
        shutil.copytree(os.path.join(whole, "frames"), os.path.join(folder, "frames"),
                        ignore=lambda *_: [path.name for path in frames[len(frames) // 2:]])
        rows = pathlib.Path(whole, "history.csv").read_text(encoding="utf-8").splitlines(keepends=True)
        history = pathlib.Path(folder, "history.csv")
        half = len(rows) // 2  # and a row half written
        history.write_text("".join(rows[:half]) + rows[half][:5], encoding="utf-8")
        if not until(lambda: 'id="data"' in asked(address)):
            problems.append("a run that has begun is not shown")
            return
        stamp, page = asked(address, "stamp"), asked(address)
        told = all(words in page for words in ("it goes on", stamp, '"last": '))
        if frames_of(page) != min(len(frames) // 2, MOST) or not told:
            problems.append(f"the page of half a run shows {frames_of(page)} frames of {len(frames) // 2}")
        if asked(address, "stamp") != stamp:
            problems.append("the page is made anew though nothing was written")
        chromium, browser = shutil.which("chromium"), None
        if chromium:  # a clock of its own, faster than ours, which waits for answers: it outlasts what comes now
            browser = subprocess.Popen([chromium, "--headless", "--no-sandbox", "--use-gl=swiftshader",
                                        "--enable-unsafe-swiftshader", "--virtual-time-budget=1000000",
                                        f"--user-data-dir={place}/chromium", "--dump-dom", address],
                                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            time.sleep(3)

        # It goes on, and ends. What a run writes appears whole, by renaming.
        for path in frames[len(frames) // 2:]:
            shutil.copy(path, os.path.join(folder, path.name + ".part"))
            os.replace(os.path.join(folder, path.name + ".part"), os.path.join(folder, "frames", path.name))
        history.write_text("".join(rows), encoding="utf-8")
        shutil.copy(os.path.join(whole, "run.json"), folder)
        def all_of_it():
            page = asked(address)
            whole = frames_of(page) == min(len(frames), MOST) and "it goes on" not in page
            return whole and asked(address, "stamp") != stamp
        if not until(all_of_it):
            problems.append("what the run wrote further, and that it has ended, is not shown")
        if browser:
            shown, _ = browser.communicate(timeout=120)
            if f'max="{min(len(frames), MOST) - 1}"' not in shown:
                problems.append("the page in a browser did not follow the run")

        # It begins again: what is shown stays until there is something new.
        os.remove(history), os.remove(os.path.join(folder, "run.json")), shutil.rmtree(os.path.join(folder, "frames"))
        time.sleep(1)
        if 'id="data"' not in asked(address):
            problems.append("the page is lost when the run begins again")
        used = subprocess.run([sys.executable, SCRIPT, folder, "--port", address.rstrip("/").rpartition(":")[2]],
                              capture_output=True, text=True)
        if used.returncode != 1 or "--port 0 takes any that is free" not in used.stderr:
            problems.append(f"a port that is used: status {used.returncode}, said: {used.stderr.strip()}")
    finally:
        watch.terminate()
        watch.wait()


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    problems = []
    with tempfile.TemporaryDirectory() as place:
        follow(sys.argv[1], place, problems)
        for arguments, words in (([os.path.join(sys.argv[1], "history.csv")], "is no folder"),
                                 ([place, "--port", "70000"], "between 0 and 65535"), ([""], "is missing")):
            wrong = subprocess.run([sys.executable, SCRIPT, *arguments], capture_output=True, text=True, timeout=60)
            if wrong.returncode != 1 or words not in wrong.stderr:
                problems.append(f"{arguments}: status {wrong.returncode}, said: {wrong.stderr.strip()}")
    for problem in problems:
        print(problem, file=sys.stderr)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
