"""What drones say by calls, on one server: what is shown, what is stored, and what is refused."""

import base64
import json
import unittest

from drone_book import plain
from drone_samples import TYPES, UNSTORED, Kind, alerts, request_of, requests, sample_of, times
from drones import ROOT, DroneTest, files_of, half_a_request, turned_away
from harness import unix_us, uplinkctl

# Of a sample that is not stored.
LIVE = ("APPLIED", "SUPERSEDED")


def camel(field):
    head, *tail = field.split("_")
    return head + "".join(word.capitalize() for word in tail)


class OneServer(DroneTest):
    settings = ""

    def setUp(self):
        super().setUp()
        self.running = self.serve(self.settings)
        self.uav = self.drone(self.running)

    def battery(self, percent, number=1, **more):
        sample = {"id": 0, "voltage_v": 22.25, "remaining_percent": percent}
        return self.call(self.uav, "Battery", sample, number, **more)

    def assert_alive(self):
        """It takes the next sample, whatever came before."""
        self.assert_outcome(self.battery(33, 500), "APPLIED")


class Live(OneServer):
    def test_a_call_of_a_battery_becomes_its_series(self):
        self.assert_outcome(self.battery(87), "APPLIED", dropped={})
        battery = self.shown(self.running)["battery"]["0"]
        self.assertEqual((battery["remainingPercent"], battery["voltageV"]), (87, 22.25))
        self.assertEqual(unix_us(battery["sampledAt"]), times(1)["sampled_at_unix_us"])
        series = self.series(self.running, "rcan_robot_battery_pct")
        self.assertEqual(list(series.values()), [87])
        self.assertIn(ROOT + "d1", next(iter(series)))
        robot = self.robot(self.running)
        self.assertEqual((robot["source"], robot["presence"]), ("uncrew", "online"))

    def test_a_sample_that_is_repeated_is_superseded_and_not_fresher(self):
        self.assert_outcome(self.battery(87), "APPLIED")
        before = self.shown(self.running)["battery"]
        self.assert_outcome(self.battery(87), "SUPERSEDED")
        self.assertEqual(self.shown(self.running)["battery"], before)
        self.assert_outcome(self.battery(87, 2), "APPLIED")
        after = self.shown(self.running)["battery"]
        self.assertGreaterEqual(unix_us(after["0"]["receivedAt"]), unix_us(before["0"]["receivedAt"]))

    def test_a_sample_that_comes_late_is_superseded_unless_the_drone_has_rebooted(self):
        self.assert_outcome(self.battery(50, 100), "APPLIED")
        self.assert_outcome(self.battery(60, 40), "SUPERSEDED")
        self.assertEqual(self.shown(self.running)["battery"]["0"]["remainingPercent"], 50)
        # More than 60 s back.
        self.assert_outcome(self.battery(70, 39), "APPLIED")
        self.assertEqual(self.shown(self.running)["battery"]["0"]["remainingPercent"], 70)

    def test_every_type_is_taken_and_known_again(self):
        for name, each in TYPES.items():
            first, second = (self.publish(self.uav, name, 1) for _ in "12")
            live = each.kind is Kind.LIVE
            with self.subTest(name):
                self.assert_outcome(first, "APPLIED" if live else "STORED", dropped={})
                self.assert_outcome(second, "SUPERSEDED" if live else "DUPLICATE")
        shown = self.shown(self.running)
        for name in UNSTORED:
            part = shown[camel(TYPES[name].field)]
            part = part[TYPES[name].key] if TYPES[name].key else part
            with self.subTest(name):
                self.assertEqual(unix_us(part["sampledAt"]), times(1)["sampled_at_unix_us"])
                self.assertIn("receivedAt", part)
        self.assertIn('winch="6"', next(iter(self.series(self.running, "rcan_robot_winch_line_m"))))
        counts = self.running.get("/api/v1/status")["messagesBySource"]["uncrew"]["counts"]
        counts = {what: int(number) for what, number in counts.items() if int(number)}
        live, durable = len(UNSTORED), len(TYPES) - len(UNSTORED)
        self.assertEqual(counts, {"received": 2 * len(TYPES), "applied": live, "superseded": live,
                                  "stored": durable, "duplicate": durable})  # fmt: skip

    def test_what_is_unknown_is_absent_and_zero_is_zero(self):
        nothing = {"id": 0, "remaining_percent": 0, "voltage_v": "NaN"}
        self.assert_outcome(self.call(self.uav, "Battery", nothing), "APPLIED", dropped={})
        battery = self.shown(self.running)["battery"]["0"]
        self.assertEqual(battery["remainingPercent"], 0)
        self.assertFalse({"voltageV", "temperatureDegc"} & set(battery))


