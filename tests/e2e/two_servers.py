"""Two servers on one PostgreSQL, with a proxy on each way that a test may want to cut: from either
server to the store, and from the robots to the servers."""

import dataclasses
import os
import time

from harness import BIN, Cluster, EndToEnd, Fleet, Server, mismatches, wait_until
from presence import OFFLINE, ONLINE, goes_on, problems_of, shown_history, stored_histories
from tcp_proxy import TcpProxy

ROBOTS = 6
# A robot that streams is there, and the database answers, within so long on a busy machine.
DEADLINE_SECONDS = 60
LOOK_SECONDS = 0.2
# Server A is the first, B the second.
A, B = 0, 1


@dataclasses.dataclass(frozen=True)
class Spans:
    """How long the parts of the scenarios last, in seconds."""

    # Both servers run side by side during a rolling update.
    overlap: float
    # One server is cut from the store: for less than its lease lasts (30 s), and for longer.
    short_cut: float
    long_cut: float
    # The store is away for both.
    away: float
    # A server stands still: for less than its lease lasts, and for longer.
    short_stop: float
    long_stop: float
    # Watched after something happened: longer than presence.timeout.
    after: float


# The suite's, and those for which the promises are made: UPLINK_SPANS=full.
SHORT = Spans(overlap=12, short_cut=15, long_cut=45, away=40, short_stop=15, long_stop=40, after=12)
FULL = Spans(overlap=600, short_cut=25, long_cut=600, away=120, short_stop=15, long_stop=60, after=60)
SPANS = {"short": SHORT, "full": FULL}[os.environ.get("UPLINK_SPANS", "short")]

# What a server counts of messages since its start: a fleet whose robots moved asks only one.
COUNTS = ("messages, each once", "durable, stored", "good: stored, applied or superseded")

# A server that judged what it does not hear would do so within seconds.
SETTINGS = """checkpoint = "1s"
[presence]
startup_grace = "5s"
"""


