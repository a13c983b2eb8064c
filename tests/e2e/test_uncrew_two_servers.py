"""Drones that call two servers on one store: nothing is lost or doubled, whichever of them they call."""

import unittest

from drone_samples import alerts, requests
from drones import SETTINGS, DroneTest
from tcp_proxy import Cut
from two_servers import DEADLINE_SECONDS, A, B, TwoServers

KILLS = 4
LEG = 40
LEG_SECONDS = 120
# Of those that wait for a server whose store is away.
SLOW_LEG = 20
# Until a server's lease has run out (30 s), on a busy machine.
LEASE_SECONDS = 90
EVENTS = "/api/v1/events?pageSize=1"


class TwoServersWithDrones(DroneTest, TwoServers):
    """Both run; the drone's connections are called A and B as they are."""

    def setUp(self):
        super().setUp()
        for server in self.servers:
            server.settings += SETTINGS + 'answer_within = "1s"\n'
        self.start(A, B)
        self.uav = self.program()
        for place in (A, B):
            self.lead(self.uav, self.servers[place], to=place)

    def apply_first_at(self, place):
        """A live sample is answered before the store has the claim; a durable one waits for it."""
        self.assert_outcome(self.at(place, "Error", 0), "STORED")
        self.assert_outcome(self.at(place, "Battery", 1), "APPLIED")

    def at(self, place, name, number):
        return self.publish(self.uav, name, number, to=place)

    def by_both(self, look):
        """What both show, which is the same."""
        first, second = (look(server) for server in self.servers)
        self.assertEqual(first, second)
        return first


class Alternating(TwoServersWithDrones):
    def test_durable_samples_are_stored_by_both_and_known_again_by_the_other(self):
        for number in range(1, 11):
            place = number % 2
            self.assert_outcome(self.at(place, "StatusText", number), "STORED")
            self.assert_outcome(self.at(1 - place, "StatusText", number), "DUPLICATE")
        messages = self.by_both(lambda server: [row["message"] for row in self.history(server, "messages")])
        self.assertEqual(messages, [f"number {number}." for number in range(1, 11)])

    def test_a_change_is_told_once_whichever_server_hears_of_it(self):
        for number in range(1, 7):
            self.assert_outcome(self.at(number % 2, "FlightMode", number), "STORED")
            self.assert_outcome(self.at(1 - number % 2, "FlightMode", number), "DUPLICATE")
        events = self.by_both(lambda server: self.events(server, "flightMode"))
        self.assertEqual(len(events), 6)
        self.assertEqual([row["from"] for row in events[1:]], [row["to"] for row in events[:-1]])

    def test_a_set_that_one_server_was_told_is_ended_at_the_other(self):
        for place, number, sets in ((A, 1, ("x",)), (B, 2, ())):
            answer = self.call(self.uav, "Alert", alerts(*sets), number, place)
            self.assert_outcome(answer, "STORED")
            answer = self.call(self.uav, "OperatorActionRequests", requests(*sets), number, place)
            self.assert_outcome(answer, "STORED")
        faults = self.by_both(lambda server: [row["active"] for row in self.listed(server, "faults")])
        self.assertEqual(faults, [True, False])
        (row,) = self.by_both(lambda server: self.listed(server, "operator-requests"))
        self.assertIn("closedAt", row)

    def test_a_set_that_comes_back_at_a_server_is_stored_though_the_other_one_ended_it(self):
        for number, (place, sets) in enumerate(((A, ("x",)), (B, ()), (A, ("x",)), (B, ()), (A, ("x",)))):
            answer = self.call(self.uav, "Alert", alerts(*sets), number, place)
            self.assert_outcome(answer, "STORED")
        faults = self.by_both(lambda server: [row["active"] for row in self.listed(server, "faults")])
        self.assertEqual(faults, [True, False, True, False, True])

    def test_a_mode_that_comes_back_at_a_server_is_stored_though_the_other_one_ended_it(self):
        for number in range(1, 5):
            answer = self.call(self.uav, "Armed", {"is_armed": number % 2 == 1}, number, number % 2)
            self.assert_outcome(answer, "STORED")
        events = self.by_both(lambda server: [row["to"] for row in self.events(server, "armed")])
        self.assertEqual(events, [True, False, True, False])

    def test_a_change_at_a_server_whose_claim_is_over_is_stored(self):
        self.assert_outcome(self.at(A, "FlightMode", 1), "STORED")
        self.assert_outcome(self.at(B, "Error", 1), "STORED")
        self.assert_outcome(self.at(A, "FlightMode", 2), "STORED")
        self.assertEqual(len(self.by_both(lambda server: self.events(server, "flightMode"))), 2)

    def test_live_samples_are_the_first_servers_until_it_stops(self):
        self.apply_first_at(A)
        # What is durable passes, and does not move the drone.
        self.assert_outcome(self.at(B, "Error", 1), "STORED")
        self.assert_status(self.at(B, "Battery", 2), "UNAVAILABLE")
        self.assert_outcome(self.at(A, "Battery", 3), "APPLIED")
        self.assertEqual(self.servers[A].terminate(DEADLINE_SECONDS), 0)
        numbers = iter(range(4, 100_000))
        self.wait_for(
            lambda: self.at(B, "Battery", next(numbers)).get("outcome") == "APPLIED", "B has the drone", B
        )
        self.assertEqual(self.robot(self.servers[B])["heldBy"], "")


