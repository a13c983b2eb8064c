"""What a person sees who starts uplinkd at a terminal, and what a log gets in its place elsewhere."""

import json
import os
import pathlib
import pty
import re
import signal
import socket
import subprocess
import threading
import unittest
import urllib.request

from harness import BIN, START_SECONDS, EndToEnd, run, wait_until

COMMIT = r"\(commit [0-9A-Za-z._+~-]+\)"
NEXT = re.compile(r"^  next    curl (http://\S+)   \(Ctrl-C drains and stops\)$", re.MULTILINE)


class Terminal:
    """A program whose output goes to a terminal of its own."""

    def __init__(self, arguments):
        self.master, slave = pty.openpty()
        self.process = subprocess.Popen(arguments, stdin=slave, stdout=slave, stderr=slave)
        os.close(slave)
        self.shown = b""
        self.reader = threading.Thread(target=self.read)
        self.reader.start()

    def read(self):
        while True:
            try:
                self.shown += os.read(self.master, 4096)
            except OSError:  # the last program with this terminal has ended
                return

    def text(self):
        return self.shown.decode().replace("\r\n", "\n")

    def wait_for(self, pattern):
        return wait_until(self.process, lambda: re.search(pattern, self.text(), re.M), START_SECONDS, pattern)

    def catches(self, number):
        """The program has a handler for this signal."""
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text(encoding="utf-8")
        return int(re.search(r"^SigCgt:\s+(\w+)", status, re.M).group(1), 16) >> (number - 1) & 1

    def end(self, code):
        """Waits until it has ended; what it showed."""
        ended = self.process.wait(START_SECONDS)
        self.reader.join(START_SECONDS)
        if ended != code:
            raise AssertionError(f"ended with {ended}, not {code}\n{self.text()}")
        return self.text()

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait(START_SECONDS)
        self.reader.join(START_SECONDS)
        os.close(self.master)


