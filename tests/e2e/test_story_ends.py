"""Why a robot's stream ended: each row of the table of docs/reference/connections.md, against the real server
and an agent of another gRPC library, as its log tells."""

import contextlib
import os
import pathlib
import re
import subprocess

from harness import SOURCE, EndToEnd, uplinkctl, wait_until
from tcp_proxy import Cut, TcpProxy

PYTHON = "/usr/bin/python3"
AGENT = pathlib.Path(__file__).with_name("relay_ends.py")
RURI = "rcan://example.org/acme/rover/"
SECONDS = 60
# Keepalive needs 40 s to find out, and so does an agent that does not read.
PATIENCE_SECONDS = 120


class StoryEnds(EndToEnd):
    def setUp(self):
        super().setUp()
        self.running = self.server("[drain]\ntimeout = \"5s\"\n").start()
        self.modules = self.running.folder / "modules"
        self.modules.mkdir()
        subprocess.run(
            ["protoc", f"--proto_path={SOURCE / 'proto'}", f"--python_out={self.modules}", "uplink/v1/relay.proto"],
            check=True, timeout=SECONDS,
        )  # fmt: skip
        self.proxy = TcpProxy(self.running.relay)
        self.addCleanup(self.proxy.close)

    def agent(self, act, name=None, through=None):
        """An agent that streams, of the robot `name`, by default that of its act."""
        name = name or act
        keys = self.running.folder / name
        if not keys.exists():
            uplinkctl("pki", "robot", "--dir", self.running.pki, "--ruri", RURI + name, "--fleet", "acme", "--name", name)
            keys.touch()
        files = [str(self.running.pki / file) for file in ("ca.crt", f"{name}.crt", f"{name}.key")]
        agent = subprocess.Popen(
            [PYTHON, str(AGENT), act, through or self.running.relay, *files],
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(self.modules), str(AGENT.parent)])},
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        self.addCleanup(self.end, agent)
        self.assertEqual(agent.stdout.readline().strip(), "welcome")
        return agent

    @staticmethod
    def end(agent):
        agent.kill()
        agent.communicate()

    def ends(self, name):
        """Why each stream of the robot ended, and with which code."""
        line = rf"robot_disconnected robot={re.escape(RURI + name)} .*?why=(\w+) code=\"?(\w*)"
        return re.findall(line, self.running.text())

    def expect(self, name, *ends):
        with contextlib.suppress(AssertionError):
            wait_until(self.running.process, lambda: len(self.ends(name)) >= len(ends), PATIENCE_SECONDS, name)
        self.assertEqual(self.ends(name), list(ends), self.running.text())

    def test_each_way_in_which_an_agent_ends_its_stream_has_its_reason(self):
        # Those that take long first.
        silent = self.agent("silent", through=self.proxy.address)
        self.proxy.cut(Cut.BLACK_HOLE)
        self.agent("not_read")

        self.agent("half_close")
        self.agent("cancel")
        self.agent("killed").kill()
        self.agent("second_hello")
        self.agent("large_frame")
        self.agent("twice", name="twice")
        self.agent("twice", name="twice").kill()

        self.expect("half_close", ("orderly", "OK"))
        self.expect("cancel", ("broken", "CANCELLED"))
        self.expect("killed", ("broken", ""))
        self.expect("second_hello", ("protocol_error", "INVALID_ARGUMENT"))
        self.expect("large_frame", ("protocol_error", "RESOURCE_EXHAUSTED"))
        self.expect("twice", ("replaced", "ABORTED"), ("broken", ""))
        self.expect("silent", ("silent", ""))
        self.expect("not_read", ("not_read", "RESOURCE_EXHAUSTED"))
        self.assertIsNone(silent.poll(), "the silent agent was there all the while")

        for name in ("silent", "half_close", "twice"):
            self.assertIn(f"robot_connected robot={RURI}{name} source=uplink peer=127.0.0.1:", self.running.text())

    def test_a_connection_that_is_cut_on_its_way_is_broken(self):
        self.agent("cut", through=self.proxy.address)
        self.proxy.drop()
        self.expect("cut", ("broken", ""))

    def test_a_server_that_stops_drains_its_streams(self):
        self.agent("drained")
        self.assertEqual(self.running.terminate(SECONDS), 0)
        self.assertEqual(self.ends("drained"), [("drained", "UNAVAILABLE")], self.running.text())

    def test_an_operator_who_forgets_the_robot_refuses_its_stream(self):
        self.agent("forgotten")
        uplinkctl("store", "forget", "--url", self.running.store_url, "--yes", "--end-stream", RURI + "forgotten")
        self.expect("forgotten", ("refused", "UNAVAILABLE"))
