"""uplink-fleet's drones against a real uplinkd: what agrees, and that a disagreement is seen."""

import sqlite3
import unittest

from drones import SETTINGS, rows
from harness import BIN, EndToEnd, mismatches, run, wait_until

WAIT_SECONDS = 60


class DroneFleet(EndToEnd):
    def at_work(self, *flags, stored=30):
        server = self.server(SETTINGS).start()
        fleet = self.fleet(server, "--protocol", "uncrew", *flags)
        self.wait_for_stored(server, stored)
        return server, fleet

    def wait_for_stored(self, server, stored):
        server.wait_for_status(
            lambda status: int(status["messagesBySource"]["uncrew"]["counts"]["stored"]) >= stored,
            WAIT_SECONDS, "the drones are at work",
        )  # fmt: skip

    def test_an_undisturbed_run_agrees_and_nothing_is_sent_twice(self):
        server, fleet = self.at_work("--robots", 3, "--faults", 0.5, stored=60)
        wait_until(
            server.process, lambda: rows(server, "/api/v1/operator-requests"), WAIT_SECONDS,
            "a drone asks for an operator",
        )  # fmt: skip
        report = self.assert_agrees(fleet)
        checks = {check["what"]: check for check in report["checks"]}
        self.assertEqual(report["run"]["resent"], 0, report["run"])
        for what in ("status texts", "events", "alerts raised and cleared", "operator requests, open or closed"):
            self.assertGreater(int(checks[what]["store"]), 0, what)
        self.assertGreater(int(checks["last live values"]["server"]), 3 * 24)
        self.assertGreater(int(checks["settled: superseded"]["server"]), 0)

    def test_lost_links_and_answers_and_wrong_samples_add_up(self):
        _, fleet = self.at_work(
            "--robots", 5, "--faults", 0.5, "--lost-answers", 0.2, "--malformed-share", 0.5,
            "--breaks-per-minute", 20, stored=300,
        )  # fmt: skip
        report = self.assert_agrees(fleet)
        for what in ("resent", "answersLost", "linksCut"):
            self.assertGreater(report["run"][what], 0, what)
        checks = {check["what"]: check for check in report["checks"]}
        self.assertGreater(int(checks["rejected, each wrong sample once"]["server"]), 0)
        self.assertGreater(int(checks["settled: duplicate"]["server"]), 0)

    def test_a_server_that_is_killed_meanwhile_has_everything_once(self):
        server, fleet = self.at_work("--robots", 3, "--faults", 0.5, "--lost-answers", 0.1, stored=60)
        server.kill()
        server.start()
        self.wait_for_stored(server, 60)
        report = self.assert_agrees(fleet)
        self.assertTrue(report["run"]["serverRestarted"])

    def test_a_second_run_on_the_same_server_agrees_too(self):
        server, fleet = self.at_work("--robots", 2, "--faults", 1)
        self.assert_agrees(fleet)
        again = self.fleet(server, "--protocol", "uncrew", "--robots", 2, "--faults", 1)
        self.wait_for_stored(server, 90)
        self.assert_agrees(again)

    def test_rows_that_are_lost_or_changed_are_mismatches(self):
        damages = {
            "status texts": "DELETE FROM messages WHERE rowid IN (SELECT min(rowid) FROM messages)",
            "events": "DELETE FROM events WHERE rowid IN (SELECT min(rowid) FROM events WHERE kind = 'error')",
            "alerts raised and cleared":
                "DELETE FROM faults_history WHERE rowid IN (SELECT min(rowid) FROM faults_history)",
            "operator requests, open or closed": "UPDATE operator_requests SET text = 'other'",
            "wrong on purpose, in quarantine": "UPDATE quarantine SET field = 'other'",
        }  # fmt: skip
        server, fleet = self.at_work("--robots", 2, "--faults", 1, "--malformed-share", 1, stored=100)
        with sqlite3.connect(self.folder / "uplinkd.db", timeout=WAIT_SECONDS) as store:
            for what, damage in damages.items():
                self.assertGreater(store.execute(damage).rowcount, 0, what)
        store.close()
        code, report = fleet.finish()
        self.assertEqual(code, 3)
        self.assertEqual({check["what"] for check in mismatches(report)}, set(damages))

    def test_a_server_that_takes_no_calls_ends_it_with_1(self):
        server = self.server().start()
        done = run(BIN / "uplink-fleet", "--protocol", "uncrew", "--http", server.http, "--target", server.relay,
                   "--pki", server.pki, "--robots", 1, "--for", "2s", code=1)  # fmt: skip
        self.assertIn("no call was answered", done.stderr)

    def test_gateways_and_brokers_are_wrong_use(self):
        for flags in (["--gateways", "1"], ["--cyberwave", "mqtt://h"], ["--lost-answers", "1"]):
            with self.subTest(flags):
                run(BIN / "uplink-fleet", "--protocol", "uncrew", *flags, code=2)


if __name__ == "__main__":
    unittest.main()
