"""Each scenario that uplink-fleet ships, against a real uplinkd: what it does happens, and all adds
up."""

import pathlib
import unittest

from harness import BIN, EndToEnd, run, wait_until

WAIT_SECONDS = 60
FOLDER = pathlib.Path(__file__).parents[1] / "load" / "scenarios"


class Scenarios(EndToEnd):
    def setUp(self):
        super().setUp()
        self.uplinkd = self.server().start()

    def stored(self):
        return int(self.uplinkd.get("/api/v1/status")["uplinks"]["stored"])

    def play(self, scenario, robots, *flags, stored=30, breaks=0):
        """Until so much was stored and so many connections were broken; gives the report."""
        before = self.stored()
        fleet = self.fleet(self.uplinkd, "--scenario", scenario, "--robots", robots, *flags)
        wait_until(
            fleet.process, lambda: self.stored() >= before + stored, WAIT_SECONDS, f"{scenario} at work"
        )
        wait_until(fleet.process, lambda: fleet.breaks() >= breaks, WAIT_SECONDS, f"{breaks} breaks")
        return self.assert_agrees(fleet)["run"]

    def test_those_that_only_send(self):
        for name, robots in (("calm", 3), ("steady", 20), ("paced", 5), ("idle", 5), ("batch", 5)):
            with self.subTest(name):
                run_ = self.play(name, robots, stored=10)
                self.assertEqual(run_["resent"], 0)
                self.assertGreater(run_["latencyMs"]["durable"]["count"], 0)
                self.assertGreater(run_["server"]["rssBytes"], 0)

    def test_flood(self):
        fleet = self.fleet(self.uplinkd, "--scenario", "flood", "--robots", 2)
        self.uplinkd.wait_for_status(
            lambda status: int(status["uplinks"]["received"]) >= 20_000, WAIT_SECONDS, "20,000 messages"
        )
        report = self.assert_agrees(fleet)["run"]
        self.assertGreater(report["latencyMs"]["live"]["count"], 20_000)

    def test_malformed_and_fault_storm(self):
        self.assertGreater(self.play("malformed", 10)["rejects"], 0)
        self.assertGreater(self.play("fault_storm", 5, stored=500)["ackedDurable"], 500)

    def test_the_network_that_flaps(self):
        report = self.play("flapping_network", 30, breaks=20)
        self.assertGreater(report["connects"], 45)
        self.assertGreater(report["resent"], 0)

    def test_a_reconnect_storm(self):
        scenario = self.folder / "storm.toml"
        text = (FOLDER / "reconnect_storm.toml").read_text(encoding="utf-8")
        scenario.write_text(text.replace('storm_every = "20s"', 'storm_every = "2s"'), encoding="utf-8")
        report = self.play(scenario, 50, breaks=100)
        self.assertGreaterEqual(report["connects"], 150)

    def test_a_backlog_of_an_hour(self):
        report = self.play("backlog", 2, "--faults", 1, stored=5000)
        self.assertGreater(report["ackedDurable"], 5000)

    def test_a_takeover_war(self):
        fleet = self.fleet(self.uplinkd, "--scenario", "takeover_war", "--robots", 5)
        wait_until(
            fleet.process,
            lambda: self.uplinkd.metric("uplinkd_takeovers_total") >= 30,
            WAIT_SECONDS,
            "30 takeovers",
        )
        wait_until(
            fleet.process,
            lambda: any(robot["contested"] for robot in self.uplinkd.get("/api/v1/robots")["robots"]),
            WAIT_SECONDS,
            "a robot is contested",
        )
        report = self.assert_agrees(fleet)["run"]
        self.assertGreaterEqual(report["takeovers"], 30)
        self.assertGreater(report["ends"]["ABORTED"], 0)
        self.assertNotIn("INVALID_ARGUMENT", report["ends"])

    def test_slow_readers(self):
        report = self.play("slow_readers", 10, stored=200)
        # Half of them read nothing for three of four seconds.
        self.assertGreater(report["latencyMs"]["durable"]["max"], 1000)

    def test_the_phases_of_a_day(self):
        day = self.folder / "day.toml"
        text = (FOLDER / "mixed_day.toml").read_text(encoding="utf-8")
        for seconds in ("15s", "20s", "30s"):
            text = text.replace(f'for = "{seconds}"', 'for = "2s"')
        day.write_text(text, encoding="utf-8")
        report = self.play(day, 30, stored=1000, breaks=5)
        self.assertGreater(report["breaks"], 0)


class Help(unittest.TestCase):
    def test_it_names_every_file(self):
        text = run(BIN / "uplink-fleet", "--help").stdout
        for file in FOLDER.glob("*.toml"):
            self.assertIn(f"{file.stem}: ", text)


if __name__ == "__main__":
    unittest.main()
