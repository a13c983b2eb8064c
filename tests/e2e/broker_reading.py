"""A server that reads a real mosquitto, twins that publish there, and what both come to: for tests of the
trouble between them (test_broker_trouble.py).

Twins say what broker_script.py has; a book (broker_book.py) has what they said and what the broker acked.
"""

import collections
import contextlib
import functools
import json
import sqlite3
import threading
import time

import broker_stores
from broker_book import Book
from broker_messages import connection, is_subscribed, numbers, quoted
from broker_script import PROBE, Kind, message_of, ruri_of, uuid_of
from broker_watch import breach, scrape
from harness import EndToEnd, Server, wait_until
from mosquitto import Mosquitto
from mqtt_client import Client
from presence import OFFLINE, shown_history

DEADLINE_SECONDS = 60
LOOK_SECONDS = 0.1
# A twin's, here. A server finds out in less that it does not hear the broker, or does not read.
PRESENCE_TIMEOUT_SECONDS = 6
SETTINGS = """{store}
[mqtt]
url = "mqtt://{broker}"
{mqtt}
[cyberwave]
presence_timeout = "{presence}s"
"""


class Watch:
    """Looks at a server all the time: whether its counts of messages add up, and what presences it shows.
    Thread-safe."""

    def __init__(self, server):
        self.server = server
        self.lock = threading.Lock()
        self.presences = collections.defaultdict(set)
        self.breaches = []
        self.scrapes = 0
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        while not self.ended.wait(LOOK_SECONDS):
            sums = scrape(self.server)
            robots = (self.server.get("/api/v1/robots?pageSize=1000") or {}).get("robots", [])
            with self.lock:
                if sums:
                    self.scrapes += 1
                    if wrong := breach(sums):
                        self.breaches.append(wrong)
                for robot in robots:
                    self.presences[robot["ruri"]].add(robot["presence"])

    def begin(self):
        """Forgets what presences were shown until now."""
        with self.lock:
            self.presences.clear()

    def seen(self, twin):
        """Every presence of the twin that was shown since."""
        with self.lock:
            return set(self.presences[ruri_of(twin)])

    def close(self):
        self.ended.set()
        self.thread.join(DEADLINE_SECONDS)


class Twins:
    """What publishes for twins, by one connection to the broker. Confined to one thread."""

    def __init__(self, port, book, name="twins"):
        self.client = Client(port, name)
        self.book = book
        self.counts = collections.Counter()

    def next_keys(self, twins, each):
        """So many further messages of each of the twins, one after the other."""
        keys = []
        for _ in range(each):
            for twin in twins:
                self.counts[twin] += 1
                keys.append((twin, Kind.TELEMETRY, self.counts[twin]))
        return keys

    def tell(self, keys):
        """At QoS 1, until the broker acked all."""
        for key in keys:
            self.book.publish(key)
            self.client.publish(*message_of(*key), qos=1, acked=functools.partial(self.book.ack, key))
        self.client.flush()

    def tell_unacked(self, keys):
        """At QoS 0: no PUBACK answers them."""
        for key in keys:
            self.book.publish(key)
            self.client.publish(*message_of(*key))

    def pose(self, twins, x):
        """Where they are: live state."""
        position = json.dumps({"source_type": "edge", "position": {"x": x, "y": 0, "z": 0}})
        for twin in twins:
            self.client.publish(f"cyberwave/twin/{uuid_of(twin)}/position", position)

    def close(self):
        self.client.close()


class Talk:
    """Twins that go on speaking on a thread of their own: `durable` ones at QoS 1, `live` ones of where
    they are."""

    EVERY_SECONDS = 0.05

    def __init__(self, port, book, durable, live, each=1):
        self.twins = Twins(port, book, "talk")
        self.durable, self.live, self.each = durable, live, each
        self.failure = None
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        x = 0
        try:
            while not self.ended.wait(self.EVERY_SECONDS):
                x += 1
                self.twins.pose(self.live, x)
                self.twins.tell(self.twins.next_keys(self.durable, self.each))
        except (OSError, AssertionError) as error:
            self.failure = error

    def end(self):
        """All that was said is acked by the broker then."""
        self.ended.set()
        self.thread.join(DEADLINE_SECONDS)
        if self.failure or self.thread.is_alive():
            raise AssertionError(f"the twins could not go on speaking: {self.failure}")

    def close(self):
        self.ended.set()
        self.thread.join(DEADLINE_SECONDS)
        self.twins.close()


