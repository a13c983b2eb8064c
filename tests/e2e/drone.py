"""A drone in Python, on Debian's gRPC library: it does what each line that it reads says, and answers each
by a line (drones.py drives it). PYTHONPATH holds what protoc made of avatar.proto and relay.proto.

{"act": "connect", "name": N, "target": HOST:PORT, "ca": FILE, "certificate": FILE, "key": FILE}
{"act": "call", "to": N, "type": T, "request": {...}}, see call_of; several at once: {"act": "calls", "calls": [...]}
{"act": "subscribe", "to": N, "times": COUNT, "pause": SECONDS}
{"act": "fly", "to": [N, ...], "seed": S, "lost": SHARE}, see Flight; then "progress" until "land", which gives
the books; several flights at once: each with types of its own
"""

import base64
import collections
import itertools
import json
import random
import sys
import threading
import time

import grpc
from drone_book import Book
from drone_samples import TYPES, UNSTORED, WRONG, WRONG_EVERY, call_of
from google.protobuf import json_format
from uncrew.v1 import avatar_pb2
from uplink.v1 import relay_pb2

SERVICE = "/uncrew.v1.AvatarService/"
# A wait that does not end is the test's failure, not its end.
PATIENCE_SECONDS = 30
# Between two tries of a sample whose call failed.
PAUSE_SECONDS = 0.05
LOST_AFTER_SECONDS = 0.01
# How an answer is lost. A server can be faster than the first two; the last one always loses it.
LOSSES = ("deadline", "lose_after", "unread")
# In the book, of a call that ended OK: the drone does not know what became of its sample.
UNREAD = "UNREAD"
# Of a call of a flight: more than uncrew.answer_within.
DEADLINE_SECONDS = 8
OPTIONS = (
    ("grpc.ssl_target_name_override", "localhost"),
    ("grpc.initial_reconnect_backoff_ms", 100),
    # How long one try to connect may last, on a busy machine.
    ("grpc.min_reconnect_backoff_ms", 5000),
    ("grpc.max_reconnect_backoff_ms", 500),
    # Two channels of one drone have two connections.
    ("grpc.use_local_subchannel_pool", 1),
)


def read(path):
    if path is None:
        return None
    with open(path, "rb") as file:
        return file.read()


def reason_of(number):
    return relay_pb2.RejectReason.Name(number).removeprefix("REJECT_REASON_")


def answer_of(response):
    answer = {"outcome": avatar_pb2.Outcome.Name(response.outcome).removeprefix("OUTCOME_")}
    if response.reason:
        answer["reason"] = reason_of(response.reason)
    if response.retry_after_ms:
        answer["retry_after_ms"] = response.retry_after_ms
    answer["field"], answer["detail"] = response.field, response.detail
    answer["dropped"] = {each.field: reason_of(each.reason) for each in response.dropped}
    return answer


