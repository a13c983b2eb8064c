"""The demo as a new user runs it, in a folder of the test's."""

import os
import pathlib
import re
import unittest

from harness import BIN, SOURCE, EndToEnd, run


def script(path, lines):
    path.write_text(f"#!/bin/sh\n{lines}\n", encoding="utf-8")
    path.chmod(0o755)


class Demo(EndToEnd):
    def demo(self, *flags, code=0, programs=BIN):
        env = dict(os.environ, UPLINK_BIN_DIR=str(programs), UPLINK_DEMO_DIR=str(self.folder / "demo"))
        return run(SOURCE / "tools/dev/demo.sh", *flags, code=code, timeout=120, env=env)

    def left_running(self):
        """Processes that were started with the demo's configuration and still live."""
        mine = str(self.folder / "demo/uplinkd.toml").encode()
        found = []
        for process in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                if mine in process.read_bytes():
                    found.append(process)
            except OSError:
                continue
        return found

    def with_fleet(self, lines):
        """Programs whose uplink-fleet is replaced."""
        programs = self.folder / "bin"
        programs.mkdir()
        for name in ("uplinkd", "uplinkctl"):
            (programs / name).symlink_to(BIN / name)
        script(programs / "uplink-fleet", lines)
        return programs

    def test_it_adds_up_and_leaves_nothing_running(self):
        done = self.demo("--for", "3s", "--robots", "5", "--seed", "7")
        self.assertIn("verification: all agree", done.stdout)
        self.assertIn("/api/v1/robots", done.stdout)
        self.assertNotIn("MISMATCH", done.stdout)
        self.assertIn("forwards due = the rest", done.stdout)
        self.assertIn("the same of robots that joined late", done.stdout)
        self.assertEqual(self.left_running(), [])

    def test_through_gateways_it_adds_up(self):
        done = self.demo("--for", "3s", "--robots", "12", "--gateways", "2")
        self.assertIn("verification: all agree", done.stdout)
        self.assertNotIn("MISMATCH", done.stdout)

    def test_on_postgresql_it_adds_up_and_leaves_nothing_running(self):
        done = self.demo("--for", "3s", "--robots", "5", "--store", "postgres")
        self.assertIn("verification: all agree", done.stdout)
        self.assertEqual(self.left_running(), [])
        self.assertFalse((self.folder / "demo/postgres.state").exists())

    def test_with_twins_behind_a_broker_it_adds_up_and_leaves_nothing_running(self):
        done = self.demo("--cyberwave", "--for", "3s", "--robots", "5", "--seed", "7")
        self.assertIn("verification: all agree", done.stdout)
        self.assertNotIn("MISMATCH", done.stdout)
        self.assertIn("received = the rest", done.stdout)
        self.assertEqual(self.left_running(), [])

    def test_with_drones_that_call_it_adds_up_and_leaves_nothing_running(self):
        done = self.demo("--uncrew", "--for", "3s", "--robots", "5", "--seed", "7")
        self.assertIn("verification: all agree", done.stdout)
        self.assertNotIn("MISMATCH", done.stdout)
        self.assertIn("alerts raised and cleared", done.stdout)
        self.assertEqual(self.left_running(), [])

    def test_a_mismatch_is_passed_on(self):
        self.demo(code=3, programs=self.with_fleet("exit 3"))
        self.assertEqual(self.left_running(), [])

    def test_a_server_that_ends_badly_fails_the_demo(self):
        programs = self.with_fleet("exit 0")
        (programs / "uplinkd").unlink()
        badly = f"""{BIN}/uplinkd "$@" & pid=$!
trap 'kill -TERM $pid; wait $pid; exit 7' TERM
wait $pid"""
        script(programs / "uplinkd", badly)
        done = self.demo(code=1, programs=programs)
        self.assertIn("uplinkd ended with 7", done.stderr)
        self.assertEqual(self.left_running(), [])

    def test_wrong_use_ends_with_2(self):
        for flags in (["--store", "oracle"], ["--robots", "0"],
                      ["--for", "soon"], ["--for"], ["--nonsense"], ["--cyberwave", "--uncrew"]):  # fmt: skip
            with self.subTest(flags):
                self.demo(*flags, code=2)

    def test_it_takes_as_many_robots_as_the_fleet(self):
        refused = self.demo("--robots", "50001", code=2)
        self.assertEqual(refused.stderr, "dev: demo: --robots takes a number from 1 to 50000\n")
        self.assertIn("50000", run(BIN / "uplink-fleet", "--robots", "50001", code=2).stderr)
        self.demo("--robots", "50000", code=3, programs=self.with_fleet("exit 3"))


class Help(unittest.TestCase):
    """What ./dev says of itself: no verb runs."""

    def dev(self, *arguments, code=0):
        return run(SOURCE / "dev", *arguments, code=code)

    def verbs(self):
        """Each verb that the usage names."""
        heads = re.findall(r"^  ([a-z][a-z0-9-]*(?:, [a-z0-9-]+)*)", self.dev("help").stdout, re.MULTILINE)
        return sorted({verb for head in heads for verb in head.split(", ")})

    def test_each_verb_shows_its_own_lines(self):
        verbs = self.verbs()
        self.assertIn("chart-test", verbs)
        self.assertGreater(len(verbs), 20)
        usage = self.dev("help").stdout
        for verb in verbs:
            with self.subTest(verb):
                lines = self.dev(verb, "--help").stdout
                self.assertIn(verb, lines.splitlines()[0])
                self.assertTrue(set(lines.splitlines()) <= set(usage.splitlines()), lines)
                self.assertLess(len(lines.splitlines()), 16, "of this verb alone")

    def test_the_demo_names_its_flags(self):
        shown = self.dev("demo", "--robots", "5", "--help").stdout
        for flag in ("--for", "--robots", "--gateways", "--store", "--seed", "--cyberwave", "--uncrew"):
            self.assertIn(flag, shown)
        self.assertNotIn("--kills", shown)

    def test_an_unknown_verb_has_no_help(self):
        self.assertIn("unknown verb: nonsense", self.dev("nonsense", "--help", code=2).stderr)


if __name__ == "__main__":
    unittest.main()
