"""Two servers on one store: only the one that holds a robot judges it.

UPLINK_SPANS=full gives the spans for which the promises are made (two_servers.py): ten minutes of
overlap, of a cut and so on; about an hour in all, each test by itself.
"""

import signal
import unittest

from presence import OFFLINE, ONLINE, PAUSE, UNKNOWN, goes_on, problems_of
from tcp_proxy import Cut
from two_servers import ROBOTS, SPANS, A, B, TwoServers


class Verdicts(unittest.TestCase):
    def test_a_true_history_passes_and_each_false_one_is_found(self):
        moved = [ONLINE, UNKNOWN, ONLINE]
        self.assertEqual(problems_of([ONLINE], 0), [])
        self.assertEqual(problems_of(moved, 1), [])
        for history, pauses, problem in (
            ([], 0, "no change at all"),
            ([ONLINE, OFFLINE, ONLINE], 1, "offline, though it streamed"),
            ([ONLINE, ONLINE], 1, "a row that changes nothing"),
            ([ONLINE, UNKNOWN], 1, "not online at last"),
            (moved, 0, "3 rows for 0 pauses"),
        ):
            self.assertEqual(problems_of(history, pauses), [problem])

    def test_a_history_that_goes_on_has_no_rows_but_those_of_pauses(self):
        for added, pauses, true in (
            ([], 0, True),
            ([UNKNOWN], 1, True),
            ([UNKNOWN, ONLINE], 1, True),
            ([UNKNOWN], 0, False),
            ([UNKNOWN, ONLINE, UNKNOWN], 1, False),
            ([OFFLINE], 1, False),
            ([ONLINE], 1, False),
        ):
            self.assertEqual(goes_on([ONLINE], [ONLINE, *added], pauses), true, added)
        self.assertFalse(goes_on([ONLINE, UNKNOWN, ONLINE], [ONLINE], 1), "what was there is gone")


class Beside(TwoServers):
    """A server that runs beside the one that the robots stream to."""

    def setUp(self):
        super().setUp()
        self.start(A)
        self.robots_at(A)

    def test_a_server_that_starts_beside_another_writes_nothing_of_its_robots(self):
        before = self.histories()
        self.start(B)
        self.watch(SPANS.after, check=lambda: self.assert_histories_go_on(before, "B wrote"))
        self.assert_histories_are_true()

    def test_it_shows_them_as_their_holder_wrote_them_and_says_who_that_is(self):
        self.start(B)
        port = self.servers[A].relay.rsplit(":", 1)[1]

        def held_by_a():
            shown = self.robots(B).values()
            return len(shown) == ROBOTS and all(
                robot["presence"] == ONLINE
                and robot.get("heldBy", "").rsplit(":", 1)[-1] == port
                and "heldByAt" in robot
                for robot in shown
            )

        self.wait_for(held_by_a, f"online, held by port {port}", B)
        for robot in self.robots(A).values():
            self.assertEqual((robot["heldBy"], robot.get("heldByAt")), ("", None))
        # Its parts follow what A checkpoints.
        everybody = set(self.robots(A))
        self.wait_for(lambda: set(self.sampled_at(B)) == everybody, "A's first checkpoint", B)
        first = self.sampled_at(B)
        self.wait_for(lambda: all(at > first[ruri] for ruri, at in self.sampled_at(B).items()), "parts go on", B)
        self.watch(SPANS.after)
        self.assert_histories_are_true()

    def sampled_at(self, place):
        """When the motion that a server shows of each robot was sampled."""
        return {
            ruri: int(robot["motion"]["unixTimeMs"])
            for ruri, robot in self.robots(place, "&parts=motion").items()
            if "motion" in robot
        }