class Stale(OneServer):
    settings = 'stale_after = "2s"\n'

    def test_a_type_that_falls_silent_has_no_series_any_more(self):
        self.assert_outcome(self.battery(87), "APPLIED")
        self.assertTrue(self.series(self.running, "rcan_robot_battery_pct"))
        self.wait(self.running, lambda: not self.series(self.running, "rcan_robot_battery_pct"), "it is stale")
        self.assertEqual(self.shown(self.running)["battery"]["0"]["remainingPercent"], 87)


class Texts(OneServer):
    def messages(self):
        return [row["message"] for row in self.history(self.running, "messages")]

    def test_a_status_text_that_is_sent_twice_is_stored_once(self):
        for outcome in ("STORED", "DUPLICATE", "DUPLICATE"):
            self.assert_outcome(self.publish(self.uav, "StatusText", 7), outcome)
        (row,) = self.history(self.running, "messages")
        self.assertEqual(row["message"], "number 7.")
        self.assertEqual((plain(row["sourceLevel"]), row["level"][:4]), ("warning", "warn"))

    def test_a_text_without_times_is_known_again_only_directly_after_itself(self):
        low, high = ({"type": "STATUS_TEXT_TYPE_ERROR", "text": text} for text in ("low", "high"))
        for sample, outcome in ((low, "STORED"), (low, "DUPLICATE"), (high, "STORED"), (low, "STORED")):
            self.assert_outcome(self.call(self.uav, "StatusText", sample, None), outcome)
        self.assertEqual(self.messages(), ["low", "high", "low"])

    def test_the_last_64_of_a_type_are_known_again(self):
        for number in range(1, 65):
            self.assert_outcome(self.publish(self.uav, "StatusText", number), "STORED")
        for number in (1, 32, 64):
            self.assert_outcome(self.publish(self.uav, "StatusText", number), "DUPLICATE")
        self.assertEqual(self.messages(), [f"number {number}." for number in range(1, 65)])

    def test_what_is_stored_outlasts_a_kill(self):
        self.assert_outcome(self.publish(self.uav, "Error", 1), "STORED")
        self.running.kill()
        self.running.start()
        again = self.drone(self.running)
        self.assert_outcome(self.publish(again, "Error", 1), "DUPLICATE")
        self.assertEqual(len(self.events(self.running, "error")), 1)


class Changes(OneServer):
    def test_each_change_of_mode_is_one_event(self):
        for number, (mode, changes) in enumerate(
            (("HOLD", True), ("HOLD", False), ("MISSION", True), ("MISSION", False), ("HOLD", True))
        ):
            answer = self.call(self.uav, "FlightMode", {"mode": f"FLIGHT_MODE_{mode}"}, number)
            self.assert_outcome(answer, *(("STORED",) if changes else LIVE))
        said = [(plain(row.get("from", "")), plain(row["to"])) for row in self.events(self.running, "flightMode")]
        self.assertEqual(said, [("", "hold"), ("hold", "mission"), ("mission", "hold")])

    def test_a_change_is_told_across_a_kill(self):
        self.assert_outcome(self.call(self.uav, "Armed", {"is_armed": False}, 1), "STORED")
        self.running.kill()
        self.running.start()
        again = self.drone(self.running)
        self.assert_outcome(self.call(again, "Armed", {"is_armed": False}, 2), *LIVE)
        self.assert_outcome(self.call(again, "Armed", {"is_armed": True}, 3), "STORED")
        self.assertEqual(self.events(self.running, "armed"), [{"to": False}, {"from": False, "to": True}])
        self.assertEqual(list(self.series(self.running, "rcan_robot_armed").values()), [1])


