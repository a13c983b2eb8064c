#!/usr/bin/env python3
"""sbom_root.py ROOT DEB ...: writes ROOT/var/lib/dpkg/status with these packages and all that they need, as
they are installed on this machine, which built them. debsbom reads such a root. Standard library only.
"""

import pathlib
import re
import subprocess
import sys

FIELD = re.compile(r"^([\w-]+):[ \t]*(.*)$", re.MULTILINE)
STATUS_FILE = pathlib.Path("/var/lib/dpkg/status")
STATUS = "Status: install ok installed\n"


def output(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def fields(paragraph):
    return dict(FIELD.findall(paragraph))


def needed(paragraph):
    """Of each dependency its alternatives, without versions and architectures."""
    found = fields(paragraph)
    for dependency in ",".join(found.get(key, "") for key in ("Pre-Depends", "Depends")).split(","):
        names = [re.sub(r"[\s(:\[].*", "", part.strip()) for part in dependency.split("|")]
        if names[0]:
            yield names


def installed():
    """Paragraph by package name, and by each name that it provides."""
    packages = {}
    for paragraph in STATUS_FILE.read_text(encoding="utf-8").split("\n\n"):
        found = fields(paragraph)
        if not found.get("Status", "").endswith(" installed"):
            continue
        packages.setdefault(found["Package"], paragraph)
        for name in found.get("Provides", "").split(","):
            packages.setdefault(re.sub(r"[\s(:].*", "", name.strip()), paragraph)
    return packages


def closure(ours, packages):
    chosen = {fields(paragraph)["Package"]: paragraph for paragraph in ours}
    waiting = list(chosen.values())
    while waiting:
        for names in needed(waiting.pop()):
            if any(name in chosen for name in names):
                continue
            found = next((packages[name] for name in names if name in packages), None)
            if found is None:
                raise SystemExit(f"sbom_root: none of {', '.join(names)} is installed here")
            name = fields(found)["Package"]
            if name not in chosen:
                chosen[name] = found
                waiting.append(found)
    return chosen


def main():
    root, debs = pathlib.Path(sys.argv[1]), sys.argv[2:]
    ours = []
    for deb in debs:
        control = output("dpkg-deb", "-f", deb).strip()
        ours.append(control.replace("\n", "\n" + STATUS, 1))
    chosen = closure(ours, installed())
    status = root / "var/lib/dpkg/status"
    status.parent.mkdir(parents=True, exist_ok=True)
    text = "\n\n".join(chosen[name].strip("\n") for name in sorted(chosen)) + "\n"
    status.write_text(text, encoding="utf-8")
    print(f"{len(chosen)} packages")


if __name__ == "__main__":
    main()
