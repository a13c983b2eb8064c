#!/usr/bin/env python3
"""Writes the table of values in the chart's README.md from the comments of values.yaml.

A comment that begins with `# --` is about the key below it. With --check nothing is written: exit 1 if
the page is not what the comments say, or a value has no comment.
"""

import argparse
import pathlib
import re
import sys

CHART = pathlib.Path(__file__).resolve().parents[2] / "deploy/helm/uplinkd"
BEGIN, END = "<!-- values -->\n", "<!-- end of values -->\n"
KEY = re.compile(r"^( *)([A-Za-z][A-Za-z0-9]*):(?: (.*))?$")
COMMENT = re.compile(r"^ *# ?(.*)$")
INDENT = 2


class Wrong(Exception):
    """values.yaml has a value that is not explained."""


def value_of(lines, at, indent):
    """The default as people write it on one line; `...` for what takes more."""
    text = lines[at].split(":", 1)[1].strip()
    if text:
        return text
    below = [line for line in lines[at + 1 :] if line.strip()]
    deeper = below and len(below[0]) - len(below[0].lstrip()) > indent
    return "..." if deeper else '""'


def rows(text):
    """Key and default, and comment, of each value that has one or that is a leaf."""
    lines, path, about, inside = text.split("\n"), [], None, None
    for at, line in enumerate(lines):
        comment, key = COMMENT.match(line), KEY.match(line)
        if comment:
            said = comment.group(1)
            if said.startswith("-- "):
                about = said[3:]
            elif about is not None:
                about += " " + said
        elif key:
            depth = len(key.group(1)) // INDENT
            if inside is not None and depth > inside:
                continue
            inside = None
            path[depth:] = [key.group(2)]
            value = value_of(lines, at, len(key.group(1)))
            if about is not None:
                yield ".".join(path), value, about
                if value == "...":
                    inside = depth
            elif value != "...":
                raise Wrong(f"values.yaml:{at + 1}: {'.'.join(path)} has no comment")
            about = None


def table(text):
    """The rows as a table of Markdown."""
    made = ["| value | default | meaning |", "| --- | --- | --- |"]
    for key, value, about in rows(text):
        shown = "see values.yaml" if value == "..." else f"`{value}`"
        made.append(f"| `{key}` | {shown} | {about} |")
    return "\n".join(made) + "\n"


def page(readme, values):
    """README.md with the table of these values in its place."""
    before, rest = readme.split(BEGIN)
    return before + BEGIN + "\n" + table(values) + "\n" + END + rest.split(END)[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--chart", type=pathlib.Path, default=CHART)
    parser.add_argument("--check", action="store_true", help="write nothing")
    options = parser.parse_args()
    path = options.chart / "README.md"
    readme = path.read_text(encoding="utf-8")
    try:
        made = page(readme, (options.chart / "values.yaml").read_text(encoding="utf-8"))
    except Wrong as wrong:
        print(wrong, file=sys.stderr)
        return 1
    if not options.check:
        path.write_text(made, encoding="utf-8")
    elif made != readme:
        print(f"{path}: not what values.yaml says: run tools/dev/chart_readme.py", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
