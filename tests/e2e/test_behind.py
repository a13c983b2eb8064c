"""A relay that does not read while the rest of the server goes on: whose silence is it?"""

import unittest
import urllib.parse

from harness import EndToEnd, wait_until
from threads import standing_still, threads_of

ROBOTS = 5
ROUND_SECONDS = 60
# A thread that is stopped may hold a lock that the rest needs: then it is stopped again.
STOPS = 10


class Behind(EndToEnd):
    def robots(self, server):
        return (server.get("/api/v1/robots") or {}).get("robots", [])

    def wait_for_presence(self, server, presence):
        def look():
            now = [robot["presence"] for robot in self.robots(server)]
            self.assertNotIn("offline", now, "messages lie unread")
            return len(now) == ROBOTS and set(now) == {presence}

        wait_until(server.process, look, ROUND_SECONDS, presence)

    def wait_for_word(self, server, there, line):
        def look():
            words = (server.get("/readyz") or {"degraded": []})["degraded"]
            return ("relay_behind" in words) == there and line in server.text()

        wait_until(server.process, look, ROUND_SECONDS, line)
        self.assertEqual(server.metric("uplinkd_relay_behind"), int(there))

    def stand_still(self, server):
        """The relay's threads stand still meanwhile, and nothing else does; whether that could be had."""
        relay = threads_of(server.process.pid, "relay-")
        self.assertTrue(relay)
        with standing_still(relay):
            if not self.robots(server):
                return False
            self.wait_for_presence(server, "unknown")
            try:
                self.wait_for_word(server, True, "relay_behind why=late")
            except TimeoutError:
                return False  # only /metrics needs that lock
        return True

    def test_robots_that_the_server_does_not_read_are_unknown_and_never_offline(self):
        server = self.server().start()
        fleet = self.fleet(server, "--robots", ROBOTS, "--faults", 5)
        self.wait_for_presence(server, "online")
        try:
            self.assertTrue(any(self.stand_still(server) for _ in range(STOPS)), "no stop without a lock")
        except PermissionError as error:
            self.skipTest(f"this system does not let us stop threads: {error}")
        self.wait_for_presence(server, "online")
        self.wait_for_word(server, False, "relay_caught_up")
        for robot in self.robots(server):
            name = urllib.parse.quote(robot["ruri"], safe="")
            changes = server.get(f"/api/v1/presence?ruri={name}")["presenceChanges"]
            self.assertNotIn("offline", [change["presence"] for change in changes])
        self.assert_agrees(fleet)


if __name__ == "__main__":
    unittest.main()
