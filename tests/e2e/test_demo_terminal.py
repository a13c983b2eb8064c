"""The demo and the build as a person sees them: in a terminal, and in a file."""

import io
import os
import pathlib
import re
import subprocess
import sys
import unittest
from xml.etree import ElementTree

from harness import BIN, SOURCE, EndToEnd, run

sys.path.insert(0, str(SOURCE / "tools/dev"))
import build_progress  # noqa: E402
import picture  # noqa: E402
from screen import Screen  # noqa: E402

COLUMNS = 100
ROWS = 120
COLOUR = re.compile(rb"\x1b\[[0-9;]*m")
UP = re.compile(rb"\x1b\[\d+A")
STEPS = 100
# Sourced as the verbs of ./dev do it.
WITH_PROGRESS = 'set -euo pipefail; cd "$1"; source tools/dev/lib.sh; with_progress release ninja -C "$2"'


class Terminal:
    """A command that ran to its end in a terminal: its bytes, its exit code and the last screen."""

    def __init__(self, command, columns=COLUMNS, rows=ROWS, **environment):
        self.written = bytearray()
        whole = {**os.environ, "TERM": "xterm", **environment}
        if "NO_COLOR" not in environment:
            whole.pop("NO_COLOR", None)
        self.code = picture.record([str(each) for each in command], columns, rows, whole, self.written.extend)
        self.screen = Screen(columns, rows)
        self.screen.take(bytes(self.written))
        self.lines = self.screen.text()
        self.text = "\n".join(self.lines)


class DemoTerminal(EndToEnd):
    """The whole demo, once for each sort of terminal."""

    COMMAND = (SOURCE / "tools/dev/demo.sh", "--for", "3s", "--robots", "5", "--seed", "7")

    def places(self):
        return {"UPLINK_BIN_DIR": str(BIN), "UPLINK_DEMO_DIR": str(self.folder / "demo")}

    def test_in_a_terminal_it_has_colours_and_one_table_that_updates(self):
        seen = Terminal(self.COMMAND, **self.places())
        self.assertEqual(seen.code, 0, seen.text)
        self.assertEqual(
            seen.lines[0],
            "demo: runs a server and 5 robots for 3s, then checks every message; that takes about 13 s",
        )
        self.assertIn(b"\x1b[32mok\x1b[0m", seen.written)
        self.assertIn(b"\x1b[32mverification: all agree\x1b[0m", seen.written)
        self.assertGreaterEqual(len(UP.findall(bytes(seen.written))), 3, "updates of the table")
        self.assertIn(b"robots send: 2 of 3 s", seen.written)
        # The report stands in the place of the table.
        self.assertNotIn("robots send", seen.text)
        self.assertNotIn("streams broken off", seen.text)
        self.assertIn("verification: all agree", seen.lines)

    def test_the_verification_is_aligned(self):
        seen = Terminal(self.COMMAND, **self.places())
        first = next(i for i, line in enumerate(seen.lines) if line.startswith("what "))
        rows = seen.lines[first : seen.lines.index("", first)]
        self.assertGreater(len(rows), 30)
        bars = {tuple(i for i, each in enumerate(line) if each in "|+") for line in rows}
        self.assertEqual(len(bars), 1, rows)

    def test_without_a_terminal_nothing_escapes(self):
        done = run(*self.COMMAND, timeout=120, env={**os.environ, "TERM": "xterm", **self.places()})
        self.assertNotIn("\x1b", done.stdout + done.stderr)
        self.assertNotIn("\r", done.stdout + done.stderr)
        self.assertTrue(done.stdout.startswith("demo: runs a server"), done.stdout)
        self.assertRegex(done.stderr, r"\d s  \d online  \d+ messages/s")

    def test_no_color_leaves_the_updates(self):
        seen = Terminal(self.COMMAND, NO_COLOR="1", **self.places())
        self.assertEqual(COLOUR.findall(bytes(seen.written)), [])
        self.assertTrue(UP.search(seen.written))
        self.assertIn("verification: all agree", seen.lines)

    def test_a_dumb_terminal_gets_plain_lines(self):
        seen = Terminal(self.COMMAND, TERM="dumb", **self.places())
        self.assertNotIn(b"\x1b", seen.written)
        self.assertRegex(seen.text, r"\d s  \d online  \d+ messages/s")
        self.assertIn("verification: all agree", seen.lines)

    def test_the_last_screen_becomes_a_picture_without_the_machines_paths(self):
        recording = self.folder / "recording"
        command = (SOURCE / "tools/dev/picture.py", "record", recording, *self.COMMAND)
        run(*command, timeout=120, env={**os.environ, **self.places()})
        draw = (command[0], "draw", "--title", "./dev demo", "--leave-out", "17-26", recording)
        drawn = run(*draw).stdout
        self.assertEqual(drawn, run(*draw).stdout, "the same recording gives the same picture")
        texts = "\n".join(ElementTree.fromstring(drawn).itertext())
        self.assertIn("$ ./dev demo", texts)
        self.assertIn("verification: all agree", texts)
        self.assertNotIn(str(SOURCE), texts)


