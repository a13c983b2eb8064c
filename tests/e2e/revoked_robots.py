"""Robots that stream until the server ends each: `TARGET RURI CERTIFICATE KEY` a line of input.

Run by test_revocation_two_servers.py with the system's Python, as relay_client.py. Prints for each
robot, as JSON, how its stream ended and when, on this machine's monotonic clock. Ends with its input.
"""

import contextlib
import json
import sys
import threading
import time

import grpc
from relay_client import PATH, channel_of, hello
from uplink.v1 import relay_pb2

PRINTING = threading.Lock()


def frames(over):
    yield hello()
    over.wait()


def stream(authority, over, target, ruri, *files):
    with channel_of(target, authority, *files) as channel:
        method = channel.stream_stream(
            PATH,
            request_serializer=relay_pb2.RelayRequest.SerializeToString,
            response_deserializer=relay_pb2.RelayResponse.FromString,
        )
        call = method(frames(over))
        with contextlib.suppress(grpc.RpcError):
            list(call)
        at = time.monotonic()
        with PRINTING:
            print(json.dumps({"ruri": ruri, "at": at, "code": call.code().name, "details": call.details()}), flush=True)


def main():
    authority = sys.argv[1]
    over = threading.Event()
    for line in sys.stdin:
        threading.Thread(target=stream, args=(authority, over, *line.split()), daemon=True).start()
    over.set()


if __name__ == "__main__":
    main()
