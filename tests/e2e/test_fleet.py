"""uplink-fleet against a real uplinkd: what agrees, and that a disagreement is seen."""

import signal
import sqlite3
import unittest
import urllib.parse

from harness import BIN, EndToEnd, mismatches, run, uplinkctl, wait_until

WAIT_SECONDS = 30


class FleetRun(EndToEnd):
    def at_work(self, *flags):
        server = self.server().start()
        fleet = self.fleet(server, *flags)
        server.wait_for_status(
            lambda status: int(status["uplinks"]["stored"]) >= 30, WAIT_SECONDS, "the fleet is at work"
        )
        return server, fleet

    def wait_for_rows(self, server, fleet, ruri):
        name = urllib.parse.quote(ruri, safe="")
        lists = {
            f"/api/v1/faults?ruri={name}": "faults",
            f"/api/v1/missions?ruri={name}": "missions",
            f"/api/v1/events?ruri={name}": "events",
            f"/api/v1/presence?ruri={name}": "presenceChanges",
            f"/api/v1/quarantine?ruri={name}": "quarantined",
            f"/api/v1/objects?ruri={name}": "objects",
        }
        for path, rows in lists.items():
            wait_until(
                fleet.process, lambda path=path, rows=rows: server.get(path)[rows], WAIT_SECONDS, f"rows at {path}"
            )

    def test_an_undisturbed_run_agrees_to_the_message(self):
        server, fleet = self.at_work("--robots", 10, "--faults", 10)
        # By then each robot has shared something.
        server.wait_for_status(lambda status: int(status["uplinks"]["stored"]) >= 100, WAIT_SECONDS, "all work")
        report = self.assert_agrees(fleet)
        checks = {check["what"]: check for check in report["checks"]}
        self.assertEqual(report["run"]["resent"], 0)
        # Nothing was sent twice, so the server counts exactly what was sent.
        self.assertEqual(checks["messages with repeats"]["fleet"], checks["messages with repeats"]["server"])
        # One of the ten declines what the others share.
        self.assertEqual(checks["receivers that showed what they hold"]["server"], "9")
        self.assertGreaterEqual(int(checks["forwarded items"]["server"]), 9 * 9)
        self.assertEqual(checks["forward violations"]["server"], "0")
        due, rest = checks["forwards due = the rest"]["server"].split(" = ")
        self.assertEqual(due, rest)
        self.assertGreater(int(due), 0)
        self.assertGreater(int(checks["forwards written"]["fleet"]), 0)

    def test_a_server_that_asks_who_asks_is_shown_a_token_by_https(self):
        server = self.server()
        tokens = self.folder / "tokens"
        made = uplinkctl("tokens", "new", "--tokens-file", tokens, "--role", "viewer", "--fleet", "*")
        token = self.folder / "caller.token"
        token.write_text(made.stdout, encoding="utf-8")
        token.chmod(0o600)
        server.settings = (f'[http]\ntls.certificate_file = "{server.pki}/server.crt"\n'
                           f'tls.key_file = "{server.pki}/server.key"\n'
                           f'tokens_file = "{tokens}"\nplain_from = ["192.0.2.1"]\n')  # fmt: skip
        server.start()
        at = [BIN / "uplink-fleet", "--target", server.relay, "--http", f"https://{server.http}", "--pki", server.pki,
              "--robots", 2, "--for", "1s", "--pace", 10]  # fmt: skip
        trust = ["--http-ca", server.pki / "ca.crt"]
        self.assertIn("verification: all agree", run(*at, *trust, "--http-token-file", token).stdout)
        for flags, code, why in (
            (trust, 1, "401"),
            (["--http-token-file", token], 1, "is not believed"),
            ([*trust, "--http-token-file", self.folder / "none"], 2, "none"),
            (["--http", server.http, *trust], 2, "--http-ca"),
            (["--http", "https://a/b"], 2, "path"),
        ):
            with self.subTest(flags):
                # A flag is given once.
                command = at[:3] + at[5:] if "--http" in flags else at
                self.assertIn(why, run(*command, *flags, code=code).stderr)

    def test_acks_alone_decide_where_http_is_out_of_reach(self):
        server = self.server().start()
        done = run(BIN / "uplink-fleet", "--acks-only", "--target", server.relay, "--http", "127.0.0.1:1",
                   "--pki", server.pki, "--robots", 3, "--for", "1s", "--pace", 10)  # fmt: skip
        self.assertRegex(done.stdout, r"durable messages acked +\| +[1-9]")
        self.assertIn("verification: all agree", done.stdout)

    def test_robots_that_join_late_have_what_the_others_share(self):
        # They come with the end of the run, which is sooner than three quarters of its hour.
        server, fleet = self.at_work("--robots", 10, "--late-share", 0.2, "--declining-share", 0)
        self.assertLessEqual(len(server.get("/api/v1/robots")["robots"]), 8)
        report = self.assert_agrees(fleet)
        late = report["run"]["latencyMs"]["lateSnapshot"]
        self.assertEqual(late["count"], 2)
        self.assertLess(late["max"], 1000 * WAIT_SECONDS)

    def test_a_fleet_that_declines_gets_nothing(self):
        _, fleet = self.at_work("--robots", 5, "--declining-share", 1)
        report = self.assert_agrees(fleet)
        checks = {check["what"]: check for check in report["checks"]}
        self.assertEqual(report["run"]["receivers"], 0)
        self.assertEqual(checks["forwards due = the rest"]["server"], "0 = 0")

    def test_an_end_that_is_not_forwarded_is_a_mismatch(self):
        server, fleet = self.at_work("--robots", 3, "--declining-share", 0)

        def markers():
            return [each for each in server.get("/api/v1/objects")["objects"] if each["id"].endswith("-marker")]

        wait_until(fleet.process, lambda: len(markers()) == 3, WAIT_SECONDS, "each robot has marked its base")
        with sqlite3.connect(self.folder / "uplinkd.db", timeout=WAIT_SECONDS) as store:
            store.execute("DROP TRIGGER objects_removed")
            damage = "DELETE FROM objects WHERE id LIKE '%-1-marker'"
            self.assertGreater(store.execute(damage).rowcount, 0)
        store.close()
        code, report = fleet.finish()
        self.assertEqual(code, 3)
        found = [each for each in report["differences"] if each["what"] == "forwarded items"]
        # The two others still hold it.
        self.assertEqual(len(found), 2, report["differences"])
        self.assertIn("-1-marker@", found[0]["found"])

    def test_breaks_batches_and_wrong_messages_add_up(self):
        server, fleet = self.at_work(
            "--robots", 10, "--rate", 20, "--faults", 10, "--batch", 5,
            "--breaks-per-minute", 60, "--malformed-share", 0.1,
        )  # fmt: skip
        wait_until(fleet.process, lambda: fleet.breaks() >= 30, WAIT_SECONDS, "30 breaks")
        report = self.assert_agrees(fleet)
        self.assertFalse(report["run"]["serverRestarted"])
        self.assertGreater(report["run"]["breaks"], 0)
        self.assertGreater(report["run"]["resent"], 0)
        self.assertGreater(report["run"]["rejects"], 0)
        acked = next(check for check in report["checks"] if check["what"] == "durable messages acked")
        self.assertEqual(str(report["run"]["ackedDurable"]), acked["server"], "one count, without the wrong ones")

    def test_robots_by_the_grpc_library_agree_though_their_streams_break(self):
        _, fleet = self.at_work(
            "--client", "grpc", "--robots", 10, "--rate", 20, "--faults", 10, "--batch", 5,
            "--breaks-per-minute", 60, "--malformed-share", 0.1,
        )  # fmt: skip
        wait_until(fleet.process, lambda: fleet.breaks() >= 30, WAIT_SECONDS, "30 breaks")
        report = self.assert_agrees(fleet)
        self.assertGreater(report["run"]["breaks"], 0)
        self.assertGreater(report["run"]["rejects"], 0)

    def test_robots_behind_gateways_agree_though_their_connections_break(self):
        server, fleet = self.at_work("--robots", 10, "--gateways", 2, "--breaks-per-minute", 20)
        names = {"CN=gateway-0001,OU=gateway,O=default", "CN=gateway-0002,OU=gateway,O=default"}
        wait_until(
            fleet.process,
            lambda: {robot["gateway"] for robot in server.get("/api/v1/robots")["robots"]} == names,
            WAIT_SECONDS,
            "each robot speaks through one of the two",
        )
        wait_until(fleet.process, lambda: fleet.breaks() >= 20, WAIT_SECONDS, "20 breaks")
        report = self.assert_agrees(fleet)
        self.assertGreater(report["run"]["breaks"], 0)

    def test_a_scenario_by_name_and_from_a_file_with_a_flag_before_it(self):
        server = self.server().start()
        file = self.folder / "scenario.toml"
        file.write_text("robots = 2\npace = 4\nmalformed_share = 0.5\n", encoding="utf-8")
        for scenario, robots in (("storm", 10), (file, 2)):
            with self.subTest(scenario):
                fleet = self.fleet(server, "--scenario", scenario, "--faults", 5)
                before = int(server.get("/api/v1/status")["uplinks"]["stored"])
                server.wait_for_status(
                    lambda status: int(status["uplinks"]["stored"]) > before + 30, WAIT_SECONDS, "at work"
                )
                report = self.assert_agrees(fleet)
                self.assertEqual(report["run"]["robots"], robots)
                self.assertGreater(report["run"]["rejects"], 0)

    def test_a_second_signal_ends_it_though_its_server_is_gone(self):
        server, fleet = self.at_work("--robots", 3, "--faults", 10)
        server.kill()
        # Two that differ, since the second of two equal ones is lost while the first one waits.
        fleet.process.send_signal(signal.SIGINT)
        fleet.process.send_signal(signal.SIGTERM)
        fleet.process.communicate(timeout=15)  # one alone: until the server is back, or minutes
        self.assertEqual(fleet.process.returncode, 1, fleet.log())

    def test_a_second_signal_still_closes_and_compares_while_the_server_answers(self):
        _, fleet = self.at_work("--robots", 20, "--faults", 10)
        fleet.process.send_signal(signal.SIGTERM)
        _, report = fleet.finish()  # the other signal
        checks = {check["what"]: check["ok"] for check in report["checks"]}
        self.assertTrue(checks["streams ended OK"], report["checks"])

    def test_a_second_run_on_the_same_server_agrees_too(self):
        server, fleet = self.at_work("--robots", 3, "--faults", 20)
        self.assert_agrees(fleet)
        again = self.fleet(server, "--robots", 3, "--faults", 20)
        before = int(server.get("/api/v1/status")["uplinks"]["stored"])
        server.wait_for_status(
            lambda status: int(status["uplinks"]["stored"]) > before, WAIT_SECONDS, "it is at work again"
        )
        self.assert_agrees(again)

    def test_rows_that_are_lost_or_changed_after_their_ack_are_mismatches(self):
        """One damage to each table that nothing sent later would repair."""
        damages = {
            "fault reports": "DELETE FROM faults_history WHERE rowid IN (SELECT min(rowid) FROM faults_history)",
            "events": "DELETE FROM events WHERE rowid IN (SELECT min(rowid) FROM events)",
            "mission updates": "UPDATE mission_runs SET updates = updates + 1 WHERE rowid = 1",
            "objects present": "DELETE FROM objects WHERE id LIKE '%-1-marker'",
            "latest UI capabilities": "UPDATE latest SET body = '{}' WHERE kind = 2",
            "presence histories": "UPDATE presence_changes SET presence = 2",
            "wrong on purpose, in quarantine": "UPDATE quarantine SET field = 'other'",
        }
        server, fleet = self.at_work("--robots", 3, "--faults", 20, "--malformed-share", 0.2)
        for robot in server.get("/api/v1/robots")["robots"]:
            self.wait_for_rows(server, fleet, robot["ruri"])
        with sqlite3.connect(self.folder / "uplinkd.db", timeout=WAIT_SECONDS) as store:
            for what, damage in damages.items():
                self.assertGreater(store.execute(damage).rowcount, 0, what)
        store.close()
        code, report = fleet.finish()
        self.assertEqual(code, 3)
        self.assertFalse(report["ok"])
        self.assertLessEqual(set(damages), {check["what"] for check in mismatches(report)})
        found = {difference["what"] for difference in report["differences"]}
        self.assertLessEqual(set(damages), found)


