#!/usr/bin/env python3
"""Checks the rules of the house that no compiler checks. Standard library only.

Each rule is a function that takes a Tree and yields Findings; test_tidy.py shows each to fail and to
pass. A finding names the file, the line and what to do.
"""

import argparse
import pathlib
import sys

import alerts
import deployed
import includes
import prose
import questions
import text
import whole
from tree import Tree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools/dev"))

import reference  # noqa: E402

RULES = (
    includes.direction,
    includes.foreign,
    includes.rooms,
    includes.fleet_rooms,
    includes.front_rooms,
    includes.form,
    text.length,
    text.banned,
    text.words,
    prose.avoided,
    questions.answered,
    alerts.short,
    deployed.versions,
    deployed.ports,
    deployed.sections,
    deployed.readme,
    whole.built,
    whole.targets,
    whole.settings,
    whole.doc_pages,
    whole.links,
    whole.named,
    whole.readmes,
    reference.pages,
)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", default=".")
    tree = Tree(parser.parse_args().root)
    if not tree.cxx:
        print("tidy: the tree holds no C++ file; wrong --root?", file=sys.stderr)
        return 2
    findings = sorted(finding for rule in RULES for finding in rule(tree))
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
