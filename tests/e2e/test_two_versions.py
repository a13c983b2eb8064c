"""Programs of an older release and of this build on one store: what docs/operate/upgrade.md promises.

`./dev versions-test` gets the older programs and runs this: no build makes them, so it is no CTest test.
"""

import os
import pathlib
import unittest

from harness import BIN, EndToEnd
from two_servers import COUNTS, DEADLINE_SECONDS, ROBOTS, SPANS, A, B, TwoServers

OLDER = pathlib.Path(os.environ.get("UPLINK_OLD_BIN_DIR", ""))
at_hand = unittest.skipUnless(
    os.environ.get("UPLINK_OLD_BIN_DIR"),
    "no older programs: run ./dev versions-test, or name their folder in UPLINK_OLD_BIN_DIR",
)
STORED = 50


@at_hand
class OnPostgres(TwoServers):
    """A is of the older release, which also made the store; B is of this build."""

    programs_of_store = OLDER

    def setUp(self):
        super().setUp()
        self.servers[A].program = OLDER / "uplinkd"

    def upgrade_store(self):
        """As the page says: while the older server runs."""
        self.cluster.migrate()

    def restart(self, place):
        """In its place: its robots wait for it."""
        server = self.servers[place]
        self.road.choose(place)
        self.moves += 1
        self.assertEqual(server.terminate(30), 0, server.text()[-2000:])
        self.start(place)
        self.wait_for(lambda: self.streams(place) == ROBOTS, "the robots came back", place)
        self.wait_until_all_are_online()

    def test_fleets_at_both_agree_though_each_restarts(self):
        self.start(A)
        self.robots_at(A)
        self.upgrade_store()
        self.start(B)
        self.robots_at(B)
        for place in (A, B):
            self.restart(place)
            self.watch(SPANS.after)
        self.assert_histories_are_true()
        for fleet in self.fleets:
            self.assert_agrees(fleet)

    def test_robots_move_to_the_newer_and_back_again(self):
        self.start(A)
        self.robots_at(A)
        self.upgrade_store()
        self.replace(A, B)
        self.replace(B, A)
        self.assert_all_is_stored(self.fleets[0], COUNTS)

    def test_a_store_that_shuts_the_older_out_ends_it_and_says_why(self):
        self.start(A)
        self.cluster.sql(
            "INSERT INTO uplinkd.schema_migrations (version, oldest, name, sha256)"
            " SELECT max(version) + 1, max(version) + 1, 'later', repeat('0', 64) FROM uplinkd.schema_migrations"
        )
        older = self.servers[A]
        self.assertEqual(older.process.wait(DEADLINE_SECONDS), 1, older.text()[-2000:])
        self.assertIn("store_outdated_program", older.text())
        with self.assertRaisesRegex(AssertionError, "run a newer uplinkd"):
            older.start()


@at_hand
class OnSqlite(EndToEnd):
    def test_a_store_of_the_older_goes_on_under_the_newer_and_back_again(self):
        server = self.server()
        server.program = OLDER / "uplinkd"
        server.start()
        fleet = self.fleet(server, "--robots", ROBOTS, "--faults", 5)
        for programs in (BIN, OLDER):
            server.wait_for_status(
                lambda status: int(status["uplinks"]["stored"]) >= STORED, DEADLINE_SECONDS, "robots are at work"
            )
            self.assertEqual(server.terminate(30), 0, server.text()[-2000:])
            server.program = programs / "uplinkd"
            server.start()
        server.wait_for_status(lambda status: int(status["streams"]) == ROBOTS, DEADLINE_SECONDS, "all are back")
        self.assert_agrees(fleet)


if __name__ == "__main__":
    unittest.main()
