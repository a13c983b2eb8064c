"""How far behind agents are, and whether their clocks are right: what operators see of a real fleet."""

import time
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
        fleet = self.fleet(server, "--robots", ROBOTS, "--faults", 200)
        robots = self.wait_for_robots(
            server,
            lambda robot: int(robot.get("backlog", {"uplinks": 0})["uplinks"]) > 0,
            "each robot has a backlog",
        )
        now_ms = time.time_ns() // 1_000_000
        for robot in robots:
            backlog = robot["backlog"]
            self.assertGreater(int(backlog["oldestUnsentMs"]), now_ms - SECONDS * 1000)
            self.assertLessEqual(int(backlog["oldestUnsentMs"]), int(backlog["saidAtMs"]))
            self.assertLessEqual(int(backlog["saidAtMs"]), now_ms)
        self.assert_agrees(fleet)
        for robot in self.wait_for_robots(server, lambda robot: not robot["connected"], "the fleet has left"):
            self.assertEqual((robot["backlog"]["uplinks"], robot["backlog"]["oldestUnsentMs"]), ("0", "0"))
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
