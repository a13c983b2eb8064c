#!/usr/bin/env python3
"""A drone that reports to uplinkd: the least that a real one needs, on gRPC's own library for Python.

It flies a delivery that it makes up. Replace flight() by what your drone knows, and keep the rest:
docs/integrate/uncrew.md says why each step is as it is.
"""

import argparse
import collections
import random
import sys
import time

import grpc
from uncrew.v1 import avatar_pb2 as avatar
from uncrew.v1 import avatar_pb2_grpc

# How long the call of a durable sample may take: the server answers within 5 s, or says that it cannot. A
# live sample is not worth waiting for: the next one is newer.
CALL_SECONDS, LIVE_SECONDS = 10, 2
# The largest request that the server takes.
REQUEST_BYTES_MAX = 64 * 1024
# Durable samples that wait for their answer at most.
WAITING_MAX = 10_000
# Calls of live samples that wait for their answer at most. The server takes 64 calls at once.
LIVE_MAX = 48
# Before a durable sample is sent again: the first pause, and the longest.
PAUSE_SECONDS, PAUSE_SECONDS_MAX = 1, 10
# gRPC's own pause between two tries to connect grows to two minutes: long for something that flies.
OPTIONS = (("grpc.max_reconnect_backoff_ms", 10_000),)
# The link, the server or its store is away, or there is no room: the same sample again, later. A request
# that is too large is RESOURCE_EXHAUSTED each time: publish() drops it.
LATER = (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.DEADLINE_EXCEEDED, grpc.StatusCode.RESOURCE_EXHAUSTED)


class Avatar:
    """The server, as the drone calls it."""

    def __init__(self, target, pki, name):
        def read(file):
            with open(f"{pki}/{file}", "rb") as opened:
                return opened.read()

        credentials = grpc.ssl_channel_credentials(read("ca.crt"), read(f"{name}.key"), read(f"{name}.crt"))
        self.stub = avatar_pb2_grpc.AvatarServiceStub(grpc.secure_channel(target, credentials, OPTIONS))
        # Types and calls of live samples that are not answered yet.
        self.live = []
        # Oldest first: what the server has to store, and did not say that it has.
        self.waiting = collections.deque()
        # The call of the oldest.
        self.under_way = None
        self.pause = PAUSE_SECONDS
        # When the oldest may be sent, by the monotonic clock.
        self.not_before = 0

    def publish(self, durable, kind, request):
        """Returns at once."""
        if request.ByteSize() > REQUEST_BYTES_MAX:
            print(f"{kind}: dropped, {request.ByteSize()} bytes are too many", file=sys.stderr)
        elif durable:
            self.keep(kind, request)
        else:
            self.show(kind, request)

    def start(self, kind, request, seconds):
        # Python's library goes on connecting while a call waits for that, and hardly otherwise.
        return getattr(self.stub, f"Publish{kind}").future(request, timeout=seconds, wait_for_ready=True)

    def is_answered(self, kind, call, seconds):
        """False: the sample has to be sent again. Raises FutureTimeoutError while there is no answer."""
        try:
            answer = call.result(timeout=seconds)
        except grpc.RpcError as error:
            if error.code() in LATER:
                return False
            # A certificate or a server that is not for this drone: no retry changes that.
            # As below, ascii() keeps what steers a terminal in a text of the server from it.
            sys.exit(f"{kind}: {error.code().name}: {error.details()!a}")
        if answer.reason or answer.dropped:
            # The sample is invalid, in whole or in part, or came too soon: report it, do not repeat it.
            print(f"{kind}: {answer.field!a} {answer.detail!a} {list(answer.dropped)}", file=sys.stderr)
        return True

    def show(self, kind, request):
        """A live sample. One that does not arrive is lost, as is one while too many wait: the next is newer."""
        before, self.live = self.live, []
        for each in before:
            try:
                self.is_answered(*each, 0)
            except grpc.FutureTimeoutError:
                self.live.append(each)
        if len(self.live) < LIVE_MAX:
            self.live.append((kind, self.start(kind, request, LIVE_SECONDS)))

    def keep(self, kind, request):
        """A durable sample, for flush() to send."""
        if len(self.waiting) < WAITING_MAX:
            self.waiting.append((kind, request))
        else:
            print(f"{kind}: lost, too many wait", file=sys.stderr)

    def flush(self, until):
        """Sends what waits, one after the other, so that it is stored in its order. Returns by `until`, and in
        a pause at once: the next time looks at what is answered then. Both are of the monotonic clock."""
        while self.waiting and self.not_before <= time.monotonic() < until:
            kind, request = self.waiting[0]
            self.under_way = self.under_way or self.start(kind, request, CALL_SECONDS)
            try:
                answered = self.is_answered(kind, self.under_way, max(0, until - time.monotonic()))
            except grpc.FutureTimeoutError:
                return
            self.under_way = None
            if answered:
                self.waiting.popleft()
                self.pause = PAUSE_SECONDS
            else:
                # Longer each time, and another for each drone.
                self.not_before = time.monotonic() + self.pause * random.uniform(0.5, 1.5)
                self.pause = min(2 * self.pause, PAUSE_SECONDS_MAX)


