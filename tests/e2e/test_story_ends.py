"""Why a robot's stream ended: each row of the table of docs/reference/connections.md, against the real server
and an agent of another gRPC library, as its log tells."""

import contextlib
import re

from ending_agents import DRAIN, PATIENCE_SECONDS, RURI, SECONDS, EndingAgents
from harness import uplinkctl, wait_until
from tcp_proxy import Cut


class StoryEnds(EndingAgents):
    def setUp(self):
        super().setUp()
        self.serve(self.server(DRAIN))

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
