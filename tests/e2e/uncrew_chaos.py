"""The crash campaign with drones: kills uplinkd, its store and the drones' connections at random moments, while
drones publish samples of all types, and compares what calls that ended OK said with what is stored.
chaos_run.py --uncrew runs it.

A drone has several calls under way, each of another type, and sends a sample again until a call ends OK. With
two servers, half of the drones take any of them for each call, the others stay for a while.
"""

import json

from chaos_rounds import Rounds
from drone_book import Account, Book, rows_of
from drone_samples import STORED, UNSTORED, WRONG
from drones import ROOT, SETTINGS, certify, make_modules, python_drone
from servers_in_turn import ServersInTurn
from tcp_proxy import TcpProxy

UAVS = tuple(f"d{number}" for number in range(6))
# What one drone publishes at a time: its types are dealt to so many flights.
FLIGHTS = 4
# Share of calls whose answer a drone does not read; chance that one with two servers stays where it is.
LOST = 0.05
STAY = 0.95
CANARIES = {"answers_early": "uplinkd_answers_early", "forgets_samples": "uplinkd_forgets_samples"}
# The rows of each kind in the order of the writing, with what tells them apart.
ROWS = """
SELECT what, ruri, said, how FROM (
  SELECT entry, kind AS what, ruri, detail AS said, 0 AS how FROM events
  UNION ALL SELECT entry, 'message', ruri, message, 0 FROM messages
  UNION ALL SELECT entry, 'fault', ruri, fault_id, CAST(active AS INTEGER) FROM faults_history
  UNION ALL SELECT entry, 'request', ruri, request_id, CAST(is_open AS INTEGER) FROM operator_requests
  UNION ALL SELECT entry, 'rejected', ruri, detail, 0 FROM quarantine) AS said
ORDER BY entry"""
# What holds now.
STANDING = """
SELECT 'alert', ruri, fault_id FROM faults_active
UNION ALL SELECT 'request', ruri, request_id FROM operator_requests WHERE is_open"""


def dealt():
    """The types of each flight."""
    names = (*STORED, WRONG, *UNSTORED)
    return [names[flight::FLIGHTS] for flight in range(FLIGHTS)]


def stored_rows(table):
    """By drone what drone_book.rows_of makes of the rows of ROWS."""
    lists = {uav: {"events": [], "message": [], "fault": [], "request": [], "rejected": []} for uav in UAVS}
    for what, ruri, said, how in table:
        of_drone = lists[ruri.removeprefix(ROOT)]
        match what:
            case "message":
                of_drone[what].append({"message": said})
            case "fault":
                of_drone[what].append({"faultId": said, "active": int(how) == 1})
            case "request":
                closed = {} if int(how) else {"closedAt": "1970-01-01T00:00:00.001Z"}
                of_drone[what].append({"requestId": said, **closed})
            case "rejected":
                of_drone[what].append({"detail": said})
            case _:
                of_drone["events"].append({"kind": what, "detail": json.loads(said)})
    return {uav: rows_of(*of_drone.values()) for uav, of_drone in lists.items()}


def standing_sets(table):
    """By drone the ids of the alerts and of the requests of the rows of STANDING."""
    sets = {uav: (set(), set()) for uav in UAVS}
    for what, ruri, said in table:
        sets[ruri.removeprefix(ROOT)][what == "request"].add(said)
    return sets


def shown_sets(robot):
    """The same of a robot that a server shows, and what it counts of each."""
    uncrew = robot.get("uncrew", {})
    ids = tuple(set(uncrew.get(name, ())) for name in ("alerts", "operatorRequests"))
    return ids, (robot["activeFaults"], robot["operatorRequestsOpen"])


class UncrewCampaign(Rounds):
    canaries = CANARIES
    unused_kills = ("broker", "absence")

    def __init__(self, folder, store, seed, canary=None):
        super().__init__(folder, store, seed, canary)
        # To each server one that all drones take.
        self.roads = []
        self.drones = python_drone(make_modules(folder))
        self.books = {uav: Book() for uav in UAVS}
        self.account = Account()
        # What the servers show wrongly, before they are stopped for the comparison.
        self.misshown = []

    def settings(self):
        return SETTINGS

    def load(self):
        return self.drones.process

    def ways(self):
        return self.roads

    def start(self):
        for server in self.servers:
            self.start_server(server)
            self.roads.append(TcpProxy(server.relay))
        for uav in UAVS:
            for place, road in enumerate(self.roads):
                files = certify(self.servers[0].pki, uav)
                self.drones.tell("connect", name=f"{uav} {place}", target=road.address, **files)
        self.go_on()

    def go_on(self):
        for number, (uav, book) in enumerate(self.books.items()):
            first = book.last() + 1
            for types in dealt():
                self.drones.tell(
                    "fly", of=uav, to=[f"{uav} {place}" for place in range(len(self.roads))], types=types, first=first,
                    seed=self.random.randrange(1 << 30), lost=LOST, stay=STAY if number % 2 else 0.0,
                )  # fmt: skip

    def wait_for_recovery(self, kind):
        before = self.drones.tell("settled")

        def all_go_on():
            return all(now > then for now, then in zip(self.drones.tell("settled"), before))

        self.wait(all_go_on, f"calls of every flight end OK behind the kill of {kind}")

    def rest(self):
        self.wait_for_recovery("the last one")
        landed = self.drones.tell("land")
        if landed["problems"]:
            raise AssertionError(landed["problems"])
        for uav, book in landed["books"].items():
            self.books[uav].add(Book.load(book))
        self.misshown = self.look_at_shown()

    def look_at_shown(self):
        """Of a single server, which was told the last set of everybody, what it shows of them."""
        if len(self.servers) > 1:
            return []
        robots = {each["ruri"]: each for each in self.servers[0].get("/api/v1/robots?parts=uncrew")["robots"]}
        wrong = []
        for uav, book in self.books.items():
            shown, sets = shown_sets(robots[ROOT + uav]), book.sets()
            if shown != (sets, tuple(map(len, sets))):
                wrong.append(f"{uav}: shown {shown}, not {sets}")
        return wrong

    def look(self):
        rows = stored_rows(self.store.table(ROWS))
        standing = standing_sets(self.store.table(STANDING))
        self.wrong = [*self.misshown]
        self.account = Account()
        for uav, book in self.books.items():
            self.account += book.account(rows[uav])
            self.wrong += [f"{uav}: {problem}" for problem in book.problems(rows[uav])]
            if standing[uav] != book.sets():
                self.wrong.append(f"{uav}: alerts and requests {standing[uav]}, not {book.sets()}")
        self.acked, self.stored = self.account.acked, self.account.stored

    def line(self):
        return (f"kills {self.done}, acked {self.acked}, stored {self.stored}, lost {self.account.lost},"
                f" doubled {self.account.doubled}")  # fmt: skip

    def canary_found(self):
        return (self.account.lost if self.canary == "answers_early" else self.account.doubled) > 0

    def close(self):
        self.drones.close()
        super().close()


class PairCampaign(ServersInTurn, UncrewCampaign):
    """Two servers on one PostgreSQL: each is killed in turn, or ends in order."""

    def __init__(self, folder, seed):
        super().__init__(folder, "postgres", seed)
        self.add_server(folder, self.new_server)
        self.kinds["leave"] = 2

    def kill(self, kind):
        if kind != "leave":
            return super().kill(kind)
        self.raise_server()
        server = self.random.choice(self.servers)
        self.end(server)
        self.start_server(server)
        return True

    def rest(self):
        self.raise_server()
        super().rest()