def now():
    """Both clocks. They make a sample the same when it is sent again, so they are read once for each."""
    boot_us = time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000
    return avatar.Metadata(sampled_at_unix_us=time.time_ns() // 1000, sampled_at_boot_us=boot_us)


def flight(step, rounds):
    """What the drone knows at this step: whether it has to be stored, the type, and the request."""
    percent = 60 - 50 * step / rounds
    battery = avatar.TelemetryBattery(id=0, remaining_percent=percent, voltage_v=22.2)
    yield False, "Battery", avatar.PublishBatteryRequest(metadata=now(), battery=battery)
    latitude = 47.3769 + step / 1e4
    position = avatar.TelemetryPosition(latitude_deg=latitude, longitude_deg=8.5417, absolute_altitude_m=431)
    yield False, "Position", avatar.PublishPositionRequest(metadata=now(), position=position)

    # A mode each time: the server stores the changes.
    mode = avatar.FLIGHT_MODE_MISSION if step < rounds - 1 else avatar.FLIGHT_MODE_LAND
    mode = avatar.TelemetryFlightMode(mode=mode)
    yield True, "FlightMode", avatar.PublishFlightModeRequest(metadata=now(), flight_mode=mode)
    if step == 0:
        text = avatar.TelemetryStatusText(type=avatar.STATUS_TEXT_TYPE_INFO, text="takes off")
        yield True, "StatusText", avatar.PublishStatusTextRequest(metadata=now(), status_text=text)

    # All that are active, each time: what is not in the set is over.
    alerts = avatar.Alerts()
    if percent < 30:
        alerts.alerts.add(
            alert_id="battery-low", text="below 30 %", reaction=avatar.AlertReaction(rtl={}),
            battery_percentage=avatar.AlertBatteryPercentage(remaining_percent=percent, threshold_percent=30),
        )  # fmt: skip
    yield True, "Alert", avatar.PublishAlertRequest(metadata=now(), alerts=alerts)

    # All that wait for an operator. Without a sample that says "none" the last one would stay open.
    asks = avatar.OperatorActionRequests()
    if rounds // 3 <= step < 2 * rounds // 3:
        asks.requests.add(request_id="delivery-1-ready", text="Is the garden free?", confirm_delivery_ready={})
    request = avatar.PublishOperatorActionRequestsRequest(metadata=now(), operator_action_requests=asks)
    yield True, "OperatorActionRequests", request


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", default="localhost:7443", help="host and port of listen.relay")
    parser.add_argument("--pki", default="pki", help="folder with ca.crt and the drone's certificate and key")
    parser.add_argument("--name", default="d1", help="of the drone's files: NAME.crt, NAME.key")
    parser.add_argument("--rounds", type=int, default=60)
    parser.add_argument("--every", type=float, default=1, help="seconds of a round")
    options = parser.parse_args()
    link = Avatar(options.target, options.pki, options.name)
    step = 0
    while step < options.rounds or link.waiting:
        # Not all drones at the same moment.
        next_round = time.monotonic() + options.every * random.uniform(0.9, 1.1)
        if step < options.rounds:
            for durable, kind, request in flight(step, options.rounds):
                link.publish(durable, kind, request)
        step += 1
        # Durable samples have the rest of the round, and live ones never wait for them.
        link.flush(next_round)
        time.sleep(max(0, next_round - time.monotonic()))
    print(f"landed after {options.rounds} rounds, everything stored")


if __name__ == "__main__":
    main()
