#!/usr/bin/python3
"""The .deb in a bare Debian 12, which has no compiler and no library of ours: package.py SOURCE FOLDER [--deb FILE.deb]

Builds the portable preset into FOLDER, unless a package is given, and makes the package. Then: a root of the least Debian, apt installs the package with what it
depends on alone; scenes run in both dimensions; apt installs what it recommends; pictures, a page, a comparison and a study are made and Python imports the package;
apt removes it, and nothing is left. Needs root, debootstrap and a mirror that apt of this machine knows; ends with 77, skipped, without.
"""
import os
import pathlib
import shutil
import subprocess
import sys


def skip(why):
    print(f"{why}: not shown here")
    sys.exit(77)


def package(source, folder):
    tree = folder / "build"
    for command in (["cmake", "-S", source, "--preset", "portable", "-B", tree, "-DFISSURE_CUDA=OFF", "-DFISSURE_TESTS=OFF"],
                    ["cmake", "--build", tree, "--target", "fissure2d", "fissure3d"], ["cpack", "--config", "CPackConfig.cmake"]):
        subprocess.run(command, cwd=tree if command[0] == "cpack" else source, check=True)
    return next(tree.glob("*.deb"))


def bare_root(root):
    """The least Debian 12, from the mirror that this machine uses."""
    told = subprocess.run(["apt-get", "indextargets", "--format", "$(CODENAME) $(REPO_URI)", "Created-By: Packages"], capture_output=True, text=True, check=False)
    mirror = next((line.split()[1] for line in told.stdout.splitlines() if line.startswith("bookworm ")), None)
    if not mirror:
        skip("apt knows no mirror of Debian 12")
    shutil.rmtree(root, ignore_errors=True)
    subprocess.run(["debootstrap", "--variant=minbase", "bookworm", root, mirror], check=True, stdout=subprocess.DEVNULL)
    shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")


def main():
    source, folder = map(pathlib.Path, sys.argv[1:3])
    if os.geteuid() != 0 or not shutil.which("debootstrap"):
        skip("this needs root, and debootstrap")
    folder.mkdir(parents=True, exist_ok=True)
    deb = pathlib.Path(sys.argv[4]) if sys.argv[3:4] == ["--deb"] else package(source, folder)
    root = folder / "root"
    bare_root(root)
    shutil.copy(deb, root / "tmp/fissure.deb")
    failed = []

    def sh(command, wanted=0, says=""):
        done = subprocess.run(["chroot", root, "/bin/bash", "-o", "pipefail", "-c", command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                              env={"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/tmp", "LC_ALL": "C.UTF-8", "DEBIAN_FRONTEND": "noninteractive"})
        print(f"$ {command}\n{done.stdout[-700:]}-> {done.returncode}", flush=True)
        if done.returncode != wanted or says not in done.stdout:
            failed.append(f"{command}: status {done.returncode}, not {wanted}" + (f", or no {says!r}" if says else ""))
        return done.stdout

    sh("mkdir /tmp/work && apt-get -q update >/dev/null")
    sh("command -v g++ cc python3", 1)
    sh("apt-get -q install --yes --no-install-recommends /tmp/fissure.deb | tail -n 3")
    sh("command -v g++ cc", 1)
    sh("ldd /usr/bin/fissure2d /usr/bin/fissure3d | grep 'not found'", 1)
    for name in ("fissure2d", "fissure3d"):
        sh(f"{name} --version", says="for any x86-64")
        sh(f"cd /tmp/work && rm -f bar.lua; {name} new bar && {name} check bar.lua --threads 1 | tail -n 1", says="verdict as far as it can be foreseen")
        sh(f"cd /tmp/work && {name} run bar.lua --quiet --threads 1 | tail -n 4", says="verdict: ok")
    sh("test -s /usr/share/man/man1/fissure3d.1 && bash -n /usr/share/bash-completion/completions/fissure3d")
    sh("apt-get -q install --yes --no-install-recommends python3-numpy python3-h5py python3-matplotlib python3-pil | tail -n 1")
    sh("cd /tmp/work && fissure-plot bar-fissure3d --frames 3", says="animation.gif")
    sh("cd /tmp/work && fissure-report bar-fissure2d", says="report.html")
    sh("cd /tmp/work && fissure2d new plain && fissure-compare plain.lua --threads 1 | tail -n 3", says="compare.png")
    sh("cd /tmp/work && fissure-study plain.lua --vary body.mesh.size=*1,*0.7 --measure push --jobs 1 | tail -n 2", says="study.csv")
    sh("cd /tmp/work && python3 -c 'import fissure; print(fissure.run(\"plain.lua\", 3, threads=1)); print(fissure.__file__)'", says="dist-packages")
    sh("apt-get -q remove --yes fissure | tail -n 1")
    sh("ls -d /usr/bin/fissure* /usr/share/fissure /usr/share/doc/fissure /usr/lib/python3/dist-packages/fissure /usr/share/man/man1/fissure* 2>/dev/null | grep .", 1)
    for one in failed:
        print("FAILED", one)
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
