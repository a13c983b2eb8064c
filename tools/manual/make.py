#!/usr/bin/env python3
"""Writes the manual pages and the completion of shells, made from the programs' own help.

    make.py BIN OUT VERSION: what `cmake --install` puts below share/. Standard library only.
"""

import pathlib
import re
import shutil
import sys

import completion
import program_pages
import settings_page
import tree

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ("uplinkd", "uplinkctl", "uplink-fleet")
RELEASED = re.compile(r"^## [\d.]+ - (\d{4}-\d{2}-\d{2})$", re.MULTILINE)


def main():
    programs_folder, out, version = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
    shutil.rmtree(out, ignore_errors=True)
    programs = {name: tree.read(programs_folder / name) for name in PROGRAMS}
    # The date of the newest release that has one; the same tree makes the same pages.
    released = RELEASED.search((SOURCE / "CHANGELOG.md").read_text(encoding="utf-8"))
    date = released.group(1) if released else ""
    exit_codes = (SOURCE / "docs/reference/exit-codes.md").read_text(encoding="utf-8")
    for page in program_pages.pages(programs, version, date, exit_codes):
        page.write(out / "man")
    example = (SOURCE / "deploy/uplinkd.toml").read_text(encoding="utf-8")
    settings_page.settings_page(example, version, date).write(out / "man")
    for folder, prefix, write in (
        ("bash-completion/completions", "", completion.bash),
        ("zsh/vendor-completions", "_", completion.zsh),
    ):
        (out / folder).mkdir(parents=True)
        for name, program in programs.items():
            (out / folder / (prefix + name)).write_text(write(program), encoding="utf-8")


if __name__ == "__main__":
    main()