class Moves(TwoServers):
    """Robots that go from one server to the other and back."""

    def health(self, place):
        """Of each device of each robot when the health that a server shows was sampled."""
        return {
            (ruri, device): int(health["unixTimeMs"])
            for ruri, robot in self.robots(place, "&parts=health").items()
            for device, health in robot.get("health", {}).items()
        }

    def move(self, place):
        """All robots to this server, while the other one lives."""
        self.road.choose(place)
        self.road.drop()
        self.moves += 1

        def all_are_here():
            shown = self.robots(place).values()
            return len(shown) == ROBOTS and all(robot.get("connected") for robot in shown)

        self.wait_for(all_are_here, "all are here", place)

    def test_a_server_that_gets_robots_back_shows_what_the_other_heard_since(self):
        self.start(A, B)
        # One device of each every five seconds: what they say in the moment of a move is an exception.
        self.robots_at(A)
        self.wait_for(lambda: len(self.health(A)) == 2 * ROBOTS, "all devices", A)
        at_first = self.health(A)
        self.move(B)
        self.wait_for(
            lambda: (now := self.health(B)).keys() == at_first.keys()
            and all(now[device] > at for device, at in at_first.items()),
            "newer health of all devices", B,
        )  # fmt: skip
        newest = self.health(B)
        # What B has not checkpointed when it loses a robot is lost with its live state.
        self.wait_for(
            lambda: all(self.health(A).get(device, 0) >= at for device, at in newest.items()),
            "B's checkpoint is in the store, where A reads it", A,
        )  # fmt: skip
        self.move(A)
        older = {device: at - newest[device] for device, at in self.health(A).items() if at < newest[device]}
        self.assertEqual(older, {}, "A shows what it had heard itself, which is older by so many ms")
        self.watch(SPANS.after)
        self.wait_until_all_are_online()
        self.assert_histories_are_true()
        kept = {device: at - newest[device] for device, at in self.health(B).items() if at < newest[device]}
        self.assertEqual(kept, {}, "the store keeps what is older by so many ms")


class Updates(TwoServers):
    def test_two_rolling_updates_make_nobody_offline(self):
        self.start(A)
        self.robots_at(A)
        self.replace(A, B)
        self.replace(B, A)


class Kills(TwoServers):
    def lose(self, holder, other):
        self.road.choose(other)
        self.moves += 1
        self.servers[holder].kill()
        self.road.drop(holder)
        self.wait_for(lambda: self.streams(other) == ROBOTS, "the robots came", other)
        self.watch(SPANS.after)
        self.assert_histories_are_true()
        self.start(holder)
        self.wait_until_all_are_online()
        self.watch(SPANS.after)
        self.assert_histories_are_true()

    def test_robots_that_are_gone_with_their_holder_are_offline_at_last(self):
        self.start(A, B)
        self.robots_at(A)
        self.fleets[0].close()
        self.servers[A].kill()
        gone = [ONLINE, UNKNOWN, OFFLINE]

        def all_are_offline():
            shown = self.robots(B).values()
            return [robot["presence"] for robot in shown] == ROBOTS * [OFFLINE]

        self.wait_for(all_are_offline, "B knows that A is dead, and hears no robot", B)
        self.wait_for(lambda: list(self.histories().values()) == ROBOTS * [gone], "a row a change", B)

    def test_robots_whose_holder_is_killed_stay_online_at_the_other(self):
        self.start(A, B)
        self.robots_at(A)
        self.lose(A, B)
        self.lose(B, A)


