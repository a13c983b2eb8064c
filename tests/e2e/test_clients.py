"""Agents of other gRPC libraries: Debian's Python one, and its grpc-go. They share nothing with the
synthetic fleet's."""

import json
import os
import pathlib
import subprocess

from harness import SOURCE, EndToEnd, uplinkctl, wait_until

PYTHON = "/usr/bin/python3"
CLIENT = pathlib.Path(__file__).with_name("relay_client.py")
RURI = "rcan://example.org/acme/rover/r1"
SECONDS = 60
# Debian's, which finds Debian's libraries without modules; to build them takes a minute.
GO = "/usr/bin/go"
GO_PATH = "/usr/share/gocode"
GO_SECONDS = 400
GATEWAY = pathlib.Path(__file__).with_name("relay_gateway.go")
EVENT = SOURCE / "tests/conformance/vectors/eventTelemetry.bin"
ROBOTS = 200
# A minute with UPLINK_SPANS=full.
EVENTS = 60 if os.environ.get("UPLINK_SPANS") == "full" else 10


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


class GoGateway(EndToEnd):
    def test_a_go_gateway_of_200_robots_streams_for_a_while(self):
        running = self.server().start()
        uplinkctl("pki", "gateway", "--dir", running.pki, "--fleet", "acme", "--name", "gateway")
        program = running.folder / "gateway"
        subprocess.run(
            [GO, "build", "-o", str(program), str(GATEWAY)],
            env={**os.environ, "GO111MODULE": "off", "GOPATH": GO_PATH, "GOFLAGS": ""},
            check=True, timeout=GO_SECONDS,
        )  # fmt: skip
        files = [str(running.pki / file) for file in ("ca.crt", "gateway.crt", "gateway.key")]
        done = subprocess.run(
            [str(program), running.relay, *files, str(ROBOTS), str(EVENTS), str(EVENT)],
            capture_output=True, text=True, timeout=EVENTS + SECONDS, check=False,
        )  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        seen = json.loads(done.stdout)
        self.assertEqual(seen["Error"], "", running.text())
        self.assertEqual(seen["Acked"], ROBOTS * EVENTS)
        # More than the PINGs that a connection may send by itself, one per DATA frame.
        self.assertGreater(seen["Messages"], ROBOTS * EVENTS)
        wait_until(running.process, lambda: running.metric("uplinkd_streams") == 0, SECONDS, "it left")
        for cause in ("protocol", "pings", "window_updates", "settings", "headers", "resets"):
            name = f'uplinkd_connections_turned_away_total{{cause="{cause}"}}'
            self.assertEqual(running.metric(name), 0, cause)
