"""What a restart of the server leaves as it was, though no robot has come back yet."""

import unittest

from chaos import ROBOTS, Campaign
from chaos_stores import LIVE_STEP, STEPS
from harness import EndToEnd, wait_until

ROUND_SECONDS = 60
ACKS = 200


def cursor_of(settled):
    """The last number up to `settled` that is stored: a live message leaves no row."""
    return settled - int(settled % STEPS == LIVE_STEP)


class Restart(EndToEnd):
    def sessions(self, server):
        """Session and settled number of each robot, once all are known."""

        def look():
            robots = (server.get(f"/api/v1/robots?pageSize={ROBOTS}") or {"robots": []})["robots"]
            return robots if len(robots) == ROBOTS else None

        robots = wait_until(server.process, look, ROUND_SECONDS, "all robots are known")
        return {robot["ruri"]: (robot["sessionId"], int(robot["settledSeq"])) for robot in robots}

    def work(self, campaign):
        """The robots go away after a while, and all that they sent is settled; what is shown then."""
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
            self.assertEqual(after[ruri], (session, cursor_of(settled)), f"{ruri} after restart {restarts}")
        self.assertTrue(any(settled > 0 for _, settled in before.values()))

    def restart_on(self, store):
        campaign = Campaign(self.folder, store, 5)
        self.open_things.append(campaign)
        campaign.start()
        before = self.work(campaign)
        self.assertEqual(campaign.server.terminate(ROUND_SECONDS), 0)
        self.compare(campaign, before, "in order")

        campaign.robots.start(campaign.server.relay.rsplit(":", 1)[1])
        before = self.work(campaign)
        campaign.server.kill()
        self.compare(campaign, before, "by a kill")

    def test_sessions_on_sqlite_are_shown_as_they_were(self):
        self.restart_on("sqlite")

    def test_sessions_on_postgres_are_shown_as_they_were(self):
        self.restart_on("postgres")


if __name__ == "__main__":
    unittest.main()
