"""Publishers at QoS 1, each with twins of its own: they send on without waiting, within a window, and
write into a book (broker_book.py) what they published and what the broker acked.

A publisher whose connection ends connects again. What was not acked it publishes again, all of it or, by
chance, nothing; the prober all of it always.
"""

import asyncio
import collections
import itertools
import random
import threading

from broker_script import PROBE, Kind, keys_again, keys_of, message_of, numbers_of

WINDOW = 100
# Messages that a publisher sends at once, on average.
BURST = 5
RECONNECT_SECONDS = 0.05
# For a CONNACK.
ANSWER_SECONDS = 10
PACKET_IDS = 0xFFFF
CONNECT, CONNACK, PUBLISH_QOS1, PUBACK = 0x10, 0x20, 0x32, 0x40
PUBACK_BYTES = 4


def field(data):
    return len(data).to_bytes(2, "big") + data


def packet(first, body):
    size = bytearray()
    left = len(body)
    while True:
        left, digit = left >> 7, left & 0x7F
        size.append(digit | (0x80 if left else 0))
        if not left:
            return bytes([first]) + bytes(size) + body


def connect_packet(client_id):
    """MQTT 3.1.1, a clean session, no keepalive."""
    return packet(CONNECT, field(b"MQTT") + b"\x04\x02\x00\x00" + field(client_id))


def publish_packet(packet_id, topic, payload):
    return packet(PUBLISH_QOS1, field(topic.encode()) + packet_id.to_bytes(2, "big") + payload.encode())


class Publisher:
    """On the loop of its Publishers. `keys`: what it says; it ends never."""

    def __init__(self, name, keys, crowd):
        self.name = name.encode()
        self.keys = keys
        self.crowd = crowd
        self.random = random.Random(name)
        self.packet_ids = itertools.cycle(range(1, PACKET_IDS + 1))
        # By packet id, in the order in which they were sent.
        self.unacked = {}
        # What must be published before anything new.
        self.again = collections.deque()

    async def run(self):
        while not self.crowd.ending:
            try:
                await self.connection()
            except (OSError, asyncio.IncompleteReadError, asyncio.TimeoutError):
                pass
            await asyncio.sleep(RECONNECT_SECONDS)

    async def connection(self):
        """Until it ends."""
        reader, writer = await asyncio.open_connection("127.0.0.1", self.crowd.port)
        try:
            writer.write(connect_packet(self.name))
            answer = await asyncio.wait_for(reader.readexactly(PUBACK_BYTES), ANSWER_SECONDS)
            if answer[0] != CONNACK or answer[3] != 0:
                raise OSError(f"the broker refuses a publisher: {answer!r}")
            if self.keys is self.crowd.probes or self.random.random() < 0.5:
                self.again.extendleft(reversed(self.unacked.values()))
            self.unacked.clear()
            acks = asyncio.ensure_future(self.read_acks(reader))
            try:
                while not acks.done():
                    for _ in range(self.random.randrange(1, 2 * BURST)):
                        self.send_one(writer)
                    await writer.drain()
                    await asyncio.wait({acks}, timeout=self.crowd.seconds_each * BURST)
                acks.result()
            finally:
                acks.cancel()
        finally:
            writer.close()

    def send_one(self, writer):
        if len(self.unacked) >= WINDOW or writer.is_closing():
            return
        rows_of = keys_of
        if self.again:
            key, rows_of = self.again.popleft(), keys_again
        elif self.crowd.paused and self.keys is not self.crowd.probes:
            return
        else:
            key = next(self.keys, None)
            if key is None:
                return
        packet_id = next(self.packet_ids)
        self.unacked[packet_id] = key
        for each in rows_of(key):
            self.crowd.book.publish(each)
        writer.write(publish_packet(packet_id, *message_of(*key)))

    async def read_acks(self, reader):
        while True:
            answer = await reader.readexactly(PUBACK_BYTES)
            key = self.unacked.pop(int.from_bytes(answer[2:], "big"), None)
            if answer[0] != PUBACK or key is None:
                raise OSError(f"no PUBACK: {answer!r}")
            for each in keys_of(key):
                self.crowd.book.ack(each)

    def idle(self):
        return not self.unacked and not self.again


class Probes:
    """The messages of the probe's twin: as many as were asked for."""

    def __init__(self):
        self.asked = itertools.count(1)
        self.waiting = collections.deque()

    def ask(self):
        key = (PROBE, Kind.TELEMETRY, next(self.asked))
        self.waiting.append(key)
        return key

    def __iter__(self):
        return self

    def __next__(self):
        try:
            return self.waiting.popleft()
        except IndexError:
            raise StopIteration from None


class Publishers:
    """`rate`: messages each second of all together, while nothing holds them up. On a thread of its own;
    the methods are for any other one."""

    def __init__(self, port, book, twins, publishers, rate):
        self.port = port
        self.book = book
        self.seconds_each = publishers / rate
        self.paused = False
        self.ending = False
        self.probes = Probes()
        self.all = [
            Publisher(f"publisher-{i}", in_turn([numbers_of(t) for t in range(i, twins, publishers)]), self)
            for i in range(publishers)
        ]
        self.all.append(Publisher("prober", self.probes, self))
        self.thread = threading.Thread(target=lambda: asyncio.run(self.run()), daemon=True)

    def start(self):
        self.thread.start()

    async def run(self):
        await asyncio.gather(*(publisher.run() for publisher in self.all))

    def probe(self):
        """Has one more message published; returns its key."""
        return self.probes.ask()

    def rest(self):
        """Nothing new is said from now on."""
        self.paused = True

    def go_on(self):
        self.paused = False

    def idle(self):
        """All that was said was acked by the broker."""
        return not self.probes.waiting and all(publisher.idle() for publisher in self.all)

    def close(self):
        self.ending = True


def in_turn(iterators):
    """One of each after the other, without end."""
    for iterator in itertools.cycle(iterators):
        yield next(iterator)
