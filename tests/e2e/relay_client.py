"""An agent in another language: Python's gRPC library, of Debian, against a relay.

Run by test_clients.py with the system's Python, which has that library. Does what its argument says
and prints what it saw as JSON. PYTHONPATH holds what protoc made of relay.proto.
"""

import json
import pathlib
import sys
import threading

import grpc
from uplink.v1 import relay_pb2

PATH = "/uplink.v1.UplinkRelay/Relay"
# A wait that does not end is the test's failure, not its end.
PATIENCE_SECONDS = 30
SESSION = bytes(range(16))
MESSAGES = 1000
BATCH = 100
EVENT = pathlib.Path(__file__).parents[1] / "conformance/vectors/eventTelemetry-min.bin"


def read(path):
    with open(path, "rb") as file:
        return file.read()


def channel_of(target, authority, certificate, key, options=()):
    credentials = grpc.ssl_channel_credentials(read(authority), read(key), read(certificate))
    names = (("grpc.ssl_target_name_override", "localhost"),)
    return grpc.secure_channel(target, credentials, names + tuple(options))


def hello(**fields):
    return relay_pb2.RelayRequest(
        hello=relay_pb2.Hello(
            **{"session_id": SESSION, "schema": relay_pb2.PAYLOAD_SCHEMA_ROVER_NEXUS_0_1, **fields}
        )
    )


def batch(first, count, payload=b"x"):
    uplinks = [relay_pb2.Uplink(seq=seq, rover_nexus=payload) for seq in range(first, first + count)]
    return relay_pb2.RelayRequest(batch=relay_pb2.UplinkBatch(uplinks=uplinks))


def call_of(channel, frames, path=PATH, **options):
    method = channel.stream_stream(
        path,
        request_serializer=relay_pb2.RelayRequest.SerializeToString,
        response_deserializer=relay_pb2.RelayResponse.FromString,
    )
    return method(iter(frames), timeout=PATIENCE_SECONDS, **options)


def stream(channel):
    """A thousand unreadable messages, and a half-close: each is rejected, and all settle."""
    batches = [batch(first, BATCH) for first in range(1, MESSAGES + 1, BATCH)]
    call = call_of(channel, [hello(), *batches])
    frames = list(call)
    return {
        "first": frames[0].WhichOneof("frame"),
        "ruri": frames[0].welcome.robot_ruri,
        "rejects": sum(frame.HasField("reject") for frame in frames),
        "through": max((frame.ack.through_seq for frame in frames if frame.HasField("ack")), default=0),
        **ended(call),
    }


def resume(channel, last):
    """A session that a store knows, by an agent that lost all it was told: sends its last number and a new one."""
    call = call_of(channel, [hello(), batch(last, 2, EVENT.read_bytes())])
    frames = list(call)
    return {
        "committed": frames[0].welcome.committed_seq,
        "rejects": [frame.reject.seq for frame in frames if frame.HasField("reject")],
        "through": max((frame.ack.through_seq for frame in frames if frame.HasField("ack")), default=0),
        **ended(call),
    }


def ended(call):
    return {"code": call.code().name, "details": call.details()}


def held(channel):
    """A stream that the robot keeps open until the server ends it."""
    over = threading.Event()

    def frames():
        yield hello()
        over.wait(PATIENCE_SECONDS)

    try:
        return refused(channel, frames())
    finally:
        over.set()


def refused(channel, frames, **options):
    call = call_of(channel, frames, **options)
    try:
        list(call)
    except grpc.RpcError:
        pass
    return ended(call)


ACTS = {
    "stream": stream,
    "resume": resume,
    "held": held,
    "wrong_hello": lambda channel: refused(channel, [hello(session_id=b"short")]),
    "refused": lambda channel: refused(channel, [hello()]),
    "for_robot": lambda channel: refused(channel, [hello(robot_ruri="rcan://example.org/acme/rover/g1")]),
    "other_robot": lambda channel: refused(channel, [hello(robot_ruri="rcan://example.org/ä/100%")]),
    "large_frame": lambda channel: refused(channel, [hello(), batch(1, 1, b"x" * (2 << 20))]),
    "other_method": lambda channel: refused(channel, [], path="/uplink.v1.UplinkRelay/Other"),
    "compressed": lambda channel: refused(channel, [hello()], compression=grpc.Compression.Gzip),
}


def main():
    act, target, authority, certificate, key, *numbers = sys.argv[1:]
    with channel_of(target, authority, certificate, key) as channel:
        print(json.dumps(ACTS[act](channel, *map(int, numbers))))


if __name__ == "__main__":
    main()
