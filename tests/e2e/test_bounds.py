"""A robot whose messages are rejected on and on: its stream, and its quarantine."""

import unittest
import urllib.parse

from harness import EndToEnd, wait_until

QUARANTINE_ROWS_MAX = 10_000
ROUND_SECONDS = 90


class Bounds(EndToEnd):
    def dropped(self, server, ruri):
        """How many rows of its quarantine went, by reason."""
        name = urllib.parse.quote(ruri, safe="")
        page = server.get(f"/api/v1/quarantine?ruri={name}&pageSize=1") or {}
        return {reason: int(rows) for reason, rows in page.get("droppedByReason", {}).items()}

    def test_ten_thousand_rejects_end_a_stream_and_the_next_one_goes_on(self):
        server = self.server().start()
        # Below the 1,000 per second at which it would be held back.
        fleet = self.fleet(server, "--robots", 1, "--rate", 900, "--malformed-share", 1)
        wait_until(
            server.process, lambda: server.metric("uplinkd_rejects_unconfirmed_ends_total") >= 1, ROUND_SECONDS,
            "the stream ends",
        )  # fmt: skip
        enough = QUARANTINE_ROWS_MAX + 1_000
        server.wait_for_status(
            lambda status: int(status["uplinks"]["rejected"]) >= enough, ROUND_SECONDS, "the next stream goes on"
        )
        # Its Hello named what is settled: that goes, down to the bound, and is counted.
        ruri = server.get("/api/v1/robots")["robots"][0]["ruri"]
        dropped = wait_until(server.process, lambda: self.dropped(server, ruri), ROUND_SECONDS, "rows go")
        self.assertGreater(sum(dropped.values()), 0)
        self.assertEqual(server.metric("uplinkd_rejects_unconfirmed_ends_total"), 1)
        named = [line for line in server.text().splitlines() if " rejects_unconfirmed " in line]
        self.assertEqual(len(named), 1)
        self.assertIn(f"robot={ruri} ", named[0])
        # What the robot was told, what the server counted and what is stored agree all the same.
        self.assert_agrees(fleet)


if __name__ == "__main__":
    unittest.main()
