"""A server that stands still under load: what it did not hear meanwhile is nobody's silence."""

import signal
import time
import unittest
import urllib.parse

from harness import EndToEnd, wait_until

ROBOTS = 10
ROUND_SECONDS = 60
# Longer than presence.timeout, which is 10 s.
STANDSTILL_SECONDS = 15


class Standstill(EndToEnd):
    def robots(self, server):
        return (server.get("/api/v1/robots") or {}).get("robots", [])

    def wait_for_all_online(self, server):
        def look():
            now = [robot["presence"] for robot in self.robots(server)]
            return len(now) == ROBOTS and set(now) == {"PRESENCE_ONLINE"}

        wait_until(server.process, look, ROUND_SECONDS, "all are online")

    def wait_until_not_behind(self, server):
        server.wait_for_status(lambda s: "relay_behind" not in s["degraded"], ROUND_SECONDS, "it is not behind")

    def changes(self, server, robot):
        """The robot's presence changes, the oldest first."""
        name = urllib.parse.quote(robot["ruri"], safe="")
        return [change["presence"] for change in reversed(server.get(f"/api/v1/robots/{name}/presence")["changes"])]

    def stand_still(self, server, fleet, seconds):
        resume_at = time.monotonic() + seconds
        server.process.send_signal(signal.SIGSTOP)
        try:
            wait_until(fleet.process, lambda: time.monotonic() >= resume_at, seconds + ROUND_SECONDS, "it stood still")
        finally:
            server.process.send_signal(signal.SIGCONT)

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
            self.assertNotIn("PRESENCE_OFFLINE", changes)
            for before, after in zip(changes, changes[1:]):
                self.assertNotEqual(before, after, "a row per change")
            self.assertEqual(changes[-1], "PRESENCE_ONLINE")
        self.assert_agrees(fleet)


if __name__ == "__main__":
    unittest.main()
