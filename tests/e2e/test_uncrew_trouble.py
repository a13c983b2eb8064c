"""Drones while something is wrong: answers that get lost, a store that takes no writes, a server that stops or
is killed, and calls that are too many."""

import threading
import unittest

from drone_samples import alerts, request_of, requests, sample_of, times
from drones import SECONDS, DroneTest, store_locked
from harness import wait_until
from tcp_proxy import TcpProxy

# Calls of one drone that may be under way at once.
IN_FLIGHT_MAX = 64
ANSWER_SECONDS = 2
ANSWERS = f'answer_within = "{ANSWER_SECONDS}s"\n'
DRAIN_SECONDS = 20
KILLS = 4
# Durable samples that a flight has settled between two troubles.
LEG = 40
# A drone that connects anew to a server on a busy machine needs some of it.
LEG_SECONDS = 120


class DeafProxy(TcpProxy):
    """Loses what a server says while `deaf`; connections that lost something are of no use afterwards."""

    deaf = False

    def _take(self, ends, source, data):
        return b"" if self.deaf and source is ends[1] else data


class LostAnswers(DroneTest):
    def test_a_sample_whose_answer_is_lost_is_known_when_it_is_sent_again(self):
        server = self.serve()
        proxy = self.keep(DeafProxy(server.relay))
        uav = self.drone(server, target=proxy.address)
        self.assert_outcome(self.publish(uav, "Battery", 1), "APPLIED")
        proxy.deaf = True
        self.assert_status(self.publish(uav, "StatusText", 1, deadline=ANSWER_SECONDS), "DEADLINE_EXCEEDED")
        self.wait(server, lambda: self.history(server, "messages"), "it is stored")
        proxy.deaf = False
        proxy.drop()
        self.lead(uav, server)
        self.assert_outcome(self.publish(uav, "StatusText", 1), "DUPLICATE")
        self.assertEqual(len(self.history(server, "messages")), 1)

    def test_a_call_that_is_cancelled_stores_its_sample_once_or_not_at_all(self):
        server = self.serve()
        uav = self.drone(server)
        for number in range(1, 21):
            self.publish(uav, "Error", number, lose_after=number / 5000)
            self.assert_outcome(self.publish(uav, "Error", number), "STORED", "DUPLICATE")
        self.assertEqual(len(self.events(server, "error")), 20)


class Flights(DroneTest):
    def fly(self, server, uav, leg, lost):
        """Until it has settled so many further samples."""
        uav.tell("fly", to=["server"], seed=1, lost=lost)
        self.wait(server, lambda: uav.tell("progress") >= leg, f"{leg} samples are settled", LEG_SECONDS)

    def test_a_flight_that_loses_answers_stores_everything_once(self):
        server = self.serve()
        uav = self.drone(server)
        self.fly(server, uav, 2 * LEG, 0.3)
        book = self.land(uav)
        self.assert_stored(server, book)
        # A call that is given up can have been answered already, on a server that is fast.
        self.assertTrue(book.words()["UNREAD"], "no answer was lost")
        self.assertTrue(book.words()["DUPLICATE"], "no sample whose answer was lost was known again")

    def test_a_flight_across_kills_loses_and_doubles_nothing(self):
        server = self.serve()
        uav = self.drone(server)
        self.fly(server, uav, LEG, 0.2)
        for kill in range(1, 1 + KILLS):
            server.kill()
            server.start()
            due = (1 + kill) * LEG
            self.wait(server, lambda: uav.tell("progress") >= due, f"{due} are settled after kill {kill}", LEG_SECONDS)
        book = self.land(uav)
        self.assert_stored(server, book)
        self.assertTrue(book.words()["UNAVAILABLE"], "no kill was seen")


class Locked(DroneTest):
    """A drone that was heard, and whose server's store can be locked."""

    settings = ANSWERS
    more = ""

    def setUp(self):
        super().setUp()
        self.running = self.serve(self.settings, self.more)
        self.uav = self.drone(self.running)
        self.assert_outcome(self.publish(self.uav, "Battery", 1), "APPLIED")
        self.assert_outcome(self.publish(self.uav, "StatusText", 1), "STORED")

    def messages(self):
        return [row["message"] for row in self.history(self.running, "messages")]


