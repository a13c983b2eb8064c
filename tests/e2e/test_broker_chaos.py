"""The crash campaign with a broker in short, and its canaries."""

import unittest

from broker_chaos import BrokerCampaign
from broker_chaos_pair import PairCampaign
from broker_watch import breach
from harness import EndToEnd

KILLS = 12
# A run ends with the first loss, mostly within 30; one in eight ran 60 kills where the disk is memory.
CANARY_KILLS = 240


class BrokerChaos(EndToEnd):
    def keep(self, campaign):
        self.open_things.append(campaign)
        return campaign

    def expect_clean(self, campaign, kills=KILLS):
        self.assertTrue(campaign.run(kills), "\n".join([campaign.line(), *campaign.wrong]))
        self.assertEqual(campaign.done, kills)
        self.assertGreater(campaign.acked, 100 * kills)
        self.assertGreater(campaign.watch.scrapes, kills)

    def test_kills_on_sqlite_lose_and_double_no_message(self):
        self.expect_clean(self.keep(BrokerCampaign(self.folder, "sqlite", 2)))

    def test_kills_on_postgres_lose_and_double_no_message(self):
        self.expect_clean(self.keep(BrokerCampaign(self.folder, "postgres", 2)))

    def test_kills_of_two_servers_in_turn_lose_and_double_no_message(self):
        campaign = self.keep(PairCampaign(self.folder, 2))
        # That one takes over 30 s.
        del campaign.kinds["stall"]
        self.expect_clean(campaign, KILLS // 2)

    def test_a_server_that_acks_messages_on_arrival_is_found(self):
        campaign = self.keep(BrokerCampaign(self.folder, "sqlite", 2, "acks_on_arrival"))
        campaign.run(CANARY_KILLS)
        self.assertTrue(campaign.canary_found(), campaign.line())

    def test_a_server_that_forgets_deliveries_is_found(self):
        campaign = self.keep(BrokerCampaign(self.folder, "sqlite", 2, "forgets_deliveries"))
        campaign.run(CANARY_KILLS)
        self.assertTrue(campaign.canary_found(), campaign.line())


class TheLaw(unittest.TestCase):
    def test_what_is_received_is_settled_or_in_flight(self):
        sums = {"messages_received_total": 10, "messages_settled_total": 7, "messages_in_flight": 3}
        self.assertEqual(breach(sums), "")
        self.assertNotEqual(breach(sums | {"messages_settled_total": 8}), "")
        self.assertNotEqual(breach(sums | {"messages_settled_total": 11, "messages_in_flight": -1}), "")


if __name__ == "__main__":
    unittest.main()
