"""Agents of other gRPC libraries: Debian's Python one. It shares nothing with the synthetic fleet's."""

import json
import os
import pathlib
import subprocess

from harness import SOURCE, EndToEnd, uplinkctl

PYTHON = "/usr/bin/python3"
CLIENT = pathlib.Path(__file__).with_name("relay_client.py")
RURI = "rcan://example.org/acme/rover/r1"
SECONDS = 60


class Clients(EndToEnd):
    def setUp(self):
        super().setUp()
        self.running = self.server().start()
        self.modules = self.running.folder / "modules"
        self.modules.mkdir()
        subprocess.run(
            ["protoc", f"--proto_path={SOURCE / 'proto'}", f"--python_out={self.modules}", "uplink/v1/relay.proto"],
            check=True, timeout=SECONDS,
        )  # fmt: skip
        uplinkctl("pki", "robot", "--dir", self.running.pki, "--ruri", RURI, "--fleet", "acme")

    def act(self, name):
        files = [str(self.running.pki / file) for file in ("ca.crt", "robot.crt", "robot.key")]
        done = subprocess.run(
            [PYTHON, str(CLIENT), name, self.running.relay, *files],
            env={**os.environ, "PYTHONPATH": str(self.modules)},
            capture_output=True, text=True, timeout=SECONDS, check=False,
        )  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_a_python_agent_streams_and_half_closes(self):
        seen = self.act("stream")
        self.assertEqual(
            seen,
            {"first": "welcome", "ruri": RURI, "rejects": 1000, "through": 1000, "code": "OK", "details": ""},
        )  # fmt: skip
        self.assertEqual(self.running.metric('uplinkd_uplinks_settled_total{outcome="rejected"}'), 1000)

    def test_a_python_agent_sees_why_its_stream_ends(self):
        for act, code, words in (
            ("wrong_hello", "INVALID_ARGUMENT", "session_id"),
            ("other_robot", "PERMISSION_DENIED", "100%"),
            ("large_frame", "RESOURCE_EXHAUSTED", ""),
            ("other_method", "UNIMPLEMENTED", ""),
            ("compressed", "UNIMPLEMENTED", "gzip"),
        ):
            with self.subTest(act):
                seen = self.act(act)
                self.assertEqual(seen["code"], code, seen)
                self.assertIn(words, seen["details"])