class Drone:
    """Its channels by name. Flights use them from threads of their own."""

    def __init__(self):
        self.channels = {}
        self.flights = []

    def connect(self, name, target, ca, certificate=None, key=None):
        credentials = grpc.ssl_channel_credentials(read(ca), read(key), read(certificate))
        self.channels[name] = grpc.secure_channel(target, credentials, OPTIONS)
        return {}

    def start(self, call):
        """`request`: in the JSON form of the contract; `append`: bytes that follow it, in base64; `cut`:
        so many bytes are missing at its end."""
        request = json_format.ParseDict(call["request"], getattr(avatar_pb2, f"Publish{call['type']}Request")())
        written = request.SerializeToString() + base64.b64decode(call.get("append", ""))
        method = self.channels[call["to"]].unary_unary(
            f"{SERVICE}Publish{call['type']}", response_deserializer=avatar_pb2.PublishResponse.FromString
        )
        deadline = call.get("deadline", PATIENCE_SECONDS)
        return method.future(written[: len(written) - call.get("cut", 0)], timeout=deadline)

    def finish(self, future, lose_after=None):
        """Waits for its end. `lose_after`: it is cancelled if it has no answer after so many seconds."""
        began = time.monotonic()
        if lose_after is not None:
            done = threading.Event()
            future.add_done_callback(lambda _: done.set())
            done.wait(lose_after)
            future.cancel()
        try:
            said = answer_of(future.result())
        except (grpc.RpcError, grpc.FutureCancelledError):
            said = {}
        code, details = (future.code().name, future.details()) if not future.cancelled() else ("CANCELLED", "")
        return {"code": code, "details": details, "seconds": time.monotonic() - began, **said}

    def call(self, lose_after=None, **call):
        return self.finish(self.start(call), lose_after)

    def calls(self, calls):
        """All are on their way before the first one is waited for."""
        return [self.finish(future) for future in [self.start(call) for call in calls]]

    def subscribe(self, to, times, pause):
        method = self.channels[to].unary_stream(f"{SERVICE}SubscribeUAVCommands")
        waiting, ends = threading.Event(), collections.Counter()
        for _ in range(times):
            call = method(b"", timeout=PATIENCE_SECONDS)
            try:
                ends["commands"] += len(list(call))
            except grpc.RpcError:
                pass
            ends[f"{call.code().name}: {call.details()}"] += 1
            waiting.wait(pause)
        return ends

    def fly(self, to, seed, **more):
        self.flights.append(Flight(self, to, random.Random(seed), **more))
        return {}

    def settled(self):
        """Of each flight how many durable samples were answered."""
        return [flight.stored for flight in self.flights]

    def progress(self):
        return sum(self.settled())

    def land(self):
        """After all that is open was answered for. Gives the books by drone."""
        for flight in self.flights:
            flight.lands.set()
        books, problems = collections.defaultdict(Book), []
        for flight in self.flights:
            flight.thread.join()
            books[flight.of].add(flight.book)
            problems += flight.problems
        self.flights = []
        return {"books": {of: book.dump() for of, book in books.items()}, "problems": problems}


class Flight:
    """Publishes samples of these types of the drone `of`, one after the other, those of the numbers from
    `first` on. After each call it stays with its channel with the chance `stay`, if that answered; else it
    takes any. Of `lost` of the calls it takes no answer. It sends what is durable again until a call ends OK.
    """

    def __init__(self, drone, to, chooser, lost, of="", types=tuple(TYPES), first=1, stay=0.0):
        self.drone, self.to, self.random, self.lost = drone, to, chooser, lost
        self.of, self.types, self.first, self.stay = of, types, first, stay
        self.at = chooser.choice(to)
        self.book = Book()
        self.stored = 0
        self.lands, self.pause = threading.Event(), threading.Event()
        self.problems = []
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        try:
            for number in itertools.count(self.first):
                # Everything once more, so that the server that is there then was told all of it.
                is_last = self.lands.is_set()
                for name in self.types:
                    if name != WRONG or number % WRONG_EVERY == 0:
                        self.publish(name, number)
                if is_last:
                    return
        # Whatever it is, the test is told when the drone lands.
        except Exception as error:  # pylint: disable=broad-except
            self.problems.append(repr(error))

    def publish(self, name, number):
        kind, request = call_of(name, number)
        self.book.publish(name, number)
        while True:
            self.book.answer(name, number, self.word_of(kind, request))
            if name in UNSTORED:
                return
            if self.book.is_settled(name, number):
                self.stored += 1
                return
            self.pause.wait(PAUSE_SECONDS)

    def word_of(self, kind, request):
        call = {"to": self.at, "type": kind, "request": request, "deadline": DEADLINE_SECONDS}
        way = self.random.choice(LOSSES) if self.random.random() < self.lost else ""
        if way in ("deadline", "lose_after"):
            call[way] = self.random.uniform(0, LOST_AFTER_SECONDS)
        said = self.drone.call(**call)
        if way == "unread" and said["code"] == "OK":
            said = {"code": UNREAD}
        if said["code"] != "OK" or self.random.random() >= self.stay:
            self.at = self.random.choice(self.to)
        return said.get("outcome", said["code"])


def main():
    drone = Drone()
    for line in sys.stdin:
        command = json.loads(line)
        print(json.dumps(getattr(drone, command.pop("act"))(**command)), flush=True)


if __name__ == "__main__":
    main()
