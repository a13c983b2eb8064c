"""What tests of drones share: a drone in a process of its own, a server that takes its calls, and what that
server shows of it."""

import contextlib
import json
import os
import pathlib
import select
import socket
import sqlite3
import ssl
import struct
import subprocess
import unittest
import urllib.request

from broker_messages import quoted, rows
from drone_book import Book, rows_of
from drone_samples import request_of, sample_of, times
from harness import SOURCE, EndToEnd, run, uplinkctl, wait_until

PYTHON = "/usr/bin/python3"
HERE = pathlib.Path(__file__).parent
PROTOS = ("uplink/v1/relay.proto", "uncrew/v1/avatar.proto")
SECONDS = 60
ROOT = "rcan://local.rcan/uncrew/uav/"
# Of HTTP/2 (RFC 9113, section 6): frames and their flags.
DATA_FRAME, HEADERS_FRAME, SETTINGS_FRAME, PING_FRAME = 0, 1, 4, 6
END_HEADERS, ACK = 4, 1
SETTINGS = """[uncrew]
avatar = true
"""


class Drone:
    """A program that does what lines say: drone.py or drone.js."""

    def __init__(self, program, environment):
        self.process = subprocess.Popen(
            program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0, env={**os.environ, **environment}
        )
        self.rest = b""

    def tell(self, act, **more):
        """The answer to one line."""
        self.process.stdin.write(json.dumps({"act": act, **more}).encode() + b"\n")
        while b"\n" not in self.rest:
            ready, _, _ = select.select([self.process.stdout], [], [], SECONDS)
            came = os.read(self.process.stdout.fileno(), 1 << 16) if ready else b""
            if not came:
                raise AssertionError(f"the drone does not answer {act}: {self.process.poll()}")
            self.rest += came
        line, _, self.rest = self.rest.partition(b"\n")
        return json.loads(line)

    def close(self):
        self.process.kill()
        self.process.wait(SECONDS)
        self.process.stdin.close()
        self.process.stdout.close()


def make_modules(folder):
    """What a drone in Python needs of the contract."""
    modules = folder / "modules"
    modules.mkdir()
    run("protoc", f"--proto_path={SOURCE / 'proto'}", f"--python_out={modules}", *PROTOS)
    return modules


def python_drone(modules):
    """A drone without a connection."""
    environment = {
        "PYTHONPATH": f"{modules}:{HERE}",
        # Python's library goes on connecting only while a call waits, or as often as this says.
        "GRPC_CLIENT_CHANNEL_BACKUP_POLL_INTERVAL_MS": "50",
    }
    return Drone([PYTHON, str(HERE / "drone.py")], environment)


def certify(pki, uav):
    """The files of a drone's own certificate."""
    if not (pki / f"{uav}.crt").exists():
        uplinkctl("pki", "robot", "--dir", pki, "--name", uav, "--ruri", ROOT + uav, "--fleet", "acme")
    return files_of(pki, uav)