class FleetUse(EndToEnd):
    def test_wrong_use_ends_with_2(self):
        for flags in (
            ["--robots", "0"], ["--for", "soon"], ["--target", "nowhere"], ["--malformed-share", "2"],
            ["--report", "xml"], ["--no-such-flag"], ["--seed", "-1"], ["--ruri-prefix", "http://x"],
            ["--scenario", "no-such-scenario"], ["--pace", "0"], ["--late-share", "2"], ["--declining-share", "x"],
            ["--robots", "3", "--gateways", "4"], ["--robots", "257", "--gateways", "1"],
            ["--client", "pigeon"], ["--client", "grpc", "--gateways", "1"],
            ["--client", "grpc", "--scenario", "flapping_network"],
        ):  # fmt: skip
            with self.subTest(flags):
                run(BIN / "uplink-fleet", *flags, code=2)

    def test_wrong_use_of_a_broker_names_the_flag_and_no_key_of_the_server(self):
        empty = self.folder / "empty"
        empty.touch()
        for flags, why in (
            (["--cyberwave", "http://h"], "--cyberwave: the URL begins with neither mqtts:// nor mqtt://"),
            (["--cyberwave", "mqtt://u:secret@h"], "--cyberwave: the URL holds a user"),
            (["--cyberwave", "mqtts://h"], "--cyberwave: mqtts:// needs --mqtt-ca"),
            (["--cyberwave", "mqtt://h", "--cyberwave-prefix", "a+"],
             "--cyberwave-prefix: at most 100 bytes without + and #"),
            (["--cyberwave", "mqtt://h", "--mqtt-password-file", empty],
             "--mqtt-password-file: its first line is empty"),
        ):  # fmt: skip
            with self.subTest(flags):
                self.assertEqual(run(BIN / "uplink-fleet", *flags, code=2).stderr, f"uplink-fleet: {why}\n")

    def test_acks_alone_do_not_decide_for_drones(self):
        done = run(BIN / "uplink-fleet", "--acks-only", "--protocol", "uncrew", code=2)
        self.assertIn("--acks-only", done.stderr)

    def test_a_server_that_cannot_be_reached_ends_with_1_and_is_named(self):
        done = run(BIN / "uplink-fleet", "--http", "127.0.0.1:1", code=1)
        self.assertIn("127.0.0.1:1", done.stderr)

    def test_a_missing_authority_ends_with_1_and_is_named(self):
        server = self.server().start()
        nowhere = self.folder / "nowhere"
        done = run(BIN / "uplink-fleet", "--http", server.http, "--target", server.relay,
                   "--pki", nowhere, code=1)  # fmt: skip
        self.assertIn(str(nowhere / "ca.crt"), done.stderr)

    def test_robots_of_a_foreign_authority_are_not_welcomed(self):
        server = self.server().start()
        foreign = self.folder / "foreign"
        run(BIN / "uplinkctl", "pki", "init", "--dir", foreign)
        done = run(BIN / "uplink-fleet", "--http", server.http, "--target", server.relay,
                   "--pki", foreign, "--robots", 1, "--for", "2s", code=1)  # fmt: skip
        self.assertIn("no robot was welcomed", done.stderr)


if __name__ == "__main__":
    unittest.main()