class Reading(EndToEnd):
    """A broker, and a server that reads it; its store is SQLite unless a test has another."""

    def setUp(self):
        super().setUp()
        self.broker = None
        self.book = Book()
        self.store = broker_stores.Sqlite(self.folder)
        self.running = None
        self.watch = None
        self.store_settings = ""

    def keep(self, thing):
        self.open_things.append(thing)
        return thing

    def start_broker(self, lines=""):
        self.broker = self.keep(Mosquitto(self.folder, lines)).start()

    def serve(self, mqtt="", way=None):
        """`way`: where the server finds the broker, if not where it is."""
        if self.broker is None:
            self.start_broker()
        settings = SETTINGS.format(
            store=self.store_settings, broker=way or f"127.0.0.1:{self.broker.port}",
            mqtt=mqtt, presence=PRESENCE_TIMEOUT_SECONDS,
        )  # fmt: skip
        self.running = self.keep(Server(self.folder, settings, self.store.url)).start()
        self.wait_until_subscribed()
        self.watch = self.keep(Watch(self.running))
        return self.running

    def twins(self, name="twins"):
        return self.keep(Twins(self.broker.port, self.book, name))

    def talk(self, durable, live, each=1):
        return self.keep(Talk(self.broker.port, self.book, durable, live, each))

    # What the server shows.

    def mqtt(self, name, **labels):
        """A sample of /metrics whose name begins with uplinkd_mqtt_; labels in the order that they have there."""
        found, key = numbers(self.running), " ".join([name, *labels.values()])
        self.assertIn(key, found)
        return found[key]

    def settled(self, outcome):
        return self.mqtt("messages_settled_total", outcome=outcome)

    def degraded(self):
        return (self.running.get("/readyz") or {}).get("degraded", [])

    def robot(self, twin):
        """The robot as JSON; nothing while it is not known."""
        return self.running.get(f"/api/v1/robots/{quoted(ruri_of(twin))}") or {}

    def presence(self, twin):
        return self.robot(twin).get("presence")

    def x(self, twin):
        return self.robot(twin).get("cyberwave", {}).get("position", {}).get("x")

    def connection(self, name="durable"):
        """What the status says of this connection to the broker."""
        return connection(self.running, name)

    # Waiting.

    def wait(self, condition, what, seconds=DEADLINE_SECONDS):
        try:
            return wait_until(self.running.process, condition, seconds, what, LOOK_SECONDS)
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.running.text()[-3000:]}") from None

    def wait_until_subscribed(self):
        self.wait(lambda: is_subscribed(self.running), "the server is subscribed")

    def wait_for_presence(self, twins, presence, again=lambda: None):
        """Until all of the twins are shown so; `again` is done at each look."""

        def look():
            again()
            return {self.presence(twin) for twin in twins} == {presence}

        self.wait(look, f"{twins} are {presence}")

    def stay(self, seconds, check):
        """For so long the check passes, at each look."""
        end = time.monotonic() + seconds

        def look():
            check()
            return time.monotonic() >= end

        self.wait(look, "the time passes", seconds + DEADLINE_SECONDS)

    def rows(self):
        """The key of each row, in the order of the store."""
        return broker_stores.keys(self.store)

    def wait_until_all_is_stored(self, seconds=DEADLINE_SECONDS):
        """The broker's queue is one: behind a last message nothing is in it."""
        prober = self.twins("prober")
        prober.counts[PROBE] = len(self.book.published)
        last = prober.next_keys([PROBE], 1)
        prober.tell(last)
        self.wait(lambda: last[0] in self.rows(), "the last message is stored", seconds)
        self.wait(lambda: self.mqtt("messages_in_flight") == 0, "nothing is in flight", seconds)
        prober.close()

    @contextlib.contextmanager
    def sqlite_held(self):
        """Somebody else writes: no commit of the server succeeds meanwhile."""
        writer = sqlite3.connect(self.store.path, isolation_level=None, timeout=DEADLINE_SECONDS)
        try:
            writer.execute("BEGIN IMMEDIATE")
            yield
            writer.execute("ROLLBACK")
        finally:
            writer.close()

    # Verdicts.

    def assert_stored_once(self):
        """What the broker acked is stored, nothing is stored more often than it was published, and each
        twin's messages are in order; and the counts added up at every scrape."""
        self.assertEqual(self.book.check(self.rows()).lines(), [])
        looks = self.watch.scrapes
        self.wait(lambda: self.watch.scrapes > looks, "the counts are looked at once more")
        self.assertEqual(self.watch.breaches, [])

    def assert_never_offline(self, twins):
        lies = [twin for twin in twins if OFFLINE in self.watch.seen(twin)]
        self.assertEqual(lies, [], "shown as offline, though no server could know that")

    def assert_offline_at_last(self, twins):
        """They are silent now, and it is heard; and they were never before."""
        for twin in twins:
            history = self.wait(lambda ruri=ruri_of(twin): self.history_to_offline(ruri), f"{twin} is offline")
            self.assertEqual(history.count(OFFLINE), 1, f"{twin}: {history}")

    def history_to_offline(self, ruri):
        """The presences of the robot that are stored, once the last of them is that."""
        history = shown_history(self.running, ruri)
        return history if history[-1:] == [OFFLINE] else None
