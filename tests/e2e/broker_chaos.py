"""The crash campaign with a broker: kills uplinkd, its store, its connections and at times the broker at
random moments, while many twins publish at QoS 1, and compares what the broker acked to the publishers
with what is stored. chaos_run.py --cyberwave runs it.

With a canary, a server that is wrong on purpose, it compares after each kill and goes on until it finds
something.
"""

import collections
import contextlib
import random
import threading
import time
import urllib.parse

import broker_stores
from broker_book import Book, Findings
from broker_script import TWINS, ruri_of
from broker_watch import Watch, scrape
from harness import BIN, Server, wait_until
from mosquitto import Mosquitto
from mqtt_publishers import Publishers
from tcp_proxy import Cut, TcpProxy

PUBLISHERS = 8
# Of all publishers together; of a canary's so many that something is always on its way.
RATE = 1000
CANARY_RATE = 1500
CANARIES = {"acks_on_arrival": "uplinkd_acks_on_arrival", "forgets_deliveries": "uplinkd_forgets_deliveries"}
COMPARE_EVERY = 25
# From a kill to the first message that is stored again, and to the end of all that waits.
RECOVERY_SECONDS = 120
# Waits that are made of a random part of these.
LOAD_SECONDS = 1.0
HALT_SECONDS = 0.05
ABSENCE_SECONDS = 12.0
# Connections of one uplinkd that end in a row, soon after they began, before it takes somebody else to use
# its id and pauses for a minute (server/mqtt/reconnect.h): one more than the campaign ends.
CUTS_MAX = 2
# A kill after which the next one does not wait for the recovery.
HURRIED = 0.25
SETTINGS = """[mqtt]
url = "mqtt://{way}"
[presence]
timeout = "1s"
"""


