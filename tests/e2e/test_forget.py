"""Robots that leave memory: those that are silent for long, and those that give their place up."""

import contextlib
import unittest
import urllib.error
import urllib.request

from harness import EndToEnd, wait_until

DEADLINE_SECONDS = 60
ROBOTS = 6
SETTINGS = """
[presence]
timeout = "1s"
startup_grace = "0"
[fleet]
forget_after = "3s"
"""


class Forgetting(EndToEnd):
    def robots(self, server, query=""):
        answer = server.get(f"/api/v1/robots?pageSize=1000{query}") or {}
        return [robot["ruri"] for robot in answer.get("robots", [])]

    def wait_for(self, server, condition, what):
        return wait_until(server.process, condition, DEADLINE_SECONDS, f"{what}\n{server.text()[-2000:]}")

    def come_and_go(self, server, robots=ROBOTS, prefix="rcan://forget", seed=1):
        """Robots that report, and leave once all that they sent is settled."""
        fleet = self.fleet(server, "--robots", robots, "--ruri-prefix", prefix, "--seed", seed)
        server.wait_for_status(lambda status: status["streams"] == str(robots), DEADLINE_SECONDS, "all stream")
        self.wait_for(server, lambda: len(self.robots(server, "&presence=online")) == robots, "all are heard")
        return fleet

    def scrape(self, server):
        with contextlib.closing(urllib.request.urlopen(f"http://{server.http}/metrics/robots", timeout=10)) as page:
            return page.read().decode()

    def ready(self, server):
        with contextlib.closing(urllib.request.urlopen(f"http://{server.http}/readyz", timeout=10)) as page:
            return page.status, page.read().decode()

    def status_of(self, server, path):
        try:
            with contextlib.closing(urllib.request.urlopen(f"http://{server.http}{path}", timeout=10)) as page:
                return page.status
        except urllib.error.HTTPError as error:
            return error.code

    def test_robots_that_are_silent_leave_lists_and_series_and_come_back(self):
        server = self.server(SETTINGS).start()
        fleet = self.come_and_go(server)
        known = self.robots(server)
        self.assertEqual(len(known), ROBOTS)
        self.assertIn(known[0], self.scrape(server))
        fleet.finish()
        self.wait_for(server, lambda: self.robots(server) == [], "all are forgotten")
        self.assertNotIn(known[0], self.scrape(server))
        self.assertEqual(server.metric("uplinkd_robots_forgotten_total"), ROBOTS)
        server.wait_for_line(" robots_forgotten ")
        # What the store has of them stays.
        path = known[0].replace("/", "%2F").replace(":", "%3A")
        self.assertTrue(server.get(f"/api/v1/presence?ruri={path}")["presenceChanges"])
        self.assertEqual(self.status_of(server, f"/api/v1/robots/{path}"), 404)
        # Again, with the sessions that the store kept: nothing is doubled.
        fleet = self.come_and_go(server, seed=2)
        self.assertEqual(sorted(self.robots(server)), sorted(known))
        self.assert_agrees(fleet)

    def test_a_fleet_over_robots_max_goes_through_a_restart(self):
        server = self.server(SETTINGS.replace('"3s"', '"0"')).start()
        self.come_and_go(server).finish()
        server.wait_for_status(lambda status: status["streams"] == "0", DEADLINE_SECONDS, "all left")
        self.assertEqual(len(self.robots(server)), ROBOTS)
        self.assertEqual(server.terminate(DEADLINE_SECONDS), 0)

        server.settings += "[limits]\nrobots_max = 4\n"
        server.start()
        self.assertEqual(len(self.robots(server)), 4)
        self.assertRegex(server.text(), r" robots_left_out robots=2 robots_max=4")
        status, text = self.ready(server)
        self.assertEqual(status, 200)
        self.assertIn("robots_max", text)
        # New ones find room: those that were silent for longest leave.
        fleet = self.come_and_go(server, 4, "rcan://new", seed=3)
        self.wait_for(server, lambda: all(ruri.startswith("rcan://new") for ruri in self.robots(server)),
                      "the silent ones left")  # fmt: skip
        self.assertEqual(len(self.robots(server)), 4)
        self.assert_agrees(fleet)


if __name__ == "__main__":
    unittest.main()
