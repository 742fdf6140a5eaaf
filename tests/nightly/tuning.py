#!/usr/bin/python3
"""The same bits whatever processor the compiler tunes for: tuning.py SOURCE FOLDER

Builds programs and ladder in FOLDER once per tuning, host code and kernels alike, runs the ladder in each, and runs scenes in each whose
histories must be equal to the last byte. Slow: three whole builds.
"""
import pathlib
import subprocess
import sys

TUNINGS = {  # -march and -mtune of everything; the last is what any x86-64 processor runs
    "rocketlake": "x86-64-v3,-mtune=rocketlake",
    "znver3": "x86-64-v3,-mtune=znver3",
    "baseline": "x86-64",
}
SCENES = {  # scene: what makes it short, in both dimensions
    "brazilian/brazilian.lua": ["speed=0.4", "h=4e-3", "thickness=8e-3", "time=6e-5"],
}


def main(source, folder):
    histories = {}
    for name, flags in TUNINGS.items():
        tree = folder / name
        tune = " ".join(word for word in flags.split(",") if word.startswith("-mtune"))
        run(["cmake", "-S", source, "-B", tree, "-G", "Ninja", "-DFISSURE_CUDA=OFF", f"-DFISSURE_TUNE={flags}", f"-DCMAKE_CXX_FLAGS={tune}"])
        run(["cmake", "--build", tree, "--target", "fissure2d", "fissure3d", "verify_2d", "verify_3d"])
        for d in "23":
            run([tree / f"tests/verify_{d}d", "--gtest_brief=1"])
            for scene, settings in SCENES.items():
                out = tree / f"{pathlib.Path(scene).stem}-{d}d"
                run([tree / f"src{d}d/fissure{d}d", "run", source / "examples" / scene, "--quiet", "--threads", "2", "--out", out,
                     *(word for setting in settings for word in ("--set", setting))])
                histories.setdefault((scene, d), {})[name] = (out / "history.csv").read_bytes()
    differ = [f"{scene} in {d}D: {name} and baseline differ" for (scene, d), of in histories.items() for name in of if of[name] != of["baseline"]]
    print("\n".join(differ) or f"{len(histories)} histories are the same bits for {', '.join(TUNINGS)}")
    sys.exit(bool(differ))


def run(command):
    print(" ".join(map(str, command)), flush=True)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        sys.exit("\n".join(done.stdout.splitlines()[-60:]))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve())