class Alerts(OneServer):
    def say(self, sample, number, drone=None):
        return self.call(drone or self.uav, "Alert", sample, number)

    def faults(self):
        return [(row["faultId"], row["active"]) for row in self.listed(self.running, "faults")]

    def test_an_alert_that_is_raised_and_cleared_across_a_kill_has_one_row_each(self):
        self.assert_outcome(self.say(alerts("low"), 1), "STORED")
        self.assertEqual(self.robot(self.running)["activeFaults"], 1)
        self.running.kill()
        self.running.start()
        again = self.drone(self.running)
        self.assert_outcome(self.say(alerts("low"), 1, again), "DUPLICATE")
        # The same set as a new sample changes nothing.
        self.assert_outcome(self.say(alerts("low"), 2, again), "STORED", *LIVE)
        self.assertEqual(self.faults(), [("low", True)])
        self.assert_outcome(self.say(alerts(), 3, again), "STORED")
        self.assert_outcome(self.say(alerts(), 3, again), "DUPLICATE")
        self.assertEqual(self.faults(), [("low", True), ("low", False)])
        self.assertEqual(self.listed(self.running, "faults", more="&active=true"), [])
        self.assertEqual(self.robot(self.running)["activeFaults"], 0)

    def test_an_alert_is_a_fault_of_source_uncrew_and_the_end_of_a_flight_is_critical(self):
        self.assert_outcome(self.say(alerts("low", termination=("fence",)), 1), "STORED")
        active = self.listed(self.running, "faults", more="&active=true")
        self.assertEqual(
            {row["faultId"]: (row["source"], row["severity"]) for row in active},
            {"low": ("uncrew", "major"), "fence": ("uncrew", "critical")},
        )
        self.assertEqual(set(self.shown(self.running)["alerts"]), {"low", "fence"})

    def test_a_set_without_its_message_is_rejected_and_clears_nothing(self):
        self.assert_outcome(self.say(alerts("low"), 1), "STORED")
        self.assert_outcome(self.say(None, 2), "REJECTED", reason="MISSING_FIELD", field="alerts")
        self.assertEqual(self.faults(), [("low", True)])
        self.assertEqual(set(self.shown(self.running)["alerts"]), {"low"})

    def test_an_alert_that_is_named_twice_or_has_no_kind_rejects_the_set(self):
        without = {"alerts": [{"alert_id": "odd"}]}
        for sample, reason in ((alerts("low", "low"), "DUPLICATE_KEY"), (without, "UNKNOWN_VARIANT"),
                               (alerts(*map(str, range(65))), "TOO_MANY_ITEMS")):  # fmt: skip
            self.assert_outcome(self.say(sample, 1), "REJECTED", reason=reason)
        self.assert_outcome(self.say(alerts(*map(str, range(64))), 1), "STORED")
        self.assertEqual(len(self.faults()), 64)


