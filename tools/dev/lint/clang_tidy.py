#!/usr/bin/env python3
"""clang_tidy.py BUILD_FOLDER: clang-tidy over every unit that was not found clean before.

Faults planted under planted/ must be found, each by the check that a comment names.
"""

import concurrent.futures
import functools
import hashlib
import os
import pathlib
import re
import subprocess
import sys

from foreign import Precompiled
from passed import Passed, default_folder
from units import Tree, read_units

HERE = "tools/dev/lint"
PLANTED = f"{HERE}/planted/"
OURS = "(metrics|schema|server|storage|tests|tools)"
UNITS_FOR_PRECOMPILED = 20  # fewer are read sooner than the header is compiled

FINDING = re.compile(r"^(/[^:]+):(\d+):\d+: (?:error|warning): .*\[([^\],]+)(?:,[^\]]*)?\]$", re.MULTILINE)
EXPECTED = re.compile(r"// finds: (.+)$")
# Foreign headers' warnings are no news.
NOISE = re.compile(r"^\d+ (warnings?|errors?).* generated\.\n", re.MULTILINE)


def context(root):
    """What the findings of every unit depend on."""
    digest = hashlib.sha256((root / ".clang-tidy").read_bytes())
    for path in sorted((root / HERE).iterdir()):
        if path.suffix in (".py", ".cc", ".txt"):
            digest.update(path.read_bytes())
    versions = subprocess.run(
        ["dpkg-query", "-W", "-f", "${Package}:${Architecture} ${Version}\n", "*-dev", "clang*", "libclang*"],
        capture_output=True,
        check=True,
    )
    digest.update(versions.stdout)
    return digest.digest()


def run_clang_tidy(root, build, precompiled, unit):
    """(exit code, output) of clang-tidy on a unit."""
    command = [
        "clang-tidy-14",
        "--quiet",
        f"--load={build}/tools/dev/lint/libuplink_lint_scope.so",
        f"--header-filter=^{re.escape(str(root))}/{OURS}/",
        unit.path,
        "--",
        *precompiled.flags(unit),
    ]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    return done.returncode, NOISE.sub("", done.stdout + done.stderr)


def found_in(root, output):
    """(file, line, check) of each finding."""
    return {(os.path.relpath(path, root), int(line), check) for path, line, check in FINDING.findall(output)}


def planted_in(root):
    """What must be found: a line's comment names the checks that must report it."""
    planted = set()
    for path in sorted((root / PLANTED).iterdir()):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            names = EXPECTED.search(line)
            for check in names.group(1).split(", ") if names else ():
                planted.add((f"{PLANTED}{path.name}", number, check))
    return planted


def judge_planted(root, output):
    """The text of what is wrong, or nothing."""
    found, planted = found_in(root, output), planted_in(root)
    wrong = [f"not found: {path}:{line}: {check}" for path, line, check in sorted(planted - found)]
    wrong += [f"not planted: {path}:{line}: {check}" for path, line, check in sorted(found - planted)]
    return "\n".join(wrong + ([output] if wrong else []))


def judge(root, build, precompiled, unit):
    """The text to print about a unit; nothing if it is clean."""
    status, output = run_clang_tidy(root, build, precompiled, unit)
    if unit.path.startswith(PLANTED):
        return judge_planted(root, output)
    return output if status != 0 else ""


def main():
    root, build = pathlib.Path.cwd(), pathlib.Path(sys.argv[1]).resolve()
    tree = Tree(str(root))
    everything = context(root)
    passed = Passed(default_folder())
    todo, planted = {}, {}
    for unit in read_units(tree, build / "compile_commands.json"):
        key = unit.key(tree, everything)
        if unit.path.startswith(PLANTED):
            planted[key] = unit
        elif not passed.holds(key):
            todo[key] = unit
    # Whatever is read, the planted faults are read in the same run.
    if not todo and all(passed.holds(key) for key in planted):
        return 0
    todo.update(planted)
    precompiled = Precompiled(list(todo.values()))
    if len(todo) >= UNITS_FOR_PRECOMPILED:
        precompiled.make(build)
    print(f"lint: clang-tidy reads {len(todo)} units", file=sys.stderr, flush=True)

    bad = 0
    work = functools.partial(judge, root, build, precompiled)
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as workers:
        running = {workers.submit(work, unit): (key, unit) for key, unit in todo.items()}
        for each in concurrent.futures.as_completed(running):
            key, unit = running[each]
            if each.result():
                bad += 1
                print(f"clang-tidy: {unit.path}\n{each.result()}", flush=True)
            else:
                passed.remember(key)
    passed.prune()
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
