#!/usr/bin/python3
"""Runs the program that docs/fdem_on_one_page.md is: its own last lines want cracks and a balance of energy.

    check_one_page.py
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

page = (pathlib.Path(__file__).parent.parent / "docs" / "fdem_on_one_page.md").read_text(encoding="utf-8")
program = "\n".join(re.findall(r"```python\n(.*?)```", page, re.S))
if not 100 < program.count("\n") < 160:
    sys.exit(f"the page's program has {program.count(chr(10))} lines; it is to be one page")
with tempfile.TemporaryDirectory() as place:
    done = subprocess.run([sys.executable, "-c", program], cwd=place, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    if done.returncode != 0 or not os.path.exists(os.path.join(place, "one_page.png")):
        sys.exit(f"the page's program ended with {done.returncode}")
