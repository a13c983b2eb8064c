"""The same package under a later version, as an upgrade would bring it."""

import re

from machine import run


def repacked(package, folder, version, changes=()):
    """Writes it to `folder`. `changes`: (path in the package, text that is appended)."""
    tree = folder / "tree"
    run("rm", "-rf", tree)
    run("dpkg-deb", "-R", package, tree)
    control = tree / "DEBIAN/control"
    text = control.read_text(encoding="utf-8")
    old = re.search(r"(?m)^Version: (.*)$", text).group(1)
    control.write_text(text.replace(old, version), encoding="utf-8")
    for path, addition in changes:
        with open(tree / path, "a", encoding="utf-8") as file:
            file.write(addition)
    run("sh", "-c", 'cd "$0" && find . -type f ! -path "./DEBIAN/*" -printf "%P\\0" | xargs -0 md5sum >DEBIAN/md5sums',
        tree)  # fmt: skip
    made = folder / package.name.replace(f"_{old}_", f"_{version}_")
    run("dpkg-deb", "-Zgzip", "-z1", "--root-owner-group", "-b", tree, made)
    run("rm", "-rf", tree)
    return made