class BrokerCampaign:
    def __init__(self, folder, store, seed, canary=None):
        self.random = random.Random(seed)
        self.folder = folder
        self.canary = canary
        self.broker = Mosquitto(folder)
        # uplinkd's way to the broker; publishers have their own.
        self.way = TcpProxy(f"127.0.0.1:{self.broker.port}")
        self.store = {"postgres": broker_stores.Postgres, "sqlite": broker_stores.Sqlite}[store](folder)
        self.kinds = dict(self.store.kills)
        self.servers = [self.new_server(folder)]
        self.book = Book()
        self.publishers = Publishers(
            self.broker.port, self.book, TWINS, PUBLISHERS, CANARY_RATE if canary else RATE
        )
        self.watch = Watch(self.servers)
        self.found = Findings()
        self.wrong = []
        self.done = 0
        self.kills = collections.Counter()
        # Kills that ended its connections, since a server was started last.
        self.cuts = 0
        self.acked = self.stored = 0
        # By kind of kill, from it on: seconds until what was killed is back, and until a message that was
        # published then is stored.
        self.recoveries = collections.defaultdict(list)

    def new_server(self, folder):
        return Server(folder, SETTINGS.format(way=self.way.address), self.store.url)

    # The parts and their lives.

    def start_server(self, server):
        """With SQLite alternately the program itself and the one that loses what is not synced."""
        programs = ["uplinkd"]
        if self.canary:
            programs = [CANARIES[self.canary]]
        elif isinstance(self.store, broker_stores.Sqlite):
            programs = ["uplinkd", "uplinkd_held"]
        server.program = BIN / programs[server.starts % len(programs)]
        server.environment = {"UPLINK_HELD_SEED": str(self.random.randrange(1 << 30))}
        server.start()
        self.cuts = 0

    def start(self):
        self.broker.start()
        for server in self.servers:
            self.start_server(server)
        # Until uplinkd has subscribed once, the broker keeps nothing for it.
        self.wait(lambda: "mqtt_subscribed connection=durable" in self.logs(), "uplinkd subscribes")
        self.publishers.start()
        self.watch.start()

    def logs(self):
        return "".join(server.text() for server in self.servers)

    def wait(self, condition, what, seconds=RECOVERY_SECONDS):
        """While the broker lives."""
        try:
            return wait_until(self.broker.process, condition, seconds, what)
        except AssertionError as error:
            raise AssertionError(f"{error}\n{[server.text()[-1500:] for server in self.servers]}") from None

    def pause(self, seconds):
        """Any moment of the seconds to come."""
        threading.Event().wait(self.random.random() * seconds)

    # Kills.

    def kill_server(self):
        self.servers[0].kill()
        self.start_server(self.servers[0])

    def kill_connection(self):
        """What is on its way, PUBACKs too, is lost."""
        self.way.cut(Cut.BLACK_HOLE)
        self.pause(HALT_SECONDS)
        self.way.drop()
        self.way.mend()

    def is_connected(self):
        """Whether a server has its connections to the broker, that for what is stored and the live one."""
        return any((scrape(server) or {}).get("connected") == 2 for server in self.servers)

    def kill_behind_backlog(self):
        """The server is killed when it has just begun to read what came while it was away."""
        self.way.cut(Cut.REFUSE)
        self.pause(ABSENCE_SECONDS)
        self.way.mend()
        self.wait(self.is_connected, "a server connects to the broker")
        self.pause(HALT_SECONDS * 4)
        self.kill_server()

    def kill(self, kind):
        """False if there was nothing to kill."""
        match kind:
            case "server":
                self.kill_server()
            case "connection":
                self.kill_connection()
            case "broker":
                # In order: it saves its sessions only then.
                self.broker.restart()
            case "absence":
                self.kill_behind_backlog()
            case "cluster":
                self.store.cluster.crash()
            case "backend" | "backend crash":
                return self.store.kill_backend(kind == "backend crash")
            case _:
                raise AssertionError(kind)
        return True

    def draw(self):
        """What is killed next."""
        kinds = ["server", "connection"] if self.canary else list(self.kinds)
        kind = self.random.choices(kinds, [self.kinds[each] for each in kinds])[0]
        if kind not in ("connection", "broker"):
            return kind
        self.cuts += 1
        return kind if self.cuts <= CUTS_MAX else "server"

    def round(self):
        self.pause(LOAD_SECONDS)
        kind = self.draw()
        began = time.monotonic()
        if not self.kill(kind):
            return
        self.done += 1
        self.kills[kind] += 1
        if self.canary:
            self.compare()
            self.publishers.go_on()
        elif self.random.random() >= HURRIED:
            back = time.monotonic()
            self.wait_for_probe(f"a message behind the kill of {kind}")
            self.recoveries[kind].append((time.monotonic() - began, back - began))

    # What is compared.

    def wait_for_probe(self, what):
        key = self.publishers.probe()
        self.wait(lambda: self.is_shown(key), f"{what} is stored")

    def is_shown(self, key):
        """Whether a server shows this telemetry in what is stored."""
        twin, _, number = key
        path = f"/api/v1/robots/{urllib.parse.quote(ruri_of(twin), safe='')}/events?pageSize=50"
        shown = [event for server in self.servers for event in (server.get(path) or {}).get("events", [])]
        return any(event["detail"]["n"] == number for event in shown)

    def in_flight(self):
        sums = [sums for server in self.servers if (sums := scrape(server))]
        return sum(each["messages_in_flight"] for each in sums) if sums else None

    def compare(self):
        """Once all that was said is acked by the broker, and the server has it from there."""
        self.publishers.rest()
        self.wait(self.publishers.idle, "the broker acks what was published")
        # The broker's queue is one: behind this message nothing is in it.
        self.wait_for_probe("the last message")
        self.wait(lambda: self.in_flight() == 0, "nothing is in flight")
        self.acked = self.book.acks()
        with self.store_alone():
            rows = broker_stores.keys(self.store)
            faults = broker_stores.unbalanced(self.store)
        self.stored = len(rows)
        self.found = self.book.check(rows)
        self.wrong = self.found.lines()
        if faults:
            self.wrong.append(f"faults whose raises and clears do not fit: {len(faults)}, {faults[:5]}")
        if self.watch.breaches:
            self.wrong.append(f"the law of messages: {len(self.watch.breaches)}, {self.watch.breaches[:3]}")

    @contextlib.contextmanager
    def store_alone(self):
        """Of SQLite nobody else may read what uplinkd_held serves: it is not all in the file."""
        if isinstance(self.store, broker_stores.Postgres):
            yield
            return
        self.servers[0].kill()
        yield
        self.start_server(self.servers[0])

    def clean(self):
        return not self.wrong

    def line(self):
        lost, doubled = len(self.found.missing), len(self.found.doubled)
        return (f"kills {self.done}, acked {self.acked}, stored {self.stored}, lost {lost},"
                f" doubled {doubled}, out of order {len(self.found.disordered)},"
                f" scrapes {self.watch.scrapes}")  # fmt: skip

    def canary_found(self):
        """What it is planted to do, and nothing else."""
        return bool(self.found.missing if self.canary == "acks_on_arrival" else self.found.doubled)

    def recovery_lines(self):
        """By kind of kill how long it took until a message behind it was stored."""
        lines = []
        for kind, kills in sorted(self.kills.items()):
            line = f"{kind}: kills {kills}"
            if each := sorted(self.recoveries[kind]):
                (median, back), (most, most_back) = each[len(each) // 2], each[-1]
                line += f", recovery median {median:.1f} s ({back:.1f} s until it was back)"
                line += f", most {most:.1f} s ({most_back:.1f} s)"
            lines.append(line)
        return lines

    def run(self, kills, progress=None):
        """To the end, or to the first thing that is wrong."""
        self.start()
        compared = 0
        while self.done < kills and self.clean():
            self.round()
            if self.done < compared + COMPARE_EVERY:
                continue
            compared = self.done
            self.compare()
            self.publishers.go_on()
            if progress:
                print(self.line(), file=progress, flush=True)
        if self.clean():
            self.finish()
        return self.clean()

    def finish(self):
        self.compare()
        for server in self.servers:
            if server.terminate(60) != 0:
                self.wrong.append(f"a server did not end in order: {server.text()[-500:]}")

    def close(self):
        self.publishers.close()
        self.watch.close()
        for server in self.servers:
            server.close()
        self.broker.close()
        self.way.close()
        self.store.close()
