"""What the released programs are protected by, as their own files say it."""

import os
import unittest

from harness import BIN, run


@unittest.skipUnless(
    os.environ.get("UPLINK_HARDENED") == "1", "this build is for editing or for a sanitizer"
)
class Hardening(unittest.TestCase):
    def programs(self):
        for name in ("uplinkd", "uplinkctl", "uplink-fleet"):
            yield name, BIN / name

    def test_the_programs_are_position_independent_and_bound_at_their_start(self):
        for name, path in self.programs():
            with self.subTest(name):
                self.assertRegex(run("readelf", "-hW", path).stdout, r"Type:\s+DYN ")
                self.assertIn("GNU_RELRO", run("readelf", "-lW", path).stdout)
                dynamic = run("readelf", "-dW", path).stdout
                self.assertRegex(dynamic, r"FLAGS_1.*\bNOW\b.*\bPIE\b")

    def test_stack_bounds_and_containers_are_checked(self):
        for name, path in self.programs():
            with self.subTest(name):
                symbols = run("readelf", "-W", "--dyn-syms", path).stdout
                self.assertIn("__stack_chk_fail", symbols)
                self.assertRegex(symbols, r"__(memcpy|memmove|read|snprintf|vsnprintf)_chk")
                self.assertIn("__glibcxx_assert_fail", symbols)


if __name__ == "__main__":
    unittest.main()