class Requests(OneServer):
    def say(self, sample, number):
        return self.call(self.uav, "OperatorActionRequests", sample, number)

    def listed_requests(self):
        return self.listed(self.running, "operator-requests")

    def open_requests(self):
        robot = self.robot(self.running)
        return robot["operatorRequestsOpen"], set(robot["uncrew"].get("operatorRequests", {}))

    def test_a_request_to_confirm_a_delivery_is_shown_and_withdrawn(self):
        self.assert_outcome(self.say(requests("r1"), 1), "STORED")
        self.assertEqual(self.open_requests(), (1, {"r1"}))
        (row,) = self.listed_requests()
        self.assertEqual((row["requestId"], row["text"]), ("r1", "asks r1"))
        self.assertEqual(plain(row["kind"]), "confirmdeliveryready")
        self.assertNotIn("closedAt", row)
        self.assert_outcome(self.say(requests(), 2), "STORED")
        self.assertEqual(self.open_requests(), (0, set()))
        (row,) = self.listed_requests()
        self.assertGreaterEqual(unix_us(row["closedAt"]), unix_us(row["openedAt"]))

    def test_a_request_is_seen_open_after_a_kill_before_the_drone_calls_again(self):
        self.assert_outcome(self.say(requests("r1"), 1), "STORED")
        self.running.kill()
        self.running.start()
        robot = self.robot(self.running)
        self.assertEqual((robot["operatorRequestsOpen"], robot["source"]), (1, "uncrew"))
        self.assertEqual(self.running.get("/api/v1/robots")["robots"][0]["operatorRequestsOpen"], 1)

    def test_a_request_gives_way_to_the_next_one(self):
        self.assert_outcome(self.say(requests("r1"), 1), "STORED")
        self.assert_outcome(self.say(requests("r2", kind="confirm_delivery_complete"), 2), "STORED")
        self.assertEqual(self.open_requests(), (1, {"r2"}))
        first, second = self.listed_requests()
        self.assertEqual(plain(second["kind"]), "confirmdeliverycomplete")
        self.assertTrue("closedAt" in first and "closedAt" not in second)

    def test_a_set_without_its_message_is_rejected_and_closes_nothing(self):
        self.assert_outcome(self.say(requests("r1"), 1), "STORED")
        answer = self.say(None, 2)
        self.assert_outcome(answer, "REJECTED", reason="MISSING_FIELD", field="operator_action_requests")
        self.assertEqual(self.open_requests(), (1, {"r1"}))

    def test_a_request_without_its_id_is_rejected(self):
        self.assert_outcome(self.say(requests(""), 1), "REJECTED", reason="MISSING_FIELD")
        self.assertEqual(self.listed_requests(), [])


