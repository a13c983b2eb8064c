"""Waiting for other programs: what is found, what ended, what is late."""

import subprocess
import unittest

from waiting import wait_for

SECONDS = 30


class Waiting(unittest.TestCase):
    def setUp(self):
        # It ends with its input.
        self.process = subprocess.Popen(["cat"], stdin=subprocess.PIPE)
        self.addCleanup(self.process.wait, SECONDS)
        self.addCleanup(self.process.stdin.close)

    def test_gives_what_the_condition_found(self):
        looks = iter([None, "", "found"])
        self.assertEqual(wait_for(lambda: next(looks), SECONDS, "it", [self.process.pid], every=0.001), "found")

    def test_a_program_that_ends_ends_the_wait(self):
        def look():
            self.process.stdin.close()

        with self.assertRaisesRegex(AssertionError, "ended while waiting: it"):
            wait_for(look, SECONDS, "it", [self.process.pid], every=SECONDS)

    def test_a_program_that_is_gone_is_named(self):
        self.process.stdin.close()
        self.process.wait(SECONDS)
        with self.assertRaisesRegex(AssertionError, f"process {self.process.pid} does not run"):
            wait_for(lambda: True, SECONDS, "it", [self.process.pid])

    def test_what_does_not_come_is_named(self):
        with self.assertRaisesRegex(AssertionError, "not within -1 s: it"):
            wait_for(lambda: False, -1, "it", [self.process.pid])


if __name__ == "__main__":
    unittest.main()
