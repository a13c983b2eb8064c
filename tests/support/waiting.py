"""Waits for what a process will show. Needs no programs of ours, so that every suite may use it."""

import subprocess
import time

LOOK_SECONDS = 0.02


def wait_until(process, condition, seconds, what, every=LOOK_SECONDS):
    """Waits until `condition` gives something true, while `process` lives."""
    deadline = time.monotonic() + seconds
    while True:
        found = condition()
        if found:
            return found
        if time.monotonic() > deadline:
            raise AssertionError(f"not within {seconds} s: {what}")
        try:
            code = process.wait(every)
        except subprocess.TimeoutExpired:
            continue
        raise AssertionError(f"{process.args[0]} ended with {code} while waiting: {what}")