class Content(OneServer):
    # Field 1000, which no message has: 7.
    UNKNOWN_FIELD = base64.b64encode(b"\xc0\x3e\x07").decode()
    # More than the burst of 200, and the 100 of each second that they take.
    CALLS = 360

    def quarantine(self):
        return self.history(self.running, "quarantine")

    def test_half_of_a_message_is_malformed_and_kept_once(self):
        for _ in "12":
            self.assert_outcome(self.publish(self.uav, "Battery", 1, cut=1), "REJECTED", reason="MALFORMED")
        (row,) = self.quarantine()
        self.assertEqual((row["source"], row["reason"]), ("uncrew", "malformed"))
        self.assert_alive()

    def test_half_of_a_request_leaves_nothing(self):
        files = self.certify(self.running.pki, "d1")
        half_a_request(self.running, files, "/uncrew.v1.AvatarService/PublishStatusText")
        self.assert_alive()
        self.assertEqual(self.history(self.running, "messages") + self.quarantine(), [])
        received = self.running.get("/api/v1/status")["messagesBySource"]["uncrew"]["counts"]["received"]
        self.assertEqual(received, "1")

    def test_unknown_fields_are_ignored(self):
        self.assert_outcome(self.battery(87, append=self.UNKNOWN_FIELD), "APPLIED", dropped={})
        self.assertEqual(self.shown(self.running)["battery"]["0"]["remainingPercent"], 87)

    def test_unknown_enumerants_are_kept_as_numbers(self):
        self.assert_outcome(self.call(self.uav, "FlightMode", {"mode": 99}, 1), "STORED")
        self.assert_outcome(self.call(self.uav, "GPSInfo", {"num_satellites": 9, "fix_type": 98}, 1), "APPLIED")
        self.assertIn("99", json.dumps(self.events(self.running, "flightMode")))
        self.assertIn("98", json.dumps(self.shown(self.running)["gpsInfo"]))

    def test_an_invalid_field_of_a_live_sample_is_dropped_and_named(self):
        sample = {"id": 0, "voltage_v": -1, "remaining_percent": 40}
        dropped = {"battery.voltage_v": "OUT_OF_RANGE"}
        self.assert_outcome(self.call(self.uav, "Battery", sample), "APPLIED", dropped=dropped)
        self.assertNotIn("voltageV", self.shown(self.running)["battery"]["0"])
        self.assertEqual(self.quarantine(), [])

    def test_a_sample_with_nothing_valid_is_rejected(self):
        sample = {"id": 0, "remaining_percent": 106}
        self.assert_outcome(self.call(self.uav, "Battery", sample), "REJECTED", reason="OUT_OF_RANGE",
                            field="battery.remaining_percent")  # fmt: skip
        self.assertNotIn("battery", self.shown(self.running))

    def test_an_invalid_durable_sample_is_rejected_and_kept_once(self):
        for _ in "12":
            answer = self.call(self.uav, "StatusText", {"text": "x" * 4097}, 1)
            self.assert_outcome(answer, "REJECTED", reason="TEXT_TOO_LONG", field="status_text.text")
        self.assertEqual(len(self.quarantine()), 1)
        self.assertEqual(self.history(self.running, "messages"), [])

    def test_a_request_over_the_limit_is_refused_alone(self):
        answer = self.call(self.uav, "StatusText", {"text": "x" * (64 << 10)}, 1)
        self.assert_status(answer, "RESOURCE_EXHAUSTED")
        self.assert_alive()

    def test_live_calls_over_the_rate_are_told_when_to_come_again_and_durable_ones_pass(self):
        self.lead(self.uav, self.running, to="second")
        calls = [{"to": ("server", "second")[number % 2], "type": "Battery",
                  "request": request_of("Battery", sample_of("Battery", number), times(number))}
                 for number in range(1, 1 + self.CALLS)]  # fmt: skip
        answers = [answer for at in range(0, self.CALLS, 60)
                   for answer in self.uav.tell("calls", calls=calls[at : at + 60])]  # fmt: skip
        limited = [answer for answer in answers if answer.get("reason") == "RATE_LIMITED"]
        self.assertTrue(limited)
        for answer in limited:
            self.assert_outcome(answer, "REJECTED")
            self.assertGreater(answer["retry_after_ms"], 0)
        self.assert_outcome(self.publish(self.uav, "Error", 1), "STORED")
        self.assertEqual(self.quarantine(), [])


