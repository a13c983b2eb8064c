"""A relay that does not read while the rest of the server goes on: whose silence is it?"""

import unittest
import urllib.parse

from harness import EndToEnd, wait_until
from threads import standing_still, threads_of

ROBOTS = 5
ROUND_SECONDS = 60


class Behind(EndToEnd):
    def presence(self, server):
        return {robot["ruri"]: robot["presence"] for robot in server.get("/api/v1/robots")["robots"]}

    def wait_for_presence(self, server, presence):
        def look():
            now = self.presence(server)
            self.assertNotIn("PRESENCE_OFFLINE", now.values(), "messages lie unread")
            return len(now) == ROBOTS and set(now.values()) == {presence}

        wait_until(server.process, look, ROUND_SECONDS, presence)

    def wait_for_metric(self, server, value):
        wait_until(
            server.process, lambda: server.metric("uplinkd_relay_behind") == value, ROUND_SECONDS, f"behind: {value}"
        )

    def test_robots_that_the_server_does_not_read_are_unknown_and_never_offline(self):
        server = self.server('[presence]\ntimeout = "6s"\n').start()
        fleet = self.fleet(server, "--robots", ROBOTS, "--faults", 5)
        self.wait_for_presence(server, "PRESENCE_ONLINE")
        self.wait_for_metric(server, 0)
        relay = threads_of(server.process.pid, "relay-")
        self.assertTrue(relay)
        with standing_still(relay):
            self.wait_for_presence(server, "PRESENCE_UNKNOWN")
            self.wait_for_metric(server, 1)
            self.assertIn("relay_behind", server.get("/readyz")["degraded"])
            self.assertIn("relay_behind", server.text())
        self.wait_for_presence(server, "PRESENCE_ONLINE")
        self.wait_for_metric(server, 0)
        wait_until(
            server.process, lambda: "relay_caught_up" in server.text(), ROUND_SECONDS, "the log says that it is over"
        )
        for ruri in self.presence(server):
            name = urllib.parse.quote(ruri, safe="")
            changes = server.get(f"/api/v1/robots/{name}/presence")["changes"]
            self.assertNotIn("PRESENCE_OFFLINE", [change["presence"] for change in changes])
        self.assert_agrees(fleet)


if __name__ == "__main__":
    unittest.main()
