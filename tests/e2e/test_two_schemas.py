"""Two servers of two schema versions on one store: the newer one has a made-up step (tests/chaos/next_schema)."""

import unittest

from harness import BIN, Fleet
from two_servers import COUNTS, DEADLINE_SECONDS, ROBOTS, SPANS, A, B, TwoServers


class TwoSchemas(TwoServers):
    """A is of this schema, B of the next one, which it brings along."""

    def setUp(self):
        super().setUp()
        newer = self.servers[B]
        newer.program = BIN / "uplinkd_next_schema"
        password = self.folder / "owner.password"
        password.write_text("uplinkd_owner\n", encoding="utf-8")
        newer.store_url = newer.store_url.replace("uplinkd@", "uplinkd_owner@")
        newer.settings = "migrate = true\n" + newer.settings.replace(str(self.password), str(password))
        self.start(A)

    def schema(self):
        return self.cluster.sql("SELECT max(version), max(oldest) FROM uplinkd.schema_migrations")

    def shut_out_older(self):
        """While robots stream to A, and those that come again go to B. Returns their fleet."""
        self.start(B)
        fleet = self.keep(Fleet(self.servers[B], "--robots", ROBOTS, "--ruri-prefix", "rcan://two/schemas",
                                "--faults", 1, target=self.road.address))  # fmt: skip
        self.wait_for(lambda: self.streams(A) == ROBOTS, "all stream", A)
        self.road.choose(B)
        self.cluster.sql("UPDATE uplinkd.schema_migrations SET oldest = 6 WHERE version = 6")
        return fleet

    def test_a_step_that_adds_lets_both_go_on(self):
        self.robots_at(A)
        self.assertEqual(self.schema(), "5|1")
        self.start(B)
        self.assertEqual(self.schema(), "6|1")
        self.robots_at(B)
        self.watch(SPANS.after)
        for fleet in self.fleets:
            self.assert_all_is_stored(fleet)
        # The older one starts on it, too.
        self.assertEqual(self.servers[A].terminate(30), 0, self.servers[A].text()[-2000:])
        self.start(A)

    def test_a_step_that_shuts_the_older_out_ends_it_in_order_and_the_newer_goes_on(self):
        fleet = self.shut_out_older()
        older = self.servers[A]
        self.assertEqual(older.process.wait(DEADLINE_SECONDS), 1, older.text()[-2000:])
        for line in ("store_outdated_program", "run a newer uplinkd", " draining ", " stopped"):
            self.assertIn(line, older.text())
        self.wait_for(lambda: self.streams(B) == ROBOTS, "the robots came", B)
        self.watch(SPANS.after, [B])
        self.assert_all_is_stored(fleet, COUNTS)
        with self.assertRaisesRegex(AssertionError, "run a newer uplinkd"):
            older.start()

    def test_one_that_learns_it_by_a_new_connection_gives_its_lease_up(self):
        fleet = self.shut_out_older()
        self.cluster.crash()
        older = self.servers[A]
        self.assertEqual(older.process.wait(DEADLINE_SECONDS), 1, older.text()[-2000:])
        self.assertIn("store_outdated_program", older.text())
        self.assertNotIn("lease_not_released", older.text())
        self.wait_for(lambda: self.streams(B) == ROBOTS, "the robots came", B)
        self.assert_all_is_stored(fleet, COUNTS)
        self.assertNotIn("why=silent", self.servers[B].text())


if __name__ == "__main__":
    unittest.main()
