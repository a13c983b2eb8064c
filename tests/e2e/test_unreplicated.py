"""Commits whose wait for a synchronous standby somebody cancels: PostgreSQL answers COMMIT with a mere
WARNING then, and the rows may be on no standby."""

import unittest

from chaos import Campaign
from chaos_stores import durable
from harness import EndToEnd, wait_until

CANCELS = 3
# store.shards of the default configuration, each with a connection that writes.
WRITERS = 2
IN_DOUBT = "uplinkd_store_commits_in_doubt_total"
WAITING = "SELECT pid || ' ' || xact_start FROM pg_stat_activity WHERE wait_event = 'SyncRep'"
# Those of transactions that wait are not seen.
CURSORS = "SELECT right(ruri, 3)::int || ' ' || cursor_seq FROM uplinkd.sessions WHERE ruri LIKE 'rcan://chaos/%'"


class Unreplicated(EndToEnd):
    def setUp(self):
        super().setUp()
        self.campaign = Campaign(self.folder, "postgres", 1)
        self.open_things.append(self.campaign)
        self.server = self.campaign.server
        self.cluster = self.campaign.store.cluster

    def set_standby(self, name):
        self.cluster.sql(f"ALTER SYSTEM SET synchronous_standby_names = '{name}'", "postgres")
        self.cluster.sql("SELECT pg_reload_conf()", "postgres")

    def wait_for_waiters(self, before):
        """The transactions that wait for a standby, once each writer has one that is none of `before`."""

        def look():
            found = set(self.cluster.sql(WAITING, "postgres").splitlines())
            return found if len(found) == WRITERS and found.isdisjoint(before) else None

        return wait_until(self.server.process, look, 60, "each writer waits for a standby")

    def test_a_commit_whose_wait_was_cancelled_is_not_acked(self):
        self.campaign.start()
        self.campaign.wait_for_more(100)
        self.set_standby("absent")
        waiters = self.wait_for_waiters(set())
        cursors = dict(map(int, line.split()) for line in self.cluster.sql(CURSORS).splitlines())
        for _ in range(CANCELS):
            for waiter in waiters:
                self.cluster.sql(f"SELECT pg_cancel_backend({waiter.split()[0]})", "postgres")
            # What the first ones wrote is there now. These find it, write nothing, and wait nevertheless.
            waiters = self.wait_for_waiters(waiters)
        self.server.wait_for_status(lambda s: "store" in s["degraded"], 60, "the commits count as failed")
        why = "whether the commit is durable is unknown: canceling wait for synchronous replication"
        wait_until(self.server.process, lambda: why in self.server.text(), 60, "the log says why")
        self.assertEqual(self.server.metric(IN_DOUBT), CANCELS * WRITERS)
        for robot, through in self.campaign.robots.acked().items():
            # A live number after the cursor is acked as it was judged.
            self.assertLessEqual(durable(through), durable(cursors.get(robot, 0)), f"robot {robot}: {through}")

        self.set_standby("")
        self.campaign.wait_for_more(500)
        self.campaign.compare()
        self.assertTrue(self.campaign.clean(), "\n".join([self.campaign.line(), *self.campaign.wrong]))
        self.server.wait_for_status(lambda s: "store" not in s["degraded"], 60, "the store works again")


if __name__ == "__main__":
    unittest.main()
