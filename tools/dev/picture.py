#!/usr/bin/env python3
"""picture.py record [--columns 100] [--rows 100] FILE COMMAND ...: runs a command in a terminal of that size
and keeps every byte that it writes; its exit code is the command's.

picture.py draw [--columns 100] [--rows 100] [--title TEXT] [--leave-out FIRST-LAST ...] FILE: the last
screen of a recording as SVG on standard output: the same for the same recording. In place of lines that are
left out, counted from 1, a line says how many they are.

docs/demo.svg:
  tools/dev/picture.py record build/demo.terminal ./dev demo
  tools/dev/picture.py draw --title './dev demo' --leave-out 18-28 --leave-out 42-64 --leave-out 74-85 \
    build/demo.terminal >docs/demo.svg
"""

import argparse
import fcntl
import itertools
import os
import pathlib
import pty
import struct
import sys
import termios
from xml.sax.saxutils import escape, quoteattr

from screen import PLAIN, Screen

READ_BYTES = 65536
FONT = "ui-monospace,SFMono-Regular,Menlo,Consolas,DejaVu Sans Mono,monospace"
FONT_SIZE = 13
# A character of these fonts is 0.6 of their size wide; textLength makes it so for any other.
CHARACTER = 7.8
LINE = 18
MARGIN = 16
BACKGROUND = "#1b1f24"
FOREGROUND = "#d8dee4"
# Red to white.
COLOURS = ("#ff7b72", "#7ee787", "#e3b341", "#79c0ff", "#d2a8ff", "#76e3ea", "#ffffff")
HEADING = "#ffffff"
FAINT = "#8b949e"


def record(command, columns, rows, environment, take):
    """Runs a command in a terminal and gives its exit code; `take` gets what it writes."""
    child, master = pty.fork()
    if child == 0:
        # Before the program looks.
        fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
        os.execvpe(command[0], command, environment)
    while True:
        try:
            data = os.read(master, READ_BYTES)
        except OSError:
            # So a terminal ends when its last program does.
            data = b""
        if not data:
            break
        take(data)
    os.close(master)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def last_lines(recording, columns, rows):
    """The lines of the last screen, and those above it, without empty ones at the end."""
    screen = Screen(columns, rows)
    screen.take(recording)
    lines = list(screen.lines)
    while lines and not any(character.strip() for character, _ in lines[-1]):
        lines.pop()
    return lines


def shortened(lines, ranges):
    """The lines, with one in place of those of each range (first, last), counted from 1."""
    kept, at = [], 0
    for first, last in sorted(ranges):
        if not at < first <= last <= len(lines):
            raise ValueError(f"lines {first} to {last} of {len(lines)} cannot be left out after line {at}")
        kept += lines[at : first - 1]
        kept.append([(character, None) for character in f"... {last - first + 1} lines ..."])
        at = last
    return kept + lines[at:]


def range_of(text):
    first, last = text.split("-")
    return int(first), int(last)


def colour_of(style):
    if style is None:
        return FAINT
    if style.colour:
        return COLOURS[style.colour - 1]
    return HEADING if style.bold else FOREGROUND


def runs_of(line):
    """(column, style, text) of what is neither blank nor painted differently."""
    column = 0
    for style, cells in itertools.groupby(line, key=lambda cell: cell[1]):
        text = "".join(character for character, _ in cells)
        bare = text.strip()
        if bare:
            yield column + len(text) - len(text.lstrip()), style, bare
        column += len(text)


def svg_of(lines, title):
    columns = max((len(line) for line in lines), default=1)
    width = round(2 * MARGIN + columns * CHARACTER)
    height = 2 * MARGIN + LINE * (len(lines) + 1)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
        f'height="{height}" role="img" font-family={quoteattr(FONT)} font-size="{FONT_SIZE}">',
        f"<title>{escape(title)}</title>",
        f'<rect width="{width}" height="{height}" rx="8" fill="{BACKGROUND}"/>',
    ]
    prompt = [(character, PLAIN) for character in f"$ {title}"]
    for number, line in enumerate([prompt, *lines]):
        for column, style, text in runs_of(line):
            weight = ' font-weight="bold"' if style is not None and style.bold else ""
            out.append(
                f'<text xml:space="preserve" x="{MARGIN + column * CHARACTER:.1f}" '
                f'y="{MARGIN + FONT_SIZE + LINE * number}" fill="{colour_of(style)}"{weight} '
                f'textLength="{len(text) * CHARACTER:.1f}">{escape(text)}</text>'
            )
    return "\n".join([*out, "</svg>"]) + "\n"


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    recording = verbs.add_parser("record", usage=__doc__)
    drawing = verbs.add_parser("draw", usage=__doc__)
    for verb in (recording, drawing):
        verb.add_argument("file", type=pathlib.Path)
        verb.add_argument("--columns", type=int, default=100)
        verb.add_argument("--rows", type=int, default=100)
    recording.add_argument("command", nargs=argparse.REMAINDER)
    drawing.add_argument("--title", default="")
    drawing.add_argument("--leave-out", type=range_of, action="append", default=[])
    arguments = parser.parse_args()
    if arguments.verb == "record":
        with arguments.file.open("wb") as out:
            environment = {"TERM": "xterm", **os.environ}
            sys.exit(record(arguments.command, arguments.columns, arguments.rows, environment, out.write))
    lines = last_lines(arguments.file.read_bytes(), arguments.columns, arguments.rows)
    sys.stdout.write(svg_of(shortened(lines, arguments.leave_out), arguments.title))


if __name__ == "__main__":
    main()
