"""The crash campaign with a broker: kills uplinkd, its store, its connections and at times the broker at
random moments, while many twins publish at QoS 1, and compares what the broker acked to the publishers
with what is stored. chaos_run.py --cyberwave runs it.
"""

import urllib.parse

import broker_stores
from broker_book import Book, Findings
from broker_script import TWINS, ruri_of
from broker_watch import Watch, scrape
from chaos_rounds import HALT_SECONDS, Rounds
from mosquitto import Mosquitto
from mqtt_publishers import Publishers
from tcp_proxy import Cut, TcpProxy

PUBLISHERS = 8
# Of all publishers together; of a canary's so many that something is always on its way.
RATE = 1000
CANARY_RATE = 1500
CANARIES = {"acks_on_arrival": "uplinkd_acks_on_arrival", "forgets_deliveries": "uplinkd_forgets_deliveries"}
ABSENCE_SECONDS = 12.0
# Connections of one uplinkd that end in a row, soon after they began, before it takes somebody else to use
# its id and pauses for a minute (server/mqtt/reconnect.h): one more than the campaign ends.
CUTS_MAX = 2
SETTINGS = """[mqtt]
url = "mqtt://{way}"
[presence]
timeout = "1s"
"""


class BrokerCampaign(Rounds):
    canaries = CANARIES

    def __init__(self, folder, store, seed, canary=None):
        self.broker = Mosquitto(folder)
        # uplinkd's way to the broker; publishers have their own.
        self.way = TcpProxy(f"127.0.0.1:{self.broker.port}")
        super().__init__(folder, store, seed, canary)
        self.book = Book()
        self.publishers = Publishers(
            self.broker.port, self.book, TWINS, PUBLISHERS, CANARY_RATE if canary else RATE
        )
        self.watch = Watch(self.servers)
        self.found = Findings()
        # Kills that ended its connections, since a server was started last.
        self.cuts = 0

    def settings(self):
        return SETTINGS.format(way=self.way.address)

    def load(self):
        return self.broker.process

    def ways(self):
        return [self.way]

    # The parts and their lives.

    def start_server(self, server):
        super().start_server(server)
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

    # Kills.

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
        match kind:
            case "broker":
                # In order: it saves its sessions only then.
                self.broker.restart()
            case "absence":
                self.kill_behind_backlog()
            case _:
                return super().kill(kind)
        return True

    def draw(self):
        kind = super().draw()
        if kind not in ("connection", "broker"):
            return kind
        self.cuts += 1
        return kind if self.cuts <= CUTS_MAX else "server"

    # What is compared.

    def wait_for_recovery(self, kind):
        self.wait_for_probe(f"a message behind the kill of {kind}")

    def wait_for_probe(self, what):
        key = self.publishers.probe()
        self.wait(lambda: self.is_shown(key), f"{what} is stored")

    def is_shown(self, key):
        """Whether a server shows this telemetry in what is stored."""
        twin, _, number = key
        path = f"/api/v1/events?ruri={urllib.parse.quote(ruri_of(twin), safe='')}&pageSize=50"
        shown = [event for server in self.servers for event in (server.get(path) or {}).get("events", [])]
        return any(event["detail"]["n"] == number for event in shown)

    def in_flight(self):
        sums = [sums for server in self.servers if (sums := scrape(server))]
        return sum(each["messages_in_flight"] for each in sums) if sums else None

    def rest(self):
        """Once all that was said is acked by the broker, and the server has it from there."""
        self.publishers.rest()
        self.wait(self.publishers.idle, "the broker acks what was published")
        # The broker's queue is one: behind this message nothing is in it.
        self.wait_for_probe("the last message")
        self.wait(lambda: self.in_flight() == 0, "nothing is in flight")
        self.acked = self.book.acks()

    def go_on(self):
        self.publishers.go_on()

    def look(self):
        rows = broker_stores.keys(self.store)
        faults = broker_stores.unbalanced(self.store)
        self.stored = len(rows)
        self.found = self.book.check(rows)
        self.wrong = self.found.lines()
        if faults:
            self.wrong.append(f"faults whose raises and clears do not fit: {len(faults)}, {faults[:5]}")
        if self.watch.breaches:
            self.wrong.append(f"the law of messages: {len(self.watch.breaches)}, {self.watch.breaches[:3]}")

    def line(self):
        lost, doubled = len(self.found.missing), len(self.found.doubled)
        return (f"kills {self.done}, acked {self.acked}, stored {self.stored}, lost {lost},"
                f" doubled {doubled}, out of order {len(self.found.disordered)},"
                f" scrapes {self.watch.scrapes}")  # fmt: skip

    def canary_found(self):
        """What it is planted to do, and nothing else."""
        return bool(self.found.missing if self.canary == "acks_on_arrival" else self.found.doubled)

    def close(self):
        self.publishers.close()
        self.watch.close()
        super().close()
        self.broker.close()