class StoreAway(Locked):
    def test_live_samples_go_on_and_durable_ones_are_unavailable_and_stored_once_later(self):
        with store_locked(self.running):
            first = self.publish(self.uav, "StatusText", 2)
            self.assert_status(first, "UNAVAILABLE")
            self.assertGreater(first["seconds"], ANSWER_SECONDS / 2)
            self.assert_outcome(self.publish(self.uav, "Battery", 2), "APPLIED")
            self.assertEqual(self.shown(self.running)["battery"]["0"]["remainingPercent"], 98)
        # It was taken, and commits without the drone, which cannot know that.
        self.wait(self.running, lambda: len(self.messages()) == 2, "what was taken is stored")
        self.assert_outcome(self.publish(self.uav, "StatusText", 2), "DUPLICATE")
        self.assertEqual(self.messages(), ["number 1.", "number 2."])

    def test_a_bad_sensor_is_no_lost_link_while_the_store_is_away(self):
        with store_locked(self.running):
            for number in (2, 2, 3):
                answer = self.call(self.uav, "Battery", {"remaining_percent": 200}, number)
                self.assert_outcome(answer, "REJECTED", field="battery.remaining_percent")
        self.wait(
            self.running, lambda: len(self.listed(self.running, "quarantine")) == 2, "each is kept once"
        )  # fmt: skip

    def test_a_caller_with_less_patience_ends_its_call_itself(self):
        with store_locked(self.running):
            answer = self.publish(self.uav, "StatusText", 2, deadline=ANSWER_SECONDS / 4)
            self.assertIn(answer["code"], ("UNAVAILABLE", "DEADLINE_EXCEEDED"))
            self.assertLess(answer["seconds"], ANSWER_SECONDS / 2)
        self.assert_outcome(self.publish(self.uav, "StatusText", 2), "STORED", "DUPLICATE")
        self.assertEqual(len(self.messages()), 2)

    def test_a_sample_that_is_sent_again_while_the_store_is_away_is_stored_once(self):
        with store_locked(self.running):
            for _ in range(3):
                answer = self.publish(self.uav, "StatusText", 2, deadline=ANSWER_SECONDS / 4)
                self.assertNotEqual(answer["code"], "OK")
        self.assert_outcome(self.publish(self.uav, "StatusText", 2), "STORED", "DUPLICATE")
        self.assertEqual(len(self.messages()), 2)

    def test_alerts_and_requests_are_shown_while_the_store_is_away(self):
        with store_locked(self.running):
            self.assert_status(self.call(self.uav, "Alert", alerts("low"), 2), "UNAVAILABLE")
            answer = self.call(self.uav, "OperatorActionRequests", requests("r1"), 2)
            self.assert_status(answer, "UNAVAILABLE")
            shown = str(self.shown(self.running))
            self.assertTrue("'low'" in shown and "'r1'" in shown, shown)
        self.wait(self.running, lambda: self.listed(self.running, "operator-requests"), "both are stored")
        self.assert_outcome(self.call(self.uav, "Alert", alerts("low"), 2), "DUPLICATE")
        self.assertEqual(len(self.listed(self.running, "faults")), 1)


class InFlight(Locked):
    def test_one_call_too_many_is_refused_and_the_others_wait(self):
        self.lead(self.uav, self.running, to="second")
        # By two connections: each alone might hold back a call by its own bound of streams.
        calls = [{"to": ("server", "second")[number % 2], "type": "StatusText",
                  "request": request_of("StatusText", sample_of("StatusText", number), times(number))}
                 for number in range(2, 2 + IN_FLIGHT_MAX + 1)]  # fmt: skip
        with store_locked(self.running):
            answers = self.uav.tell("calls", calls=calls)
        codes = sorted(answer["code"] for answer in answers)
        self.assertEqual(codes, ["RESOURCE_EXHAUSTED"] + IN_FLIGHT_MAX * ["UNAVAILABLE"])
        self.assert_outcome(self.publish(self.uav, "Battery", 2), "APPLIED")
        self.wait(self.running, lambda: len(self.messages()) >= 1 + IN_FLIGHT_MAX, "what was taken is stored")
        refused = next(call for call, answer in zip(calls, answers) if answer["code"] == "RESOURCE_EXHAUSTED")
        self.assert_outcome(self.uav.tell("call", **refused), "STORED")
        self.assertEqual(len(self.messages()), 2 + IN_FLIGHT_MAX)


class Drain(Locked):
    settings = f'answer_within = "{DRAIN_SECONDS}s"\n'
    more = f'[drain]\ntimeout = "{DRAIN_SECONDS}s"\n'

    def test_a_drain_waits_for_calls_that_wait_for_their_commit(self):
        answers = []
        call = threading.Thread(target=lambda: answers.append(self.publish(self.uav, "StatusText", 2)))
        with store_locked(self.running):
            call.start()
            self.running.wait_for_status(lambda status: int(status["journalRecords"]), SECONDS, "it waits")
            self.running.process.terminate()
            self.running.wait_for_line(" draining ")
        call.join(SECONDS)
        self.assert_outcome(answers[0], "STORED")
        self.assertEqual(self.running.process.wait(SECONDS), 0)
        self.running.start()
        wait_until(self.running.process, lambda: len(self.messages()) == 2, SECONDS, "it is there")

    def test_a_server_that_drains_takes_no_new_calls(self):
        with store_locked(self.running):
            call = threading.Thread(target=lambda: self.publish(self.uav, "StatusText", 2))
            call.start()
            self.running.wait_for_status(lambda status: int(status["journalRecords"]), SECONDS, "it waits")
            self.running.process.terminate()
            self.running.wait_for_line(" draining ")
            second = self.drone(self.running)
            self.assert_status(self.publish(second, "Battery", 3), "UNAVAILABLE")
        call.join(SECONDS)
        self.assertEqual(self.running.process.wait(SECONDS), 0)


if __name__ == "__main__":
    unittest.main()
