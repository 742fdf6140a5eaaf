#!/usr/bin/python3
"""Contracts and races: checked.py SOURCE FOLDER FISSURE2D FISSURE3D

Builds the programs with the presets debug and threads in FOLDER, runs scenes with four threads in each, and wants the histories of the
release programs to the last byte. A contract that is broken or a race ends a run. Slow: two whole builds.
"""
import pathlib
import subprocess
import sys

SCENES = {  # scene: what makes it short, in both dimensions
    "brazilian/brazilian.lua": ["speed=0.4", "h=5e-3", "thickness=1e-2", "time=4e-5"],
    "taylor/taylor.lua": ["time=4e-6"],
}


def main(source, folder, *released):
    problems = 0
    for preset in ("debug", "threads"):
        tree = folder / preset
        run(["cmake", "-S", source, "--preset", preset, "-B", tree])
        run(["cmake", "--build", tree, "--target", "fissure2d", "fissure3d"])
        for d, program in zip("23", released):
            for scene, settings in SCENES.items():
                texts = []
                for by, kind in ((program, "release"), (tree / f"src{d}d/fissure{d}d", preset)):
                    out = folder / f"{pathlib.Path(scene).stem}-{d}d-{kind}"
                    run([by, "run", source / "examples" / scene, "--quiet", "--threads", "4", "--out", out,
                         *(word for setting in settings for word in ("--set", setting))])
                    texts.append((out / "history.csv").read_bytes())
                same = texts[0] == texts[1]
                problems += not same
                print(f"{scene} in {d}D, {preset}: {'the same bits' if same else 'DIFFERS from release'}", flush=True)
    sys.exit(bool(problems))


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode not in (0, 1):  # 1: a run that is cut short misses what its scene expects
        sys.exit(" ".join(map(str, command)) + "\n" + "\n".join(done.stdout.splitlines()[-60:]))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), *sys.argv[3:])
