"""The crash campaign in short, its canaries, and two servers on one database."""

import unittest

from chaos import Campaign, Robots
from chaos_pair import PairCampaign
from harness import EndToEnd, Server, wait_until

KILLS = 25


class Chaos(EndToEnd):
    def campaign(self, store, seed, canary=None):
        campaign = Campaign(self.folder, store, seed, canary)
        self.open_things.append(campaign)
        return campaign

    def expect_clean(self, campaign):
        self.assertTrue(campaign.run(KILLS), "\n".join([campaign.line(), *campaign.wrong]))
        self.assertEqual(campaign.done, KILLS)
        self.assertGreater(campaign.acked, KILLS)

    def test_kills_on_sqlite_lose_nothing_and_double_nothing(self):
        self.expect_clean(self.campaign("sqlite", 1))

    def test_kills_on_postgres_lose_nothing_and_double_nothing(self):
        self.expect_clean(self.campaign("postgres", 1))

    def test_kills_of_two_servers_in_turn_make_nobody_offline(self):
        campaign = PairCampaign(self.folder, 1)
        self.open_things.append(campaign)
        self.expect_clean(campaign)

    def test_a_server_that_acks_before_the_commit_is_found(self):
        campaign = self.campaign("sqlite", 1, "acks_early")
        campaign.run(4 * KILLS)
        self.assertGreater(campaign.lost, 0, campaign.line())

    def test_a_store_that_does_not_sync_is_found(self):
        campaign = self.campaign("sqlite", 1, "unsynced")
        campaign.run(KILLS)
        self.assertGreater(campaign.lost, 0, campaign.line())


class TwoServers(EndToEnd):
    """The same robots, with the same sessions and numbers, at two servers of one database at once."""

    def test_the_older_stream_ends_and_nothing_is_doubled(self):
        campaign = Campaign(self.folder, "postgres", 7)
        self.open_things.append(campaign)
        campaign.start()
        folder = self.folder / "other"
        folder.mkdir()
        (folder / "pki").symlink_to(self.folder / "pki")
        other = Server(folder, store_url=campaign.store.url).start()
        self.open_things.append(other)
        twins = Robots(folder, 7, pace_ms=50)
        twins.start(other.relay.rsplit(":", 1)[1])
        try:
            for _ in range(10):
                for robots in (campaign.robots, twins):
                    before = robots.count()
                    wait_until(robots.process, lambda r=robots, b=before: r.count() > b + 100, 60, "acks")
                campaign.compare()
                self.assertTrue(campaign.clean(), "\n".join([campaign.line(), *campaign.wrong]))
            # Each server saw its robots go to the other one.
            for server in (campaign.server, other):
                self.assertGreater(server.metric("uplinkd_streams_superseded_total"), 0)
        finally:
            twins.kill()
        campaign.robots.through = {
            robot: max(through, twins.acked()[robot])
            for robot, through in campaign.robots.acked().items()
        }
        campaign.compare()
        self.assertTrue(campaign.clean(), "\n".join([campaign.line(), *campaign.wrong]))


if __name__ == "__main__":
    unittest.main()
