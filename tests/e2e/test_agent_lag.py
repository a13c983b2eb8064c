"""How far behind agents are, and whether their clocks are right: what operators see of a real fleet."""

import datetime
import unittest

from harness import EndToEnd, wait_until
from test_clock import ShiftedClock

ROBOTS = 2
SECONDS = 60
AHEAD_SECONDS = 3600
# Far below what the fleet reports: its agents fall behind.
SLOW = """[limits]
durable_records_rate = 50
durable_records_burst = 50
"""


class AgentLag(EndToEnd):
    def wait_for_robots(self, server, condition, what):
        """Until all robots meet it; gives them."""

        def look():
            robots = (server.get("/api/v1/robots") or {}).get("robots", [])
            return robots if len(robots) == ROBOTS and all(map(condition, robots)) else None

        return wait_until(server.process, look, SECONDS, what)

    def test_a_fleet_that_is_held_back_says_how_far_behind_it_is(self):
        server = self.server(SLOW).start()
        fleet = self.fleet(server, "--robots", ROBOTS, "--faults", 100)
        robots = self.wait_for_robots(
            server,
            lambda robot: int(robot.get("backlog", {"uplinks": 0})["uplinks"]) > 0,
            "each robot has a backlog",
        )
        now = datetime.datetime.now(datetime.timezone.utc)
        for robot in robots:
            oldest, said = (datetime.datetime.fromisoformat(robot["backlog"][name]) for name in ("oldestUnsent", "saidAt"))
            self.assertGreater(oldest, now - datetime.timedelta(seconds=SECONDS))
            self.assertLessEqual(oldest, said)
            self.assertLessEqual(said, now)
        self.assert_agrees(fleet)
        for robot in self.wait_for_robots(server, lambda robot: not robot["connected"], "the fleet has left"):
            self.assertEqual(robot["backlog"]["uplinks"], "0")
            self.assertNotIn("oldestUnsent", robot["backlog"])
        self.assertGreater(server.metric('uplinkd_message_age_seconds_count{source="uplink",kind="durable"}'), 0)

    def test_a_fleet_with_a_wrong_clock_shows_by_how_much(self):
        server = self.server().start()
        clock = ShiftedClock(self.folder)
        clock.set(AHEAD_SECONDS)
        fleet = self.fleet(server, "--robots", ROBOTS, environment=clock.environment)
        ahead_ms = AHEAD_SECONDS * 1000
        # The estimate is too low by the way of the fastest batch, and never too high.
        self.wait_for_robots(
            server,
            lambda robot: ahead_ms / 2 < int(robot.get("clockSkewMs", 0)) <= ahead_ms,
            "the clocks are an hour ahead",
        )
        self.assert_agrees(fleet)


if __name__ == "__main__":
    unittest.main()