class BuildProgress(EndToEnd):
    """ninja's output in the words of ./dev build, with a build of the test's own."""

    def build(self, steps=STEPS, broken=False, warns=False):
        """A folder with a build of so many steps."""
        folder = self.folder / "build"
        folder.mkdir()
        command = "echo 'a.cc:1: warning: odd' && touch $out" if warns else "touch $out"
        lines = ["rule step", f"  command = {command}", "rule breaks"]
        lines += ["  command = echo 'b.cc:7: error: first line'; echo '  second line'; exit 1"]
        lines += [f"build {number}.out: step" for number in range(steps)]
        if broken:
            lines += ["build broken.out: breaks " + " ".join(f"{number}.out" for number in range(steps))]
        (folder / "build.ninja").write_text("\n".join(lines) + "\n", encoding="utf-8")
        return ["bash", "-c", WITH_PROGRESS, "bash", str(SOURCE), str(folder)]

    def in_a_file(self, command):
        return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)

    def test_in_a_terminal_it_is_one_line(self):
        seen = Terminal(self.build())
        self.assertEqual(seen.code, 0)
        self.assertIn(b"build release: 50 %, 50 of 100 steps", seen.written)
        self.assertRegex(seen.text, r"\Abuild release: 100 steps in \d+ s\n*\Z")

    def test_in_a_narrow_terminal_it_is_one_line_too(self):
        seen = Terminal(self.build(), columns=40)
        self.assertRegex(seen.text, r"\Abuild release: 100 steps in \d+ s\n*\Z")

    def test_without_a_terminal_it_is_a_line_per_tenth(self):
        done = self.in_a_file(self.build())
        self.assertEqual((done.returncode, done.stdout), (0, ""))
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 10, done.stderr)
        self.assertEqual(lines[0], "build release: 10 %, 10 of 100 steps")
        self.assertRegex(lines[-1], r"^build release: 100 steps in \d+ s$")
        self.assertNotIn("\x1b", done.stderr)

    def test_what_is_left_is_estimated_once_enough_is_done(self):
        now, out = [0.0], io.StringIO()
        progress = build_progress.Progress("dev", out, True, lambda: 200, lambda: now[0])
        for seconds, step in ((9, "50/100"), (60, "4/100"), (60, "10/100"), (600, "99/100")):
            now[0] = seconds
            progress.take(f"[[{step}]] Building CXX object server/CMakeFiles/uplink_x.dir/run/app.cc.o")
        self.assertEqual(
            out.getvalue().split(build_progress.CLEAR)[1:],
            [
                "build dev: 50 %, 50 of 100 steps  server/run/app.cc",
                "build dev: 4 %, 4 of 100 steps  server/run/app.cc",
                "build dev: 10 %, 10 of 100 steps, about 9 min left  server/run/app.cc",
                "build dev: 99 %, 99 of 100 steps, under a minute left  server/run/app.cc",
            ],
        )

    def test_nothing_to_build_says_nothing(self):
        command = self.build()
        self.in_a_file(command)
        self.assertEqual(self.in_a_file(command).stderr, "")
        self.assertEqual("".join(Terminal(command).lines), "")

    def test_a_broken_build_shows_its_error_whole(self):
        command = self.build(broken=True)
        done = self.in_a_file(command)
        self.assertEqual(done.returncode, 1)
        self.assertIn("FAILED: broken.out", done.stderr)
        self.assertIn("b.cc:7: error: first line\n  second line\n", done.stderr)
        self.assertNotIn("steps in", done.stderr)
        seen = Terminal(command)
        self.assertEqual(seen.code, 1)
        self.assertIn("b.cc:7: error: first line\n  second line\n", seen.text)
        self.assertNotIn("steps in", seen.text)

    def test_a_warning_is_shown_whole_and_the_line_goes_on(self):
        seen = Terminal(self.build(steps=3, warns=True))
        self.assertEqual(seen.text.count("a.cc:1: warning: odd\n"), 3)
        self.assertRegex(seen.text, r"build release: 3 steps in \d+ s\n*\Z")

    def test_a_demo_whose_build_fails_ends_with_its_error(self):
        # A tree in which cmake and ninja are the test's.
        programs = self.folder / "programs"
        programs.mkdir()
        for name, text in (("cmake", "exit 0"), ("ninja", "echo 'a.cc:1: error: broken'; exit 1")):
            (programs / name).write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
            (programs / name).chmod(0o755)
        tree = self.folder / "tree"
        (tree / "tools").mkdir(parents=True)
        # The script finds its tree by its own place, so it is copied.
        run("cp", "-r", SOURCE / "tools/dev", tree / "tools/dev")
        done = subprocess.run(
            [tree / "tools/dev/demo.sh", "--for", "3s"], capture_output=True, text=True, timeout=60, check=False,
            env={"PATH": f"{programs}:{os.environ['PATH']}", "UPLINK_DEMO_DIR": str(self.folder / "demo")},
        )  # fmt: skip
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("first build about 20 min on two cores; later seconds", done.stdout.splitlines()[0])
        self.assertIn("a.cc:1: error: broken\n", done.stderr)
        self.assertFalse(pathlib.Path(self.folder / "demo").exists())


