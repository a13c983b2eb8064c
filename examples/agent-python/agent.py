#!/usr/bin/env python3
"""An agent that reports a robot to uplinkd: motion and status while they are fresh, faults until they are
stored, across kills and restarts of both sides.

It makes its robot up. Replace drive() by what your robot knows, and keep the rest:
docs/integrate/protocol.md says why each step is as it is.
"""

import argparse
import math
import pathlib
import random
import sqlite3
import sys
import threading
import time

import grpc
from robot import VERSION, Robot, now
from spool import Spool
from uplink.v1 import relay_pb2 as relay
from uplink.v1 import relay_pb2_grpc

# The server pings a silent connection after 25 s; pings closer than 10 s end it.
OPTIONS = (
    ("grpc.keepalive_time_ms", 20_000),
    ("grpc.keepalive_timeout_ms", 15_000),
    ("grpc.http2.max_pings_without_data", 0),
)
# Between two connections: the first pause, and the longest. A Welcome that held as long as the second of these
# makes the next pause short again.
PAUSE_SECONDS, PAUSE_SECONDS_MAX, STEADY_SECONDS = 1, 60, 10
# A robot whose stream another agent took must not take it back at once.
SUPERSEDED_SECONDS = 60
# How often a stream looks for messages that are due again.
TICK_SECONDS = 0.5
# How long the end waits for what is not stored yet.
END_SECONDS = 30
# No retry changes these: the agent, its certificate or the server's is wrong.
FATAL = (
    grpc.StatusCode.UNAUTHENTICATED, grpc.StatusCode.PERMISSION_DENIED, grpc.StatusCode.INVALID_ARGUMENT,
    grpc.StatusCode.UNIMPLEMENTED, grpc.StatusCode.INTERNAL,
)  # fmt: skip
ABORTED = grpc.StatusCode.ABORTED
SNAPSHOTS = {
    relay.RESEND_KIND_UI_CAPABILITIES: "uiCapabilities",
    relay.RESEND_KIND_CURRENT_SETTINGS: "currentSettings",
    relay.RESEND_KIND_AGENT_INFO: "agentInfo",
}


class Link:
    """Keeps one stream to the server, in a thread of its own. What is published waits for it here."""

    def __init__(self, target, pki, name, spool):
        self.target, self.pki, self.name, self.spool = target, pathlib.Path(pki), name, spool
        # Guards what follows, and tells of its changes.
        self.news = threading.Condition()
        # The latest payload of each live kind that was not sent yet.
        self.live = {}
        # The latest payload of each kind that the server may ask for again.
        self.snapshots = {}
        self.ending = False
        # When the robot is expected back, in Unix milliseconds; nothing if it does not say Goodbye.
        self.back = None
        # Why no further connection is of use.
        self.fatal = None
        self.thread = threading.Thread(target=self.run, name="link", daemon=True)
        self.thread.start()

    def show(self, kind, payload):
        """A live message: a newer one takes its place until it is sent."""
        with self.news:
            self.live[kind] = payload
            self.news.notify_all()

    def keep(self, kind, key, payload):
        """A durable message: on disk when this returns, or told as lost."""
        try:
            trouble = self.spool.keep(key, payload)
        except sqlite3.Error as error:
            trouble = error
        if trouble:
            print(f"{kind}: lost, {trouble}", file=sys.stderr)
        with self.news:
            if kind in SNAPSHOTS.values():
                self.snapshots[kind] = payload
            self.news.notify_all()

    def end(self, back=None):
        """Waits until everything is stored, or for END_SECONDS. How many messages still wait, on disk."""
        with self.news:
            self.ending = True
            self.back = back
            self.news.notify_all()
        self.thread.join(END_SECONDS)
        return self.spool.waiting()

    def run(self):
        pause = PAUSE_SECONDS
        while True:
            stream = Stream(self)
            code, why = stream.run()
            if code is grpc.StatusCode.OK and self.ending:
                return
            print(f"link: {code.name}: {why}", file=sys.stderr)
            if stream.said_goodbye and code is grpc.StatusCode.INVALID_ARGUMENT:
                # A server from before Goodbye. Everything is stored.
                return
            if code in FATAL:
                with self.news:
                    self.fatal = f"{code.name}: {why}"
                    self.news.notify_all()
                return
            pause = PAUSE_SECONDS if stream.was_steady() else pause
            # Longer each time, and another for each robot: after a restart of the server all come back.
            time.sleep(random.uniform(0.5, 1.5) * (SUPERSEDED_SECONDS if code is ABORTED else pause))
            pause = min(2 * pause, PAUSE_SECONDS_MAX)


