"""A drone in Python, on Debian's gRPC library: it does what each line that it reads says, and answers each
by a line (drones.py drives it). PYTHONPATH holds what protoc made of avatar.proto and relay.proto.

{"act": "connect", "name": N, "target": HOST:PORT, "ca": FILE, "certificate": FILE, "key": FILE}
{"act": "call", "to": N, "type": T, "request": {...}}, see call_of; several at once: {"act": "calls", "calls": [...]}
{"act": "subscribe", "to": N, "times": COUNT, "pause": SECONDS}
{"act": "fly", "to": [N, ...], "seed": S, "lost": SHARE}; then "progress" until "land", which gives its book
"""

import base64
import collections
import json
import random
import sys
import threading
import time

import grpc
from drone_book import Book
from drone_samples import TYPES, Kind, request_of, sample_of, times
from google.protobuf import json_format
from uncrew.v1 import avatar_pb2
from uplink.v1 import relay_pb2

SERVICE = "/uncrew.v1.AvatarService/"
# A wait that does not end is the test's failure, not its end.
PATIENCE_SECONDS = 30
# Between two tries of a sample whose call failed.
PAUSE_SECONDS = 0.05
LOST_AFTER_SECONDS = 0.01
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
    """Its channels by name. A flight uses them from a thread of its own."""

    def __init__(self):
        self.channels = {}
        self.flight = None

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

    def fly(self, to, seed, lost):
        self.flight = Flight(self, to, random.Random(seed), lost)
        return {}

    def progress(self):
        return self.flight.stored

    def land(self):
        return self.flight.land()


class Flight:
    """Publishes samples of all types, one after the other, by any of the channels. Of `lost` of the calls it
    takes no answer. It sends what is durable again until it is answered for good."""

    def __init__(self, drone, to, chooser, lost):
        self.drone, self.to, self.random, self.lost = drone, to, chooser, lost
        self.book = Book()
        self.stored = 0
        self.lands, self.pause = threading.Event(), threading.Event()
        self.problem = None
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        number = 0
        try:
            while not self.lands.is_set():
                number += 1
                for name in TYPES:
                    self.publish(name, number)
        # Whatever it is, the test is told when the drone lands.
        except Exception as error:  # pylint: disable=broad-except
            self.problem = repr(error)

    def publish(self, name, number):
        request = request_of(name, sample_of(name, number), times(number))
        self.book.publish(name, number)
        while True:
            self.book.answer(name, number, self.word_of(name, request))
            if self.book.is_settled(name, number):
                self.stored += 1
                return
            if TYPES[name].kind is Kind.LIVE:
                return
            self.pause.wait(PAUSE_SECONDS)

    def word_of(self, name, request):
        call = {"to": self.random.choice(self.to), "type": name, "request": request}
        if self.random.random() < self.lost:
            call[self.random.choice(("deadline", "lose_after"))] = self.random.uniform(0, LOST_AFTER_SECONDS)
        said = self.drone.call(**call)
        return said.get("outcome", said["code"])

    def land(self):
        """After all that is open was answered for."""
        self.lands.set()
        self.thread.join()
        return {"book": self.book.dump(), "problem": self.problem}


def main():
    drone = Drone()
    for line in sys.stdin:
        command = json.loads(line)
        print(json.dumps(getattr(drone, command.pop("act"))(**command)), flush=True)


if __name__ == "__main__":
    main()
