#!/usr/bin/python3
"""What `cmake --install` puts somewhere works from there, and knows nothing of the folder it was built in: check_install.py CMAKE BUILD_FOLDER"""
import os
import pathlib
import subprocess
import sys
import tempfile


def main():
    cmake, build = sys.argv[1:]
    with tempfile.TemporaryDirectory() as place:
        prefix, work = pathlib.Path(place) / "there", pathlib.Path(place) / "work"
        work.mkdir()
        subprocess.run([cmake, "--install", build, "--prefix", prefix], check=True, stdout=subprocess.DEVNULL)
        there = {**os.environ, "PATH": f"{prefix}/bin:/usr/bin:/bin", "PYTHONPATH": str(prefix / "lib/python3/dist-packages"), "PYTHONDONTWRITEBYTECODE": "1"}
        there.pop("FISSURE_PROGRAMS", None)

        def sh(command, says):
            done = subprocess.run(command, shell=True, cwd=work, env=there, capture_output=True, text=True, check=False)
            assert done.returncode == 0 and says in done.stdout, f"{command}: status {done.returncode}: {done.stdout[-500:]}{done.stderr[-500:]}"

        sh("fissure2d new plain", "plain.lua")
        sh("fissure2d run plain.lua --threads 1", "verdict: ok")
        sh("fissure-plot plain-fissure2d --frames 2", "animation.gif")
        sh("fissure-report plain-fissure2d", "report.html")
        sh("fissure-compare plain.lua --threads 1", "compare.png")
        sh("fissure-study plain.lua --vary 'body.mesh.size=*1,*2' --measure push --jobs 1", "study.csv")
        sh("/usr/bin/python3 -c \"import fissure; print(fissure.program(3), fissure.open('plain-fissure2d'))\"", str(prefix / "bin/fissure3d"))
        sh("bash -c 'for f in \"$0\"/fissure*; do bash -n $f; done; echo read' " + str(prefix / "share/bash-completion/completions"), "read")
        for page in ("share/man/man1/fissure2d.1", "share/doc/fissure/docs/README.md", "share/fissure/examples/course/07_brazilian.lua"):
            assert (prefix / page).stat().st_size > 500, page
        links = [path for path in prefix.rglob("*") if path.is_symlink() and not path.resolve().is_relative_to(prefix.resolve())]
        assert not links, f"links that lead elsewhere: {links}"


if __name__ == "__main__":
    main()
