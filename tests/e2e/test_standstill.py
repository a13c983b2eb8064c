"""A server that stands still under load: what it did not hear meanwhile counts as no robot's silence."""

import signal
import time
import unittest
import urllib.parse

from harness import EndToEnd, wait_until

ROBOTS = 10
ROUND_SECONDS = 60
# Longer than presence.timeout, which is 10 s.
STANDSTILL_SECONDS = 14
# Long enough for agents to give their connections up (Fleet::kStandstillBreaks); how long they then
# take to come back, longer than this presence.timeout; and the grace that the server gives them.
BREAK_SECONDS = 16
AWAY_SECONDS = 12
BRIEF = """[presence]
timeout = "5s"
startup_grace = "40s"
"""


class Standstill(EndToEnd):
    def robots(self, server):
        return (server.get("/api/v1/robots") or {}).get("robots", [])

    def wait_for_all_online(self, server):
        def look():
            now = [robot["presence"] for robot in self.robots(server)]
            return len(now) == ROBOTS and set(now) == {"online"}

        wait_until(server.process, look, ROUND_SECONDS, "all are online")

    def wait_until_not_behind(self, server):
        server.wait_for_status(lambda s: "relay_behind" not in s["degraded"], ROUND_SECONDS, "it is not behind")

    def changes(self, server, robot):
        """The robot's presence changes, the oldest first."""
        name = urllib.parse.quote(robot["ruri"], safe="")
        return [change["presence"] for change in reversed(server.get(f"/api/v1/presence?ruri={name}")["presenceChanges"])]

    def stand_still(self, server, fleet, seconds):
        server.process.send_signal(signal.SIGSTOP)
        try:
            self.pass_time(fleet.process, seconds)
        finally:
            server.process.send_signal(signal.SIGCONT)

    def pass_time(self, process, seconds, check=lambda: None):
        """While this process lives and the check passes."""
        end = time.monotonic() + seconds

        def look():
            check()
            return time.monotonic() >= end

        wait_until(process, look, seconds + ROUND_SECONDS, "the time passes")

    def test_a_server_that_was_stopped_calls_nobody_offline(self):
        server = self.server().start()
        fleet = self.fleet(server, "--robots", ROBOTS, "--rate", 10, "--faults", 10)
        self.wait_for_all_online(server)
        # On a machine that is full it may have stood still already.
        self.wait_until_not_behind(server)
        before = server.metric("uplinkd_standstills_total")
        self.stand_still(server, fleet, STANDSTILL_SECONDS)

        def line(text):
            wait_until(server.process, lambda: text in server.text(), ROUND_SECONDS, text)

        line("relay_behind why=stood_still")
        self.assertGreater(server.metric("uplinkd_standstills_total"), before)
        line("relay_caught_up")
        self.wait_until_not_behind(server)
        self.wait_for_all_online(server)
        for robot in self.robots(server):
            changes = self.changes(server, robot)
            self.assertNotIn("offline", changes)
            for before, after in zip(changes, changes[1:]):
                self.assertNotEqual(before, after, "a row per change")
            self.assertEqual(changes[-1], "online")
        self.assert_agrees(fleet)

    def test_robots_whose_connections_broke_meanwhile_have_the_grace_of_a_start_to_come_back(self):
        server = self.server(BRIEF).start()
        fleet = self.fleet(server, "--robots", ROBOTS, "--rate", 10, "--faults", 10)
        self.wait_for_all_online(server)
        self.wait_until_not_behind(server)
        server.process.send_signal(signal.SIGSTOP)
        try:
            # What they said is in the server's sockets, and then the end of each connection.
            self.pass_time(fleet.process, 1)
            fleet.close()
            self.pass_time(server.process, BREAK_SECONDS)
        finally:
            server.process.send_signal(signal.SIGCONT)

        def nobody_is_offline():
            self.assertNotIn("offline", [robot["presence"] for robot in self.robots(server)])

        self.pass_time(server.process, AWAY_SECONDS, nobody_is_offline)
        self.assertIn("unknown", {robot["presence"] for robot in self.robots(server)})
        self.fleet(server, "--robots", ROBOTS, "--rate", 10, "--faults", 10)
        self.wait_for_all_online(server)
        for robot in self.robots(server):
            self.assertNotIn("offline", self.changes(server, robot))


if __name__ == "__main__":
    unittest.main()
