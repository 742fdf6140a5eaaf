#!/usr/bin/python3
"""Lets clang++ read every source file: our code has no warnings with the second compiler either (no code is made).

    check_clang.py BUILD_FOLDER_CONFIGURED_WITH_CLANG
"""
import concurrent.futures
import json
import os
import shlex
import subprocess
import sys


def read(entry):
    """Compiler's complaints about one file; its own command without output and sanitizers."""
    words, command = shlex.split(entry["command"]), []
    while words:
        word = words.pop(0)
        if word == "-o":
            words.pop(0)
        elif word != "-c" and not word.startswith("-fsanitize") and not word.startswith("-fno-sanitize"):
            command.append(word)
    done = subprocess.run([*command, "-fsyntax-only"], cwd=entry["directory"], capture_output=True, text=True)
    return entry["file"], done.returncode, done.stderr.strip()


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(os.path.join(sys.argv[1], "compile_commands.json"), encoding="utf-8") as file:
        entries = {(entry["file"], "FISSURE_D=3" in entry["command"]): entry for entry in json.load(file)}
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for path, status, said in pool.map(read, entries.values()):
            if status != 0 or said:
                failed += 1
                print(f"{path}:\n{said}", file=sys.stderr)
    print(f"{len(entries)} files, {failed} with complaints")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
