"""The bundle in a root with nothing but libc, a shell and Python: dry_run.py BUNDLE.tar.xz WORK

Runs every stage on the CPU, then again with what can go wrong: no driver, a missing file, a changed one, a stage that hangs.
Each must be a clear line in the report, and no other stage may suffer.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile


ENTER = ["chroot"] if os.geteuid() == 0 else ["unshare", "--map-root-user", "chroot"]


def bare_root(root):
    """Copies libc, a shell and Debian's Python with their libraries."""
    shutil.rmtree(root, ignore_errors=True)
    for part in ("bin", "usr/bin", "tmp", "dev"):
        (root / part).mkdir(parents=True)
    python = os.path.realpath("/usr/bin/python3")
    standard = pathlib.Path(sysconfig.get_path("stdlib"))
    copied = root / standard.relative_to("/")
    not_needed = shutil.ignore_patterns("test", "__pycache__", "dist-packages", "config-*", "idlelib", "tkinter")
    shutil.copytree(standard, copied, ignore=not_needed)
    binaries = ["/bin/sh", "/usr/bin/env", python, *map(str, copied.glob("lib-dynload/*.so"))]
    libraries = set()
    for binary in binaries:
        ldd = subprocess.run(["ldd", binary], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False)
        libraries.update(re.findall(r"(/\S+) \(0x", ldd.stdout))
    for library in libraries:
        to = root / library.lstrip("/")
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(library, to)
    shutil.copy("/bin/sh", root / "bin/sh")
    shutil.copy("/usr/bin/env", root / "usr/bin/env")
    shutil.copy(python, root / "usr/bin/python3")
    (root / "dev/null").touch(mode=0o666)


def in_root(root, command, **environment):
    """Runs a shell command in the root; as root by chroot, else in a user namespace."""
    enter = [*ENTER, root]
    done = subprocess.run([*map(str, enter), "/bin/sh", "-c", command], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False, env={"PATH": "/usr/bin:/bin:/usr/sbin:/sbin", "HOME": "/tmp", **environment})
    print(f"$ {command}\n{done.stdout}-> {done.returncode}", flush=True)
    return done.returncode, done.stdout


def main():
    archive, work = map(pathlib.Path, sys.argv[1:])
    root = work / "root"
    bare_root(root)
    if in_root(root, ":")[0] != 0:
        print("this machine lets nobody change the root: not shown here")
        sys.exit(77)
    with tarfile.open(archive) as packed:
        packed.extractall(root)
    problems = []

    def expect(what, good):
        if not good:
            problems.append(what)

    def stages(folder):
        return json.loads((root / "gpu_bundle" / folder / "report.json").read_text())["stages"]

    status, _ = in_root(root, "cd gpu_bundle && ./gpu_check --dry-run")
    found = stages("gpu_report")
    expect("the dry run", status == 0 and all(stage["result"] == "ok" for stage in found.values()) and len(found) == 8)

    status, text = in_root(root, "cd gpu_bundle && ./gpu_check --only card refusals --out no_card")
    said = "there is no NVIDIA driver" in text and stages("no_card")["card"]["result"] == "FAILED"
    expect("no driver: a clear line", status == 1 and said)

    program = root / "gpu_bundle" / "bin" / "fissure2d"
    program.rename(program.with_suffix(".away"))
    status, text = in_root(root, "cd gpu_bundle && ./gpu_check --dry-run --only bundle refusals equality card --out missing")
    program.with_suffix(".away").rename(program)
    found = stages("missing")
    said = "bin/fissure2d missing" in found["bundle"]["line"] and "bin/fissure2d is missing" in found["equality"]["line"]
    expect("a missing file: a clear line", status == 1 and said)
    expect("a missing file: other stages", found["card"]["result"] == "ok" and found["refusals"]["result"] == "ok")

    scene = root / "gpu_bundle" / "scenes" / "flow.lua"
    scene.write_text(scene.read_text() + "\n")
    status, text = in_root(root, "cd gpu_bundle && ./gpu_check --dry-run --only bundle --out changed")
    expect("a changed file: a clear line", status == 1 and "scenes/flow.lua changed" in text)

    program.rename(program.with_suffix(".away"))
    program.write_text("#!/bin/sh\nwhile :; do :; done\n")
    program.chmod(0o755)
    status, text = in_root(root, "cd gpu_bundle && ./gpu_check --dry-run --only equality card --limit equality=3 --out hangs")
    program.with_suffix(".away").rename(program)
    found = stages("hangs")
    said = "past the limit" in found["equality"]["line"] and found["equality"]["seconds"] < 10
    expect("a stage that hangs: a clear line", status == 1 and said)
    expect("a stage that hangs: other stages", found["card"]["result"] == "ok")

    shutil.rmtree(root)
    sys.exit("; ".join(f"not as it should be: {problem}" for problem in problems) if problems else 0)


if __name__ == "__main__":
    main()