class OnATerminal(EndToEnd):
    def start(self, settings="", listen=""):
        self.config = self.server(settings).configuration()
        text = self.config.read_text(encoding="utf-8")
        self.config.write_text(text.replace("[listen]", f"[listen]\n{listen}"), encoding="utf-8")
        terminal = Terminal([str(BIN / "uplinkd"), "--config", str(self.config)])
        self.open_things.append(terminal)
        return terminal

    def test_six_lines_say_that_it_runs_and_what_to_try(self):
        # Few enough for the descriptors of any machine: a warning would be a line more.
        terminal = self.start("[limits]\nrobots_max = 100")
        curl = terminal.wait_for(NEXT.pattern).group(1)
        lines = terminal.text().splitlines()
        self.assertEqual(len(lines), 6, lines)
        folder = re.escape(str(self.folder))
        for line, pattern in zip(lines, (
            rf"uplinkd \d+\.\d+\.\d+ {COMMIT} starts with {re.escape(str(self.config))}, store {folder}/uplinkd\.db",
            rf"  store   {folder}/uplinkd\.db, 0 robots known",
            r"  robots  127\.0\.0\.1:\d+, gRPC with mutual TLS",
            r"  http    http://127\.0\.0\.1:\d+: API, metrics, health",
            r"  TLS     localhost, 127\.0\.0\.1; \d+ days left, until \d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ",
            NEXT.pattern,
        )):  # fmt: skip
            self.assertRegex(line, rf"\A{pattern}\Z")
        with urllib.request.urlopen(curl, timeout=10) as answer:
            self.assertEqual(answer.status, 200)
        terminal.process.send_signal(signal.SIGINT)
        shown = terminal.end(0)
        # Once it has started, events are logged as ever.
        self.assertIn(" info stopped\n", shown)
        for event in ("starting", "probes_answered", "store_opening", "listening", "certificates_served"):
            self.assertNotIn(f" {event}", shown.replace("starts with", ""))

    def test_a_broker_and_drones_have_a_line_and_no_secret_is_shown(self):
        password = self.folder / "broker.password"
        password.write_text("hidden-password\n", encoding="utf-8")
        password.chmod(0o600)
        terminal = self.start(
            f'[mqtt]\nurl = "mqtt://127.0.0.1:9"\nusername = "hidden-user"\npassword_file = "{password}"\n'
            "[uncrew]\navatar = true\n"
        )
        terminal.wait_for(NEXT.pattern)
        terminal.process.send_signal(signal.SIGINT)
        shown = terminal.end(0)
        self.assertIn("\n  broker  mqtt://127.0.0.1:9, MQTT\n", shown)
        self.assertIn("\n  drones  at the same address, AvatarService\n", shown)
        for secret in ("hidden-password", "hidden-user"):
            self.assertNotIn(secret, shown)

    def test_the_listener_for_metrics_has_a_line(self):
        terminal = self.start(listen='metrics = "127.0.0.1:0"')
        terminal.wait_for(NEXT.pattern)
        self.assertRegex(
            terminal.text(), r"\n  metrics http://127\.0\.0\.1:\d+: probes and scrapes, without authentication\n"
        )

    def test_the_first_line_names_a_store_that_does_not_answer(self):
        with socket.create_server(("127.0.0.1", 0)) as silent:
            address = f"127.0.0.1:{silent.getsockname()[1]}"
            server = self.server()
            server.store_url = f"postgresql://uplinkd@{address}/uplinkd"
            terminal = Terminal([str(BIN / "uplinkd"), "--config", str(server.configuration())])
            self.open_things.append(terminal)
            terminal.wait_for(rf"uplinkd\.toml, store {re.escape(address)}/uplinkd$")
            self.assertIsNone(NEXT.search(terminal.text()))
            wait_until(terminal.process, lambda: terminal.catches(signal.SIGINT), START_SECONDS, "it hears signals")
            terminal.process.send_signal(signal.SIGINT)
            self.assertEqual(terminal.end(0).splitlines()[-1], "uplinkd: stopped before it was ready")

    def test_warnings_follow_the_six_lines(self):
        self.server()
        (self.folder / "pki/server.key").chmod(0o644)
        terminal = self.start("[limits]\nrobots_max = 100")
        terminal.wait_for(" warn secret_readable note=")
        lines = terminal.text().splitlines()
        self.assertRegex(lines[5], NEXT.pattern)
        self.assertIn(" warn secret_readable note=", lines[6])

    def test_too_few_descriptors_are_told_after_the_six_lines_as_doctor_tells_them(self):
        self.config = self.server("[limits]\nrobots_max = 100").configuration()
        limit = ["prlimit", "--nofile=6000:6000"]
        terminal = Terminal([*limit, str(BIN / "uplinkd"), "--config", str(self.config)])
        self.open_things.append(terminal)
        terminal.wait_for(" warn descriptors_few ")
        lines = terminal.text().splitlines()
        self.assertRegex(lines[5], NEXT.pattern)
        self.assertIn(" warn descriptors_few descriptors_max=6000 descriptors_wanted=6344 ", lines[6])
        doctor = [*limit, str(BIN / "uplinkctl"), "doctor", "--config", str(self.config)]
        told = subprocess.run(doctor, capture_output=True, text=True, timeout=START_SECONDS, check=False).stdout
        self.assertIn("limits.robots_max = 100 needs 6344", told)

    def test_a_start_that_fails_says_why_and_what_to_do(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            server = self.server()
            server.settings = "[limits]\nrobots_max = 100"
            server.relay = f"127.0.0.1:{taken.getsockname()[1]}"
            terminal = Terminal([str(BIN / "uplinkd"), "--config", str(server.configuration())])
            self.open_things.append(terminal)
            shown = terminal.end(1)
        self.assertNotIn("start_failed", shown)
        self.assertRegex(shown, r"\nuplinkd: .*set an address of this machine and a free port.*\n\Z")
        self.assertEqual(len(shown.splitlines()), 2, shown)

    def test_a_log_that_is_set_otherwise_is_as_it_is_elsewhere(self):
        terminal = self.start('[log]\nformat = "json"')
        terminal.wait_for(r'"listening"')
        terminal.process.send_signal(signal.SIGINT)
        events = [json.loads(line)["event"] for line in terminal.end(0).splitlines() if line.startswith("{")]
        self.assertEqual(events[0], "starting")
        self.assertIn("probes_answered", events)

    def test_debug_shows_every_event(self):
        terminal = self.start('[log]\nlevel = "debug"')
        terminal.wait_for(r" info listening ")
        self.assertIn(" info starting ", terminal.text())
        self.assertIsNone(NEXT.search(terminal.text()))


class Elsewhere(EndToEnd):
    def test_a_file_gets_the_events_alone(self):
        server = self.server().start()
        self.assertEqual(server.terminate(START_SECONDS), 0)
        lines = server.text().splitlines()
        for line in lines:
            self.assertRegex(line, r"^\d{4}-\d\d-\d\dT\S+Z (info|warn) [a-z_]+( |$)")
        self.assertRegex(lines[0], " info starting version=")


class Version(EndToEnd):
    def test_every_program_names_its_version_and_the_same_commit(self):
        said = set()
        for program in ("uplinkd", "uplinkctl", "uplink-fleet"):
            line = run(BIN / program, "--version").stdout
            self.assertRegex(line, rf"\A{program} \d+\.\d+\.\d+ {COMMIT}\n\Z")
            said.add(line.removeprefix(program))
        self.assertEqual(len(said), 1, said)


if __name__ == "__main__":
    unittest.main()