class Picture(unittest.TestCase):
    """What a recording becomes."""

    def screen(self, data, columns=20, rows=5):
        screen = Screen(columns, rows)
        for byte in data:
            screen.take(bytes([byte]))
        return screen.text()

    def test_what_was_written_over_is_gone(self):
        self.assertEqual(self.screen(b"one\r\ntwo\r\n\r\x1b[2AONE\x1b[K\r\n\x1b[J"), ["ONE", "", ""])
        self.assertEqual(self.screen(b"abc\rd\x1b[K"), ["d"])
        self.assertEqual(self.screen("caf\u00e9".encode()), ["caf\u00e9"])

    def test_a_line_that_is_too_long_goes_on_below(self):
        self.assertEqual(self.screen(b"abcde", columns=3), ["abc", "de"])

    def test_what_scrolled_out_cannot_be_written_over(self):
        self.assertEqual(self.screen(b"1\r\n2\r\n3\r\n\x1b[9Ax", rows=2), ["1", "2", "x", ""])

    def test_an_unknown_sequence_is_an_error(self):
        for data in (b"\x1b[2J", b"\x1b[5m", b"\x1b]0;title\x07"):
            with self.subTest(data), self.assertRaises(ValueError):
                self.screen(data)

    def test_colours_and_places_are_those_of_the_screen(self):
        lines = picture.last_lines(b"a  \x1b[32mok\x1b[0m\r\n  \x1b[1m<b>\x1b[0m\r\n\r\n", 20, 5)
        root = ElementTree.fromstring(picture.svg_of(lines, "./dev demo"))
        names = ("x", "y", "fill", "font-weight")
        found = [(each.text, *(each.get(name) for name in names)) for each in root[2:]]
        self.assertEqual(
            found,
            [
                ("$ ./dev demo", "16.0", "29", picture.FOREGROUND, None),
                ("a", "16.0", "47", picture.FOREGROUND, None),
                ("ok", "39.4", "47", picture.COLOURS[1], None),
                ("<b>", "31.6", "65", picture.HEADING, "bold"),
            ],
        )

    def test_lines_that_are_left_out_are_counted(self):
        lines = picture.last_lines(b"1\r\n2\r\n3\r\n4\r\n5\r\n", 20, 9)
        short = picture.shortened(lines, [(5, 5), (2, 3)])
        texts = ["".join(character for character, _ in line) for line in short]
        self.assertEqual(texts, ["1", "... 2 lines ...", "4", "... 1 lines ..."])
        for ranges in ([(0, 1)], [(3, 2)], [(5, 6)], [(1, 3), (3, 4)]):
            with self.subTest(ranges), self.assertRaises(ValueError):
                picture.shortened(lines, ranges)


if __name__ == "__main__":
    unittest.main()
