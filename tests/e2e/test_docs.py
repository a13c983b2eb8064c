"""The commands of the operators' pages against a running server with robots: each that only reads ends well."""

import os
import re
import subprocess
import unittest
import urllib.parse

from harness import BIN, SOURCE, EndToEnd, uplinkctl, wait_until

PAGES = ("docs/operate/card.md", "docs/operate/robots.md", "docs/operate/server.md")
# The table of this page has its commands in a column.
TABLE_OF_COMMANDS = "docs/operate/card.md"
BLOCK = re.compile(r"^```(?:sh)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CELL = re.compile(r"^\|[^|]*\| `((?:curl|journalctl|systemctl|uplinkctl|uplinkd) [^`]*)`", re.MULTILINE)
ASSIGNMENT = re.compile(r"^\w+=.*$", re.MULTILINE)
COMMAND_SECONDS = 60
WAIT_SECONDS = 30

ROBOT = "rcan://local.rcan/uplink/synthetic/1.0/robot-0001"
# Beginnings of what is not run, and why. One that begins nothing is an error.
SKIPPED = {
    "systemctl reload": "no service manager runs the server here",
    "uplinkctl doctor": "judges this machine too; test_doctor.py runs it",
    "timedatectl": "asks this machine's service manager",
    "uplinkctl faults acknowledge": "the robots here raise other faults",
    "uplinkctl store forget": "deletes a robot; test_forget.py runs it",
}
# Beginnings of commands, and what their output holds.
ANSWERS = {
    "curl -sS --http2": "grpc-status: 3",
    "curl -s http://127.0.0.1:7480/readyz": '"degraded"',
}
# In the places of programs that a test cannot ask as an operator does.
SHIMS = {
    # Without --fail curl ends well on every status.
    "curl": 'exec /usr/bin/curl --fail --noproxy "*" "$@"',
    "journalctl": 'exec cat "$UPLINK_LOG"',
}


def commands_of(page):
    """What an operator copies: each fenced block, and each command in the table."""
    text = (SOURCE / page).read_text(encoding="utf-8")
    found = [block.strip() for block in BLOCK.findall(text)]
    if page == TABLE_OF_COMMANDS:
        found += CELL.findall(text)
    return found


def without_skipped(command, used):
    """The command without its lines that begin as a skipped one does."""
    kept = []
    for line in command.splitlines():
        beginning = next((each for each in SKIPPED if line.startswith(each)), None)
        if beginning:
            used.add(beginning)
        else:
            kept.append(line)
    return "\n".join(kept)


class Commands(EndToEnd):
    def setUp(self):
        super().setUp()
        # Streams have lines, so that a grep for a robot finds some.
        self.running = self.server('[log]\nlevel = "debug"').start()
        fleet = self.fleet(self.running, "--robots", 5, "--malformed-share", 0.2)
        path = f"/api/v1/quarantine?ruri={urllib.parse.quote(ROBOT, safe='')}"
        wait_until(
            fleet.process, lambda: (self.running.get(path) or {}).get("quarantined"), WAIT_SECONDS, "a rejected message"
        )
        pki = self.running.pki
        uplinkctl("pki", "robot", "--dir", pki, "--name", "r1", "--fleet", "default", "--ruri", ROBOT)
        # As its own, with the port that it got.
        self.settings = self.folder / "served.toml"
        text = (self.folder / "uplinkd.toml").read_text(encoding="utf-8")
        self.settings.write_text(re.sub(r'(?m)^http = .*', f'http = "{self.running.http}"', text), encoding="utf-8")
        self.shims = self.folder / "shims"
        self.shims.mkdir()
        for name, line in SHIMS.items():
            shim = self.shims / name
            shim.write_text(f"#!/bin/sh\n{line}\n", encoding="utf-8")
            shim.chmod(0o755)

    def here(self, command):
        """The command with this server's places, and one of its robots."""
        for there, here in (
            ("127.0.0.1:7480", self.running.http),
            ("HOST:7443", self.running.relay),
            ("/etc/uplinkd/uplinkd.toml", str(self.settings)),
            ("/etc/uplinkd/keys/server.crt", str(self.running.pki / "server.crt")),
            ("rcan://example.org/acme/rover/1.0/r1", ROBOT),
            ("/RURI", f"/{urllib.parse.quote(ROBOT, safe='')}"),
            # Robots here are online and not held back: ask for those, so that filters get rows.
            ("ruri=RURI", f"ruri={urllib.parse.quote(ROBOT, safe='')}"),
            ("presence=offline", "presence=online"),
            ("--presence offline", "--presence online"),
            ("r17", ROBOT.rsplit("/", 1)[-1]),
            ('.heldBack != ""', '.heldBack == ""'),
        ):
            command = command.replace(there, here)
        return command

    def run_here(self, script):
        # In the folder of the keys, which pages name without a path.
        return subprocess.run(
            ["bash", "-eu", "-o", "pipefail", "-c", script], cwd=self.running.pki,
            env={**os.environ, "PATH": f"{self.shims}:{BIN}:{os.environ['PATH']}", "UPLINK_LOG": str(self.running.log),
                 "UPLINKCTL_SERVER": f"http://{self.running.http}"},
            capture_output=True, text=True, timeout=COMMAND_SECONDS, check=False,
        )  # fmt: skip

    def test_each_command_that_only_reads_ends_well(self):
        used, answered = set(), set()
        for page in PAGES:
            commands = commands_of(page)
            self.assertTrue(commands, f"{page} has no commands: the pattern is out of date")
            earlier = ""
            for command in commands:
                kept = without_skipped(command, used)
                # A name that one block sets is used by later ones.
                done = self.run_here(self.here(earlier + kept))
                with self.subTest(page=page, command=command):
                    self.assertEqual(done.returncode, 0, f"{done.stdout[-2000:]}\n{done.stderr}")
                    for beginning, answer in ANSWERS.items():
                        if kept.startswith(beginning):
                            answered.add(beginning)
                            self.assertIn(answer, done.stdout)
                earlier += "".join(f"{line}\n" for line in ASSIGNMENT.findall(kept))
        self.assertEqual(set(SKIPPED) - used, set(), "begins no command: take it off SKIPPED")
        self.assertEqual(set(ANSWERS) - answered, set(), "begins no command: take it off ANSWERS")


class Stop(unittest.TestCase):
    """How long a stop may take is told in one place, and who waits for it waits longer."""

    def number(self, path, pattern):
        return int(re.search(pattern, (SOURCE / path).read_text(encoding="utf-8"), re.MULTILINE).group(1))

    def test_who_stops_the_server_waits_longer(self):
        timeout = self.number("deploy/uplinkd.toml", r'^\[drain\]$[^\[]*^# timeout = "(\d+)s"$')
        after = self.number("docs/operate/server.md", r"exits within `drain\.timeout` and (\d+) s")
        self.assertEqual(after, self.number("deploy/uplinkd.toml", r"the exit comes (\d+) s later"))
        for path, pattern in (
            ("deploy/systemd/uplinkd.service", r"^TimeoutStopSec=(\d+)$"),
            ("deploy/compose/compose.yaml", r"stop_grace_period: (\d+)s"),
            ("docs/operate/install.md", r"--stop-timeout (\d+)"),
            ("deploy/container/Dockerfile", r"--time (\d+)"),
        ):
            with self.subTest(path):
                self.assertGreater(self.number(path, pattern), timeout + after)
        # The chart adds to its own drain.timeoutSeconds.
        grace = r"terminationGracePeriodSeconds: \{\{ add .*timeoutSeconds (\d+) \}\}"
        self.assertGreater(self.number("deploy/helm/uplinkd/templates/statefulset.yaml", grace), after)
        self.assertGreater(self.number("docs/reference/exit-codes.md", r"Keep it (\d+) s above"), after)
