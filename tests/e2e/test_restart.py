"""What a restart of the server leaves as it was, though no robot has come back yet.

The last number of some robots is that of a live message, which leaves no row of its own.
"""

import unittest

from chaos import ROBOTS, Campaign
from chaos_stores import Sqlite
from harness import EndToEnd, wait_until

ROUND_SECONDS = 60
ACKS = 200


class Restart(EndToEnd):
    def sessions(self, server):
        """Session and settled number of each robot, once all are known."""

        def look():
            robots = (server.get(f"/api/v1/robots?pageSize={ROBOTS}") or {"robots": []})["robots"]
            return robots if len(robots) == ROBOTS else None

        robots = wait_until(server.process, look, ROUND_SECONDS, "all robots are known")
        return {robot["ruri"]: (robot["sessionId"], int(robot["settledSeq"])) for robot in robots}

    def checkpointed(self, store):
        """The sum of all robots' settled numbers as of their checkpoints."""
        if isinstance(store, Sqlite):
            return store.read("SELECT sum(settled_seq) FROM live")[0][0]
        return int(store.sql("SELECT sum(settled_seq) FROM uplinkd.live"))

    def work(self, campaign):
        """The robots go away after a while, and all that they sent is settled; what is shown then."""
        campaign.server.wait_for_status(
            lambda status: int(status["streams"]) == ROBOTS, ROUND_SECONDS, "all robots stream"
        )
        wait_until(
            campaign.server.process,
            lambda: all(settled for _, settled in self.sessions(campaign.server).values()),
            ROUND_SECONDS,
            "something of each robot is settled",
        )
        campaign.wait_for_more(ACKS)
        campaign.robots.kill()
        campaign.server.wait_for_status(
            lambda status: status["streams"] == "0" and status["uplinks"]["inFlight"] == "0",
            ROUND_SECONDS,
            "nothing waits",
        )
        return self.sessions(campaign.server)

    def compare(self, campaign, before, restarts):
        campaign.server.start()
        after = self.sessions(campaign.server)
        for ruri, (session, settled) in before.items():
            self.assertRegex(session, "^[0-9a-f]{32}$", ruri)
            self.assertGreater(settled, 0, ruri)
            self.assertEqual(after[ruri], (session, settled), f"{ruri} after a restart {restarts}")

    def restart_on(self, store):
        campaign = Campaign(self.folder, store, 5)
        self.open_things.append(campaign)
        campaign.start()
        before = self.work(campaign)
        self.assertEqual(campaign.server.terminate(ROUND_SECONDS), 0)
        self.compare(campaign, before, "in order")

        campaign.robots.start(campaign.server.relay.rsplit(":", 1)[1])
        before = self.work(campaign)
        wait_until(
            campaign.server.process,
            lambda: self.checkpointed(campaign.store) == sum(settled for _, settled in before.values()),
            ROUND_SECONDS,
            "a checkpoint holds it all",
        )
        campaign.server.kill()
        self.compare(campaign, before, "by a kill")

    def test_sessions_on_sqlite_are_shown_as_they_were(self):
        self.restart_on("sqlite")

    def test_sessions_on_postgres_are_shown_as_they_were(self):
        self.restart_on("postgres")


if __name__ == "__main__":
    unittest.main()
