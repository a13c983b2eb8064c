"""A copy that was taken under load serves, after the store itself is gone."""

import sqlite3
import unittest

from chaos import Campaign
from chaos_stores import durable
from harness import EndToEnd, run


class Backup(EndToEnd):
    def take_and_restore(self, campaign, take, restore):
        """What was acked after the copy was taken is lost with the store; nothing else is."""
        campaign.start()
        campaign.wait_for_more(500)
        at_least = dict(campaign.robots.acked())
        take()
        campaign.wait_for_more(500)
        campaign.robots.kill()
        campaign.server.terminate(60)
        lost_from = dict(campaign.robots.acked())
        restore()

        campaign.start()
        campaign.wait_for_more(500)
        campaign.robots.kill()
        campaign.server.terminate(60)
        acked = campaign.robots.acked()
        listed = ", ".join(f"('rcan://chaos/robot-{robot:03}', {t})" for robot, t in lost_from.items())
        for robot, row in enumerate(campaign.store.rows(listed)):
            _, t, cursor, n, numbers, kept, wrong, top, *_ = row
            self.assertEqual((n, wrong), (numbers, 0), "a row doubled, or not what its number says")
            self.assertGreaterEqual(kept, durable(at_least[robot]), "what was acked before the copy is there")
            # The robot went on above all that it was told is durable, and that is all there.
            self.assertGreaterEqual(cursor, acked[robot] - 1)
            self.assertEqual(top, cursor)
            self.assertEqual(numbers - kept, durable(cursor) - durable(t))

    def campaign(self, store):
        campaign = Campaign(self.folder, store, 1)
        self.open_things.append(campaign)
        return campaign

    def test_a_dump_of_postgres(self):
        campaign = self.campaign("postgres")
        cluster = campaign.store.cluster
        dump = self.folder / "uplinkd.dump"

        def take():
            run("pg_dump", "--format=custom", "--file", dump, cluster.url("uplinkd_owner"), timeout=120)

        def restore():
            cluster.sql("DROP DATABASE uplinkd", "postgres")
            cluster.create()
            run("pg_restore", "--exit-on-error", "--dbname", cluster.url("uplinkd_owner"), dump, timeout=120)

        self.take_and_restore(campaign, take, restore)

    def test_a_copy_of_sqlite(self):
        campaign = self.campaign("sqlite")
        copy = self.folder / "copy.db"
        store = campaign.store.path

        def take():
            file = sqlite3.connect(store)
            file.execute("VACUUM INTO ?", (str(copy),))
            file.close()

        def restore():
            for path in store.parent.glob("uplinkd.db*"):
                path.unlink()
            copy.rename(store)

        self.take_and_restore(campaign, take, restore)


if __name__ == "__main__":
    unittest.main()