class DroneTest(EndToEnd):
    """Tests with drones, which are called by their ids."""

    def setUp(self):
        super().setUp()
        self.modules = make_modules(self.folder)

    def keep(self, thing):
        self.open_things.append(thing)
        return thing

    def serve(self, settings="", more=""):
        """`settings` go on in [uncrew]; `more` are sections of their own."""
        return self.server(SETTINGS + settings + more).start()

    def program(self):
        """A drone without a connection."""
        return self.keep(python_drone(self.modules))

    certify = staticmethod(certify)

    def drone(self, server, uav="d1", **more):
        """A drone with its own certificate and a connection to this server."""
        drone = self.program()
        self.lead(drone, server, uav, **more)
        return drone

    def lead(self, drone, server, uav="d1", to="server", target=None):
        """A further connection of this drone."""
        drone.tell("connect", name=to, target=target or server.relay, **self.certify(server.pki, uav))

    # What it says.

    def call(self, drone, name, sample, number=0, to="server", uav="", **more):
        """`number` gives the sample its times; None: it has no times."""
        said = {} if number is None else times(number)
        request = request_of(name, sample, {**said, "uav_id": uav})
        return drone.tell("call", to=to, type=name, request=request, **more)

    def publish(self, drone, name, number, **more):
        """The sample of this number, as drone_samples has it."""
        return self.call(drone, name, sample_of(name, number), number, **more)

    def assert_outcome(self, answer, *outcomes, **expected):
        self.assertEqual(answer["code"], "OK", answer)
        self.assertIn(answer["outcome"], outcomes, answer)
        self.assertEqual({key: answer.get(key) for key in expected}, expected, answer)

    def assert_status(self, answer, code, words=""):
        self.assertEqual(answer["code"], code, answer)
        self.assertIn(words, answer["details"])

    # What a server shows.

    def robot(self, server, uav="d1"):
        found = server.get(f"/api/v1/robots/{quoted(ROOT + uav)}")
        self.assertIsNotNone(found, f"no robot {uav}")
        return found

    def shown(self, server, uav="d1"):
        return self.robot(server, uav).get("uncrew", {})

    def history(self, server, what, uav="d1"):
        """The rows of one of its own lists, the first to come first."""
        found = rows(server, f"/api/v1/{what}?ruri={quoted(ROOT + uav)}")
        self.assertIsNotNone(found, f"no {what} of {uav}")
        return found

    def events(self, server, kind, uav="d1"):
        return [row["detail"] for row in self.history(server, "events", uav) if row["kind"] == kind]

    def listed(self, server, what, uav="d1", more=""):
        """The drone's rows of a list of all robots."""
        found = rows(server, f"/api/v1/{what}?ruri={quoted(ROOT + uav)}{more}")
        self.assertIsNotNone(found, f"no {what}")
        return found

    def series(self, server, name):
        """The values of a series of the robots, by its labels."""
        with urllib.request.urlopen(f"http://{server.http}/metrics/robots", timeout=SECONDS) as page:
            lines = page.read().decode().splitlines()
        return {line.rsplit(" ", 1)[0]: float(line.rsplit(" ", 1)[1]) for line in lines if line.startswith(name + "{")}

    def wait(self, server, condition, what, seconds=SECONDS):
        return wait_until(server.process, condition, seconds, what)

    # What a flight left.

    def land(self, drone):
        """Its book, once all that it said was answered for."""
        landed = drone.tell("land")
        self.assertEqual(landed["problems"], [])
        book = Book.load(landed["books"][""])
        self.assertEqual(book.open_samples(), [])
        return book

    def assert_stored(self, server, book, uav="d1"):
        stored = rows_of(
            self.history(server, "events", uav), self.history(server, "messages", uav),
            self.listed(server, "faults", uav), self.listed(server, "operator-requests", uav),
        )  # fmt: skip
        self.assertEqual(book.problems(stored), [])
        self.assertEqual(self.history(server, "quarantine", uav), [])


def files_of(pki, name):
    return {"ca": str(pki / "ca.crt"), "certificate": str(pki / f"{name}.crt"), "key": str(pki / f"{name}.key")}


@contextlib.contextmanager
def store_locked(server):
    """The server's SQLite store takes no writes meanwhile."""
    store = sqlite3.connect(server.folder / "uplinkd.db", timeout=SECONDS, isolation_level=None)
    try:
        store.execute("BEGIN IMMEDIATE")
        yield
    finally:
        store.close()


def frame(kind, flags, stream, payload=b""):
    """One of HTTP/2."""
    return struct.pack(">I", len(payload))[1:] + bytes([kind, flags]) + struct.pack(">I", stream) + payload


def literal(name, value):
    """A header as HPACK has it without its tables."""
    return b"".join([b"\0", *(bytes([len(text)]) + text.encode() for text in (name, value))])


def half_a_request(server, files, path):
    """Half of a message by HTTP/2 itself, which no gRPC library sends; the connection ends once the server
    has read that."""
    context = ssl.create_default_context(cafile=files["ca"])
    context.load_cert_chain(files["certificate"], files["key"])
    context.set_alpn_protocols(["h2"])
    headers = {":method": "POST", ":scheme": "https", ":path": path, ":authority": "localhost",
               "te": "trailers", "content-type": "application/grpc"}  # fmt: skip
    host, port = server.relay.rsplit(":", 1)
    with socket.create_connection((host, int(port)), timeout=SECONDS) as plain:
        with context.wrap_socket(plain, server_hostname="localhost") as link:
            link.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + frame(SETTINGS_FRAME, 0, 0))
            link.sendall(frame(HEADERS_FRAME, END_HEADERS, 1, b"".join(map(literal, *zip(*headers.items())))))
            # It says that 100 bytes follow, and 50 do.
            link.sendall(frame(DATA_FRAME, 0, 1, b"\0" + struct.pack(">I", 100) + b"x" * 50))
            link.sendall(frame(PING_FRAME, 0, 0, b"halfway."))
            wait_for_pong(link.makefile("rb"))


def wait_for_pong(came):
    while head := came.read(9):
        came.read(int.from_bytes(head[:3], "big"))
        if head[3:5] == bytes([PING_FRAME, ACK]):
            return
    raise AssertionError("the server ended the connection")


def turned_away(server):
    """The causes for which connections were ended."""
    with urllib.request.urlopen(f"http://{server.http}/metrics", timeout=SECONDS) as page:
        lines = page.read().decode().splitlines()
    found = [line for line in lines if line.startswith("uplinkd_connections_turned_away_total{")]
    return [line for line in found if not line.endswith(" 0")]