class Flights(TwoServersWithDrones):
    def fly(self, leg):
        self.uav.tell("fly", to=[A, B], seed=2, lost=0.2)
        self.settle(leg)

    def settle(self, leg):
        self.wait_for(lambda: self.uav.tell("progress") >= leg, f"{leg} samples are settled", seconds=LEG_SECONDS)

    def assert_landed(self):
        book = self.land(self.uav)
        for server in self.servers:
            self.assert_stored(server, book)
        return book

    def test_a_drone_that_alternates_loses_and_doubles_nothing(self):
        self.fly(3 * LEG)
        self.assert_landed()

    def test_a_drone_whose_servers_are_killed_in_turn_loses_and_doubles_nothing(self):
        self.fly(LEG)
        for kill in range(1, 1 + KILLS):
            victim = self.servers[kill % 2]
            victim.kill()
            self.settle((1 + kill) * LEG)
            victim.start()
        self.settle((2 + KILLS) * LEG)
        book = self.assert_landed()
        self.assertTrue(book.words()["UNAVAILABLE"], "no kill was seen")

    def test_a_drone_whose_store_is_away_for_one_server_or_both_loses_and_doubles_nothing(self):
        self.fly(LEG)
        other = self.program()
        for place in (A, B):
            self.lead(other, self.servers[place], "d2", to=place)
        for number, how in enumerate((Cut.REFUSE, Cut.BLACK_HOLE)):
            self.stores[A].cut(how)
            self.settle(self.uav.tell("progress") + SLOW_LEG)
            self.stores[B].cut(how)
            for place in (A, B):
                self.assert_status(self.publish(other, "Error", number, to=place, uav="d2"), "UNAVAILABLE")
            for store in self.stores:
                store.mend()
            self.settle(self.uav.tell("progress") + LEG)
            # Reads come back on their own: for a second after a failed connect they are refused at once.
            for place in (A, B):
                self.wait_for(lambda at=place: self.servers[at].get(EVENTS), "the store is read again", place)
        self.assert_landed()


class Killed(TwoServersWithDrones):
    def test_live_samples_go_on_at_the_other_server_once_the_lease_of_a_killed_one_is_over(self):
        self.apply_first_at(A)
        self.servers[A].kill()
        self.assert_outcome(self.at(B, "Error", 1), "STORED")
        numbers = iter(range(2, 1_000_000))
        self.wait_for(
            lambda: self.at(B, "Battery", next(numbers)).get("outcome") == "APPLIED", "B has the drone", B,
            LEASE_SECONDS,
        )  # fmt: skip
        self.assertNotIn("offline", [row["presence"] for row in self.history(self.servers[B], "presence")])


if __name__ == "__main__":
    unittest.main()