class Identity(DroneTest):
    def setUp(self):
        super().setUp()
        self.running = self.serve()
        self.uav = self.program()

    def connect(self, files, to="server"):
        self.uav.tell("connect", name=to, target=self.running.relay, **files)

    def say(self, uav="", number=1):
        return self.publish(self.uav, "Battery", number, uav=uav)

    def gateway(self, *uavs):
        names = [word for uav in uavs for word in ("--ruri", ROOT + uav)]
        uplinkctl("pki", "gateway", "--dir", self.running.pki, "--name", "hall", "--fleet", "acme", *names)
        self.connect(files_of(self.running.pki, "hall"))

    def test_a_drone_without_a_certificate_does_not_come_in(self):
        self.connect({"ca": str(self.running.pki / "ca.crt")})
        self.assert_status(self.say(), "UNAVAILABLE")
        self.assertGreaterEqual(self.running.metric("uplinkd_handshakes_failed_total"), 1)

    def test_a_certificate_of_a_foreign_authority_does_not_come_in(self):
        other = self.folder / "foreign"
        uplinkctl("pki", "init", "--dir", other)
        self.connect({**self.certify(other, "d1"), "ca": str(self.running.pki / "ca.crt")})
        self.assert_status(self.say(), "UNAVAILABLE")
        self.assertEqual(self.running.get("/api/v1/robots")["robots"], [])

    def test_an_operator_is_no_drone(self):
        uplinkctl("pki", "operator", "--dir", self.running.pki, "--role", "viewer", "--fleet", "acme", "--name", "ann")
        self.connect(files_of(self.running.pki, "ann"))
        self.assert_status(self.say("d1"), "UNAUTHENTICATED")

    def test_a_drone_speaks_for_itself_with_or_without_its_id(self):
        self.connect(self.certify(self.running.pki, "d1"))
        self.assert_outcome(self.say("", 1), "APPLIED")
        self.assert_outcome(self.say("d1", 2), "APPLIED")

    def test_a_drone_does_not_speak_for_another_one(self):
        self.connect(self.certify(self.running.pki, "d1"))
        self.assert_status(self.say("d2"), "PERMISSION_DENIED", "d2")
        self.running.wait_for_line("stream_refused")
        self.assertIn("metadata.uav_id d2", self.running.text())
        self.assertEqual(self.running.get("/api/v1/robots")["robots"], [])
        self.assert_outcome(self.say("d1"), "APPLIED")

    def test_a_gateway_speaks_for_the_drones_that_its_certificate_names(self):
        self.gateway("d1", "d2")
        for uav in ("d1", "d2"):
            self.assert_outcome(self.say(uav), "APPLIED")
            self.assertEqual(self.shown(self.running, uav)["battery"]["0"]["remainingPercent"], 99)
            self.assertIn("CN=hall", self.robot(self.running, uav)["gateway"])
        for uav in ("d3", ""):
            self.assert_status(self.say(uav), "PERMISSION_DENIED")
        self.assertEqual(len(self.running.get("/api/v1/robots")["robots"]), 2)

    def test_a_gateway_without_names_speaks_for_its_fleet(self):
        self.gateway()
        self.assert_outcome(self.say("d7"), "APPLIED")
        self.assertEqual(self.robot(self.running, "d7")["fleet"], "acme")


class Commands(OneServer):
    TIMES = 120

    def test_a_drone_that_asks_for_commands_again_and_again_loses_no_connection(self):
        self.assert_alive()
        before = self.running.metric("uplinkd_connections")
        ends = self.uav.tell("subscribe", to="server", times=self.TIMES, pause=0.05)
        ends = {end: count for end, count in ends.items() if count}
        ((end, count),) = ends.items()
        self.assertEqual(count, self.TIMES)
        code, _, sentence = end.partition(": ")
        self.assertEqual(code, "UNIMPLEMENTED")
        self.assertIn("commands", sentence)
        self.assertEqual(turned_away(self.running), [])
        self.assertEqual(self.running.metric("uplinkd_connections"), before)
        self.assertNotRegex(self.running.text(), r"(?m)^\S+ error ")
        self.assert_outcome(self.battery(20, 501), "APPLIED")

    def test_a_command_that_nobody_here_gave_has_a_result_all_the_same(self):
        for number in (1, 2):
            sample = {"command_id": "ab" * 16, "status": {"state": "STATE_STARTED", "text": f"number {number}."}}
            self.assert_outcome(self.call(self.uav, "UAVCommandResult", sample, number), "STORED")
        found = self.events(self.running, "commandResult")
        self.assertEqual([row["commandId"] for row in found], ["ab" * 16] * 2)

    def test_a_result_without_its_command_is_rejected(self):
        answer = self.call(self.uav, "UAVCommandResult", {"status": {"state": "STATE_FAILED"}}, 1)
        self.assert_outcome(answer, "REJECTED", reason="MISSING_FIELD", field="command_id")


if __name__ == "__main__":
    unittest.main()
