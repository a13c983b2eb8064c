"""An agent whose stream ends in the way that its argument says. It says `welcome` once it streams.

Run by ending_agents.py with the system's Python, as relay_client.py. It leaves when its input ends.
"""

import contextlib
import sys
import threading

import grpc
from relay_client import PATH, batch, channel_of, hello
from uplink.v1 import relay_pb2

# More than the server keeps for an agent that does not read, and than HTTP/2 has on its way.
UNREAD_MESSAGES = 4000
BATCH = 100


def call_of(channel, frames):
    method = channel.stream_stream(
        PATH,
        request_serializer=relay_pb2.RelayRequest.SerializeToString,
        response_deserializer=relay_pb2.RelayResponse.FromString,
    )
    return method(iter(frames))


def then(done, *frames):
    """These frames, and no half-close before the agent is done."""
    yield from frames
    done.wait()


def unread(done):
    yield hello()
    for first in range(1, UNREAD_MESSAGES, BATCH):
        yield batch(first, BATCH)
    done.wait()


def frames_of(act, done):
    return {
        "half_close": lambda: [hello(), batch(1, 1)],
        "second_hello": lambda: then(done, hello(), hello()),
        "large_frame": lambda: then(done, hello(), batch(1, 1, b"x" * (2 << 20))),
        "not_read": lambda: unread(done),
    }.get(act, lambda: then(done, hello()))()


def main():
    act, target, *files = sys.argv[1:]
    done = threading.Event()
    with channel_of(target, *files, options=[("grpc.http2.bdp_probe", 0)]) as channel:
        call = call_of(channel, frames_of(act, done))
        with contextlib.suppress(grpc.RpcError):
            next(call)
            print("welcome", flush=True)
            if act == "cancel":
                call.cancel()
            elif act != "not_read":
                threading.Thread(target=read_all, args=(call,), daemon=True).start()
            sys.stdin.read()
        done.set()


def read_all(call):
    with contextlib.suppress(grpc.RpcError):
        for _ in call:
            pass


if __name__ == "__main__":
    main()