class Cuts(TwoServers):
    """Either server is cut from the store, or both are, and the robots of both stream on."""

    def setUp(self):
        super().setUp()
        self.start(A, B)
        self.robots_at(A)
        self.robots_at(B)

    def cut(self, places, how, seconds, check=lambda: None):
        for place in places:
            self.stores[place].cut(how)
        for place in places:
            self.servers[place].wait_for_status(lambda s: "store" in s["degraded"], 60, "the store is away")
        self.watch(seconds, check=check)
        for place in places:
            self.stores[place].mend()
        for place in places:
            self.servers[place].wait_for_status(lambda s: "store" not in s["degraded"], 60, "the store is back")
        self.wait_until_all_are_online()

    def test_a_short_cut_of_either_changes_nothing(self):
        before = self.histories()

        def unchanged():
            self.assert_histories_go_on(before, "no lease ran out")

        for place, how in ((A, Cut.BLACK_HOLE), (B, Cut.REFUSE)):
            self.cut([place], how, SPANS.short_cut, unchanged)
        self.watch(SPANS.after, check=unchanged)

    def test_a_server_whose_connections_end_for_longer_than_its_lease(self):
        self.assert_adopted_and_given_back(A, Cut.REFUSE)

    def test_a_server_whose_connections_stand_still_for_longer_than_its_lease(self):
        self.assert_adopted_and_given_back(B, Cut.BLACK_HOLE)

    def assert_adopted_and_given_back(self, place, how):
        """What it holds goes to the other, who does not hear it and says no more than that."""
        ours = {ruri for ruri, robot in self.robots(place).items() if robot.get("connected")}
        self.assertEqual(len(ours), ROBOTS)
        before = self.histories()

        def true_meanwhile():
            self.assert_histories_go_on(before, "it is heard, and adopted at most once", adopted=ours)

        # Robots whose stream ends, as its server learns that it holds them no more, come back to it.
        self.road.choose(place)
        self.cut([place], how, SPANS.long_cut, true_meanwhile)
        self.watch(SPANS.after, check=true_meanwhile)
        for ruri, robot in self.robots(place).items():
            self.assertEqual(robot.get("connected"), ruri in ours, ruri)
        for ruri in ours:
            # The store could not know better: its holder said nothing for longer than a lease.
            self.assertEqual(self.histories()[ruri][len(before[ruri]) :][:2], PAUSE)
        self.moves += 1
        self.assert_histories_are_true()

    def test_robots_that_move_to_a_server_that_is_cut_off_are_not_offline(self):
        self.assert_robots_that_left_are_not_offline(lambda: self.road.drop(A))

    def test_robots_that_move_there_and_leave_half_open_connections_are_not_offline(self):
        def part():
            self.road.part(A)
            # Longer than presence.timeout: A has streams, and hears nothing on them.
            self.watch(SPANS.after, check=lambda: self.assertEqual(self.streams(A), ROBOTS))

        self.assert_robots_that_left_are_not_offline(part)

    def assert_robots_that_left_are_not_offline(self, leave):
        self.stores[B].cut(Cut.BLACK_HOLE)
        self.wait_for(lambda: " process_late " in self.servers[A].text(), "A misses the lease of B", A)
        self.road.choose(B)
        leave()
        self.watch(SPANS.long_cut)
        # A's keepalive ended those that were half open.
        self.assertEqual(self.streams(A), 0)
        self.assertIn(UNKNOWN, {robot["presence"] for robot in self.robots(A).values()})
        self.stores[B].mend()
        self.wait_until_all_are_online()
        self.watch(SPANS.after)
        # Each was adopted, or not heard by the server that holds it.
        self.moves += 1
        self.assert_histories_are_true()

    def test_a_store_that_is_away_for_both_ends_nobodys_lease(self):
        before = self.histories()
        self.cut([A, B], Cut.REFUSE, SPANS.away)
        # Long enough for a lease to be missed, if it was counted while the store was away.
        self.watch(SPANS.after, check=lambda: self.assert_histories_go_on(before, "no lease ran out"))


class Stops(TwoServers):
    """The holder stands still; the robots' frames lie unread in its connections."""

    def setUp(self):
        super().setUp()
        self.start(A, B)
        self.robots_at(A)

    def stand_still(self, seconds, meanwhile=lambda: None):
        self.servers[A].process.send_signal(signal.SIGSTOP)
        try:
            meanwhile()
            self.watch(seconds, [B])
        finally:
            self.servers[A].process.send_signal(signal.SIGCONT)
        self.moves += 1
        self.wait_for(lambda: self.streams(A) + self.streams(B) == ROBOTS, "all stream", B)
        self.watch(SPANS.after)
        self.wait_until_all_are_online()
        self.assert_histories_are_true()

    def test_a_holder_that_stands_still_for_less_than_its_lease(self):
        self.stand_still(SPANS.short_stop)

    def test_a_holder_that_stands_still_for_longer_than_its_lease(self):
        self.stand_still(SPANS.long_stop)

    def test_a_holder_that_stands_still_while_its_robots_go_to_the_other(self):
        def go():
            self.road.choose(B)
            self.road.drop()

        self.stand_still(SPANS.long_stop, go)


if __name__ == "__main__":
    unittest.main()
