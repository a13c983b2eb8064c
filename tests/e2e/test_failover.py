"""A primary that dies under load, with a standby that acks wait for."""

import unittest

from chaos import ROBOTS, Campaign
from harness import EndToEnd, Standby, wait_until


class Failover(EndToEnd):
    def test_with_a_synchronous_standby_nothing_that_was_acked_is_lost(self):
        campaign = Campaign(self.folder, "postgres", 1)
        self.open_things.append(campaign)
        primary = campaign.store.cluster
        standby = Standby(self.folder, primary)
        self.open_things.append(standby)
        primary.sql("ALTER SYSTEM SET synchronous_standby_names = 'standby'", "postgres")
        primary.sql("SELECT pg_reload_conf()", "postgres")
        places = [primary.place, standby.place]
        campaign.server.store_url = "postgresql://uplinkd@/uplinkd?" + "&".join(
            f"{key}=" + ",".join(place[name] for place in places)
            for key, name in (("host", "folder"), ("port", "port"))
        )
        campaign.start()
        campaign.wait_for_more(500)
        state = "SELECT sync_state FROM pg_stat_replication WHERE application_name = 'standby'"
        self.assertEqual(primary.sql(state, "postgres"), "sync")

        primary.halt()
        campaign.server.wait_for_status(lambda s: "store" in s["degraded"], 60, "the primary is away")
        acked = dict(campaign.robots.acked())
        self.assertEqual(int(campaign.server.get("/api/v1/status")["streams"]), ROBOTS, "robots stay connected")
        # The standby alone takes no writes: acks wait until somebody promotes it.
        standby.promote()
        campaign.store.cluster = standby
        campaign.wait_for_more(500)
        wait_until(
            campaign.server.process,
            lambda: "store" not in (campaign.server.get("/api/v1/status") or {"degraded": ["store"]})["degraded"],
            60,
            "the standby serves",
        )
        self.assertGreater(sum(campaign.robots.acked().values()), sum(acked.values()))
        campaign.compare()
        self.assertTrue(campaign.clean(), "\n".join([campaign.line(), *campaign.wrong]))


if __name__ == "__main__":
    unittest.main()
