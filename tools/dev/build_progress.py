#!/usr/bin/env python3
"""build_progress.py WHAT: reads ninja's output and shows on standard error how far the build is.

On a terminal that is one line which updates; elsewhere a line per tenth. Whatever else ninja prints
(errors, warnings) is shown whole. ninja runs with NINJA_STATUS set to STATUS.
"""

import os
import re
import signal
import sys
import time

STATUS = "[[%f/%t]] "
STEP = re.compile(r"^\[\[(\d+)/(\d+)\]\] (.*)$")
COMPILED = re.compile(r"Building C(?:XX)? object (.*/)?CMakeFiles/[^/]+\.dir/(.+)\.o$")
# Before the build ninja looks whether CMakeLists.txt files changed: these are no steps of it.
CONFIGURES = re.compile(r"^Re-(?:checking globbed directories|running CMake)")
# Says nothing that the progress does not say.
LEFT_OUT = re.compile(r"^ninja: (Entering directory|no work to do)")
# ninja counts a step that failed as done.
FAILED = re.compile(r"^(FAILED: |ninja: (build stopped|error|fatal))")
CLEAR = "\r\x1b[K"
PARTS = 10
# Before that, what is left cannot be estimated.
ESTIMATE_AFTER_SECONDS = 10
ESTIMATE_AFTER_SHARE = 0.05


def updates(stream, environment):
    """Whether lines can be overwritten there."""
    return stream.isatty() and environment.get("TERM", "dumb") not in ("", "dumb")


def duration(seconds):
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def source_of(description):
    """The source of a step that compiles one, else the step in ninja's words."""
    compiled = COMPILED.match(description)
    return "".join(filter(None, compiled.groups())) if compiled else description


class Progress:
    """Confined to one thread; `clock` gives seconds."""

    def __init__(self, what, out, in_place, columns, clock):
        self.what = what
        self.out = out
        self.in_place = in_place
        self.columns = columns
        self.clock = clock
        self.began = clock()
        self.done = self.total = self.told = 0
        self.failed = False

    def take(self, line):
        step = STEP.match(line)
        if step and CONFIGURES.match(step.group(3)):
            self.write(f"{self.clear()}build {self.what}: configure" if self.in_place else "")
        elif step:
            self.done, self.total = int(step.group(1)), max(int(step.group(2)), 1)
            self.show(source_of(step.group(3)))
        elif not LEFT_OUT.match(line):
            self.failed |= bool(FAILED.match(line))
            self.write(f"{self.clear()}{line}\n")

    def show(self, source):
        if self.in_place:
            # The last column stays free: some terminals would go on to the next line.
            self.write(self.clear() + f"{self.state()}{self.left()}  {source}"[: self.columns() - 1])
        elif self.told < self.done * PARTS // self.total < PARTS:
            self.told = self.done * PARTS // self.total
            self.write(f"{self.state()}\n")

    def state(self):
        return f"build {self.what}: {100 * self.done // self.total} %, {self.done} of {self.total} steps"

    def left(self):
        """How long the rest takes if it goes on like this."""
        spent = self.clock() - self.began
        if spent < ESTIMATE_AFTER_SECONDS or self.done < ESTIMATE_AFTER_SHARE * self.total:
            return ""
        minutes = round(spent * (self.total - self.done) / self.done / 60)
        return f", about {minutes} min left" if minutes else ", under a minute left"

    def clear(self):
        return CLEAR if self.in_place else ""

    def end(self):
        """Says how long it took, unless nothing was done or something failed."""
        finished = self.done > 0 and self.done == self.total and not self.failed
        took = f"build {self.what}: {self.total} steps in {duration(self.clock() - self.began)}\n"
        self.write(self.clear() + (took if finished else ""))

    def write(self, text):
        self.out.write(text)
        self.out.flush()


def columns_of(stream):
    try:
        return os.get_terminal_size(stream.fileno()).columns or 80
    except OSError:
        return 80


def main():
    # An interrupt on the terminal is for ninja, whose last words follow.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    out = sys.stderr
    progress = Progress(
        sys.argv[1], out, updates(out, os.environ), lambda: columns_of(out), time.monotonic
    )
    for line in open(sys.stdin.fileno(), encoding="utf-8", errors="replace", closefd=False):
        progress.take(line.rstrip("\n"))
    progress.end()


if __name__ == "__main__":
    main()