class TwoServers(EndToEnd):
    """A cluster, the servers A and B with one authority, and the way of the robots, which leads to A."""

    # Of these programs is the store's schema at first.
    programs_of_store = BIN
    way_to_store = TcpProxy
    # Of the store, beside those of the scenarios.
    settings = ""

    def setUp(self):
        super().setUp()
        self.cluster = self.keep(Cluster(self.folder).create()).migrate(self.programs_of_store)
        self.password = self.folder / "store.password"
        self.password.write_text("uplinkd\n", encoding="utf-8")
        self.stores = [self.keep(self.way_to_store(f"127.0.0.1:{self.cluster.place['port']}")) for _ in "AB"]
        self.servers = [self.new_server(name, store) for name, store in zip("AB", self.stores)]
        self.road = None
        self.fleets = []
        # How often each robot may have been without a holder.
        self.moves = 0

    def keep(self, thing):
        self.open_things.append(thing)
        return thing

    def new_server(self, name, store):
        folder = self.folder / name
        folder.mkdir()
        # The authority of the first is that of both.
        if self.folder.joinpath("A/pki").exists():
            (folder / "pki").symlink_to(self.folder / "A/pki")
        url = f"postgresql://uplinkd@127.0.0.1:{store.port}/uplinkd?sslmode=disable"
        return self.keep(Server(folder, f'password_file = "{self.password}"\n{self.settings}{SETTINGS}', url))

    def start(self, *places):
        """Starts these servers; the first time with the way to the first of them."""
        for place in places:
            self.servers[place].start()
        if self.road is None:
            # A server's port is known once it listened, and kept.
            self.road = self.keep(TcpProxy("none:0", "none:0"))
            self.road.choose(places[0])
        for place in places:
            self.road.targets[place] = self.servers[place].relay

    def robots_at(self, place, *flags):
        """A fleet whose robots stream to this server, all heard; other fleets stay where they are."""
        self.road.choose(place)
        server = self.servers[place]
        prefix = f"rcan://two/servers/{len(self.fleets)}"
        seed = len(self.fleets) + 1
        fleet = Fleet(server, "--robots", ROBOTS, "--ruri-prefix", prefix, "--faults", 1, "--seed", seed,
                      *flags, target=self.road.address)  # fmt: skip
        self.fleets.append(self.keep(fleet))
        self.wait_for(lambda: self.streams(place) >= ROBOTS, "all stream", place)
        self.wait_until_all_are_online()
        self.wait_for(self.all_are_stored_online, "the histories say so", place)
        return prefix

    # What the servers show.

    def robots(self, place, parts=""):
        """By RURI what this server shows; nothing while it does not answer."""
        answer = self.servers[place].get(f"/api/v1/robots?pageSize=1000{parts}") or {}
        return {robot["ruri"]: robot for robot in answer.get("robots", [])}

    def streams(self, place):
        status = self.servers[place].get("/api/v1/status")
        return int(status.get("streams", 0)) if status else 0

    def running(self):
        return [place for place, server in enumerate(self.servers)
                if server.process is not None and server.process.poll() is None]  # fmt: skip

    def histories(self):
        return stored_histories(self.cluster)

    def all_are_stored_online(self):
        """A server shows a change before it is committed."""
        histories = self.histories().values()
        return len(histories) >= ROBOTS * len(self.fleets) and all(rows[-1:] == [ONLINE] for rows in histories)

    def pauses(self):
        """How often a robot may not have been heard: it moved, or a server said of itself that it stood
        still or did not read, as it does on a machine that is too busy."""
        logs = [path.read_text(encoding="utf-8") for path in self.folder.glob("[AB]/uplinkd-*.log")]
        return self.moves + sum(text.count(" relay_behind ") for text in logs)

    # Waiting.

    def wait_for(self, condition, what, place=None, seconds=DEADLINE_SECONDS):
        """While this server lives, or the first that runs."""
        at = self.running()[0] if place is None else place
        try:
            return wait_until(self.servers[at].process, condition, seconds, what, LOOK_SECONDS)
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.servers[at].text()[-2000:]}") from None

    def all_are_online(self, places):
        """Every robot, by these servers."""
        robots = ROBOTS * len(self.fleets)
        for place in places:
            shown = self.robots(place)
            if len(shown) != robots or any(robot["presence"] != ONLINE for robot in shown.values()):
                return False
        return True

    def wait_until_all_are_online(self, *places):
        self.wait_for(lambda: self.all_are_online(places or self.running()), "all are online, by every server")

    def watch(self, seconds, places=None, check=lambda: None):
        """For so long these servers show no robot as offline, all live, and the check passes."""
        places = self.running() if places is None else places
        end = time.monotonic() + seconds

        def look():
            for place in places:
                shown = self.robots(place)
                gone = [ruri for ruri, robot in shown.items() if robot["presence"] == OFFLINE]
                self.assertEqual(gone, [], f"server {'AB'[place]} shows them as offline, and they stream")
            check()
            return time.monotonic() > end

        self.wait_for(look, "the time passes", places[0] if places else None, seconds + DEADLINE_SECONDS)
        self.assertTrue(set(places) <= set(self.running()), "a server ended")

    def replace(self, old, new):
        """A new server starts, both run for a while, the robots move as the old one drains."""
        self.start(new)
        self.wait_until_all_are_online()
        self.watch(SPANS.overlap)
        self.road.choose(new)
        self.moves += 1
        self.assertEqual(self.servers[old].terminate(30), 0, self.servers[old].text()[-2000:])
        self.wait_for(lambda: self.streams(new) == ROBOTS, "the robots came", new)
        self.watch(SPANS.after)
        self.wait_until_all_are_online()
        self.assert_histories_are_true()

    # Verdicts.

    def assert_all_is_stored(self, fleet, counted_elsewhere=()):
        _, report = fleet.finish()
        self.assertEqual(report["differences"], [])
        wrong = {check["what"] for check in mismatches(report)}
        self.assertLessEqual(wrong, set(counted_elsewhere), report)

    def assert_histories_are_true(self):
        """No false offline, a row a change, no more than there were moves; and both servers show them so."""
        histories, pauses = self.histories(), self.pauses()
        self.assertEqual(len(histories), ROBOTS * len(self.fleets))
        wrong = {
            ruri: (found, history)
            for ruri, history in histories.items()
            if (found := problems_of(history, pauses))
        }
        self.assertEqual(wrong, {})
        for place in self.running():
            shown = {ruri: shown_history(self.servers[place], ruri) for ruri in histories}
            self.assertEqual(shown, histories, f"server {'AB'[place]} shows other histories than the store")

    def assert_histories_go_on(self, before, why, adopted=()):
        """As before, but for pauses; those robots may be adopted meanwhile, which is one."""
        histories, pauses = self.histories(), self.pauses()
        wrong = {
            ruri: history
            for ruri, history in histories.items()
            if not goes_on(before.get(ruri, []), history, pauses + (ruri in adopted))
        }
        self.assertEqual(wrong, {}, why)
        self.assertEqual(set(histories), set(before))
