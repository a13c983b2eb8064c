"""Waits for what other programs will show, while they live. Needs no programs of ours, so that every suite may use
it."""

import contextlib
import os
import select
import subprocess
import time

LOOK_SECONDS = 0.02


def wait_until(process, condition, seconds, what, every=LOOK_SECONDS):
    """Waits until `condition` gives something true, while `process`, a child of ours, lives."""
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


def wait_for(condition, seconds, what, watched, every=0.2):
    """Waits until `condition` gives something true, while the processes `watched` (their ids) live."""
    deadline = time.monotonic() + seconds
    with contextlib.ExitStack() as open_things:
        ends = select.poll()
        for pid in watched:
            try:
                handle = os.pidfd_open(pid)
            except OSError as error:
                raise AssertionError(f"process {pid} does not run ({error}) while waiting: {what}") from None
            open_things.callback(os.close, handle)
            # Readable once the process has ended.
            ends.register(handle, select.POLLIN)
        while not (found := condition()):
            if time.monotonic() > deadline:
                raise AssertionError(f"not within {seconds} s: {what}")
            if ends.poll(every * 1000):
                raise AssertionError(f"a process of {list(watched)} ended while waiting: {what}")
        return found
