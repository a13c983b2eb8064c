"""A robot whose stream is not read: what operators see."""

import sqlite3
import time
import unittest

from harness import EndToEnd, unix_us, wait_until

ROBOTS = 3
ROUND_SECONDS = 60


class HeldBack(EndToEnd):
    def robots(self, server):
        return (server.get("/api/v1/robots") or {}).get("robots", [])

    def wait_for_reason(self, server, reason):
        def look():
            robots = self.robots(server)
            held = len(robots) == ROBOTS and {robot["heldBack"] for robot in robots} == {reason}
            return robots if held else None

        return wait_until(server.process, look, ROUND_SECONDS, f"held back by {reason!r}")

    def test_it_says_why_and_since_when(self):
        server = self.server("[limits]\nin_flight_uplinks_max = 4").start()
        fleet = self.fleet(server, "--robots", ROBOTS, "--faults", 20)
        server.wait_for_status(lambda status: int(status["uplinks"]["stored"]) > 0, ROUND_SECONDS, "rows are stored")
        before_ms = time.time_ns() // 1_000_000
        # Somebody else writes: no commit succeeds meanwhile.
        writer = sqlite3.connect(self.folder / "uplinkd.db", isolation_level=None, timeout=ROUND_SECONDS)
        try:
            writer.execute("BEGIN IMMEDIATE")
            for robot in self.wait_for_reason(server, "in_flight"):
                self.assertTrue(robot["connected"])
                self.assertGreaterEqual(unix_us(robot["heldBackSince"]) // 1000, before_ms - 1000)
                self.assertLessEqual(unix_us(robot["heldBackSince"]) // 1000, time.time_ns() // 1_000_000)
            # The listing and the scrape are two moments: a stream may be looked at anew in between.
            wait_until(
                server.process,
                lambda: server.metric('uplinkd_streams_held_back{reason="in_flight"}') == ROBOTS,
                ROUND_SECONDS,
                "the metric counts them",
            )
            writer.execute("ROLLBACK")
        finally:
            writer.close()
        for robot in self.wait_for_reason(server, ""):
            self.assertNotIn("heldBackSince", robot)
        self.assert_agrees(fleet)


if __name__ == "__main__":
    unittest.main()