class Stream:
    """One call of Relay, from Hello to its end."""

    def __init__(self, link):
        self.link, self.spool, self.news = link, link.spool, link.news
        # Below: guarded by `news`. The number up to which all was sent, once Welcome has said where to begin.
        self.sent = None
        self.welcomed_at = None
        # The server reads nothing more.
        self.draining = False
        self.closed = False
        self.said_goodbye = False
        self.call = None
        # What failed here, such as the spool on a full disk. It ends this stream, and the link opens another.
        self.trouble = None

    def credentials(self):
        """Read anew for each connection: a renewed certificate is used."""
        pki, name = self.link.pki, self.link.name
        files = ("ca.crt", f"{name}.key", f"{name}.crt")
        return grpc.ssl_channel_credentials(*((pki / file).read_bytes() for file in files))

    def run(self):
        """How the call ended: the status, and the server's sentence."""
        try:
            code, why = self.talk()
        except Exception as error:
            # Whatever it is: without its thread the robot would be silent for good.
            self.trouble = error
        finally:
            with self.news:
                self.closed = True
                self.news.notify_all()
        if self.trouble:
            is_spool = isinstance(self.trouble, sqlite3.Error)
            return grpc.StatusCode.UNAVAILABLE, f"spool: {self.trouble}" if is_spool else ascii(self.trouble)
        # A terminal obeys what a text of the server may hold: ascii() here and below escapes it.
        return code, ascii(why)

    def talk(self):
        credentials, hello = self.credentials(), self.spool.hello()
        with grpc.secure_channel(self.link.target, credentials, OPTIONS) as channel:
            self.call = relay_pb2_grpc.UplinkRelayStub(channel).Relay(self.frames(*hello))
            try:
                for response in self.call:
                    self.take(response)
            except grpc.RpcError:
                pass
            return self.call.code(), self.call.details()

    def was_steady(self):
        return self.welcomed_at is not None and time.monotonic() - self.welcomed_at >= STEADY_SECONDS

    def frames(self, session, settled, judged):
        """What gRPC sends, in its own thread. It asks for the next frame when the server has room."""
        yield relay.RelayRequest(hello=relay.Hello(
            session_id=session, settled_seq=settled, judged_seq=judged, agent_version=VERSION,
            schema=relay.PAYLOAD_SCHEMA_ROVER_NEXUS_0_1, declines_forwards=True,
        ))  # fmt: skip
        try:
            yield from self.batches()
        except Exception as error:
            # gRPC would log it, and end the call without the reason.
            self.trouble = error
            self.call.cancel()

    def batches(self):
        """What waits, from Welcome on."""
        while True:
            with self.news:
                self.news.wait_for(lambda: self.closed or (self.sent is not None and not self.draining))
                if self.closed:
                    return
                live = dict(self.link.live)
                batch, has_live = self.spool.batch(self.sent, time.monotonic(), list(live.values()))
                if has_live:
                    self.link.live.clear()
                if not batch:
                    if self.link.ending and not self.spool.waiting():
                        break
                    # What came too soon may be due then.
                    self.news.wait(TICK_SECONDS)
                    continue
                self.sent = batch[-1][0]
                waiting, oldest = self.spool.backlog(self.sent)
                waiting += 0 if has_live else len(live)
            uplinks = [relay.Uplink(seq=seq, rover_nexus=payload) for seq, payload in batch]
            yield relay.RelayRequest(batch=relay.UplinkBatch(
                uplinks=uplinks, sent_unix_ms=now(), backlog_uplinks=waiting, oldest_unsent_unix_ms=oldest,
            ))  # fmt: skip
        # The last frame: a server that does not know it ends the stream, when all is stored already.
        if self.link.back is not None:
            self.said_goodbye = True
            yield relay.RelayRequest(goodbye=relay.Goodbye(expected_back_unix_ms=self.link.back))
        # The half-close: the server ends the call with OK.

    def take(self, response):
        kind = response.WhichOneof("frame")
        if kind == "welcome":
            self.spool.judged(response.welcome.committed_seq)
            with self.news:
                self.sent = response.welcome.committed_seq
                self.welcomed_at = time.monotonic()
                self.news.notify_all()
        elif kind == "ack":
            self.spool.acked(response.ack.through_seq, response.ack.judged_seq)
        elif kind == "reject":
            self.reject(response.reject)
        elif kind == "notice":
            print(f"dropped: {response.notice.field!a}: {response.notice.detail!a}", file=sys.stderr)
        elif kind == "resend_request":
            self.resend(response.resend_request.kinds)
        elif kind == "drain":
            with self.news:
                self.draining = True

    def reject(self, reject):
        if reject.reason == relay.REJECT_REASON_RATE_LIMITED:
            self.spool.repeat(reject.seq, time.monotonic() + reject.retry_after_ms / 1000)
        # After that: what the spool could not take is not judged yet.
        self.spool.judged(reject.seq)
        if reject.reason != relay.REJECT_REASON_RATE_LIMITED:
            # It is kept until an Ack covers it. Repair what made it: the same bytes are rejected again.
            # A later server may have a reason without a name here; it is as final.
            known = relay.RejectReason.DESCRIPTOR.values_by_number.get(reject.reason)
            reason = known.name if known else f"reason {reject.reason}"
            print(f"rejected: {reason} {reject.field!a}: {reject.detail!a}", file=sys.stderr)

    def resend(self, kinds):
        with self.news:
            asked = [(name, self.link.snapshots.get(name)) for name in map(SNAPSHOTS.get, kinds)]
        for name, payload in asked:
            if payload is not None:
                self.link.keep(name, name, payload)


def drive(robot, link, step):
    """What the robot knows at this step. A fault is raised and cleared in turn, and each time it says so."""
    angle = math.radians(3 * step)
    latitude, longitude = 47.3769 + math.cos(angle) / 1000, 8.5417 + math.sin(angle) / 1000
    link.show("motionTelemetry", robot.motion(latitude, longitude, (90 + 3 * step) % 360, 1.2))
    link.show("statusTelemetry", robot.status(max(5, 90 - step / 10)))
    if step % 5 == 4:
        name = f"wheel-{step // 10}"
        link.keep("fault", f"fault/{name}", robot.fault(name, step % 10 == 4, f"slips at step {step}"))
        link.keep("message", f"message/{step}", robot.say(f"step {step}"))


def main():
    here = pathlib.Path(__file__).resolve().parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", default="localhost:7443", help="host and port of listen.relay")
    parser.add_argument("--pki", default="pki", help="folder with ca.crt and the robot's certificate and key")
    parser.add_argument("--name", default="r1", help="of the robot's files: NAME.crt, NAME.key")
    parser.add_argument("--spool", default="spool.db", help="file for what is not stored yet")
    parser.add_argument("--schema", default=here.parents[1] / "schema/uplink.capnp")
    parser.add_argument("--first", type=int, default=0, help="step to begin with")
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--every", type=float, default=1, help="seconds of a step")
    parser.add_argument("--parked", type=float, metavar="HOURS",
                        help="says Goodbye at its end: the robot is expected back after so long")  # fmt: skip
    options = parser.parse_args()
    link = Link(options.target, options.pki, options.name, Spool(options.spool))
    robot = Robot(options.schema)
    link.keep("agentInfo", "agentInfo", robot.agent_info())
    for step in range(options.first, options.first + options.steps):
        drive(robot, link, step)
        print(f"step {step}", flush=True)
        with link.news:
            if link.news.wait_for(lambda: link.fatal is not None, options.every):
                break
    left = link.end(None if options.parked is None else now() + round(3_600_000 * options.parked))
    if left or link.fatal is not None:
        sys.exit(f"{left} messages wait in {options.spool}{f': {link.fatal}' if link.fatal else ''}")
    print("everything is stored")


if __name__ == "__main__":
    main()
