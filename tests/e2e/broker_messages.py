"""What tests of a broker's messages share: clients of a mosquitto, a server that reads it, and what that
server says of what came.
"""

import collections
import re
import socket
import threading
import urllib.parse
import urllib.request

from harness import EndToEnd, wait_until
from mosquitto import Mosquitto
from mqtt_publishers import CONNECT, PUBACK, field, packet

PUBLISH, SUBSCRIBE = 0x30, 0x82
VERSION_5, CLEAN_START = b"\x05", b"\x02"
NO_KEEPALIVE = b"\x00\x00"
NO_PROPERTIES = b"\x00"
CORRELATION_DATA = b"\x09"
QOS, RETAIN = 0x06, 0x01
# Messages at QoS 1 that wait for their PUBACK.
WINDOW = 1000
ANSWER_SECONDS = 30
# Until the server has taken what was published.
SECONDS = 60
SETTINGS = """[mqtt]
url = "mqtt://127.0.0.1:{port}"
[cyberwave]
topic_prefixes = [{prefixes}]
media = "{media}"
"""
SAMPLE = re.compile(r"^uplinkd_mqtt_([a-z_]+)(?:\{([^}]*)\})? (\S+)$", re.MULTILINE)
LABEL = re.compile(r'"([^"]*)"')

Heard = collections.namedtuple("Heard", "topic payload retain properties")


def correlation(data):
    """The properties of a message with this correlation data."""
    return CORRELATION_DATA + field(data)


class Client:
    """By MQTT 5. It publishes, and keeps what its filters match. Thread-safe."""

    def __init__(self, port, name, *filters):
        self.heard = []
        self.next_id = 0
        self.unacked = set()
        self.wrong = None
        self.changed = threading.Condition()
        self.socket = socket.create_connection(("127.0.0.1", port), ANSWER_SECONDS)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.stream = self.socket.makefile("rb")
        self.socket.sendall(
            packet(
                CONNECT,
                field(b"MQTT") + VERSION_5 + CLEAN_START + NO_KEEPALIVE + NO_PROPERTIES + field(name.encode()),
            )
        )
        _, body = self.read_packet()
        assert body[1] == 0, f"the broker refuses {name}: {body!r}"
        if filters:
            asked = b"".join(field(each.encode()) + b"\x00" for each in filters)
            self.socket.sendall(packet(SUBSCRIBE, b"\x00\x01" + NO_PROPERTIES + asked))
            _, body = self.read_packet()
            assert not any(body[-len(filters) :]), f"the broker refuses filters of {name}: {body!r}"
        self.socket.settimeout(None)
        self.thread = threading.Thread(target=self.read, daemon=True)
        self.thread.start()

    def read_exactly(self, size):
        data = self.stream.read(size)
        if len(data) < size:
            raise ConnectionError("the broker ended the connection")
        return data

    def read_packet(self):
        first = self.read_exactly(1)[0]
        size = shift = 0
        while True:
            digit = self.read_exactly(1)[0]
            size |= (digit & 0x7F) << shift
            shift += 7
            if digit < 0x80:
                return first, self.read_exactly(size)

    def read(self):
        try:
            while True:
                first, body = self.read_packet()
                with self.changed:
                    if first & 0xF0 == PUBLISH:
                        self.heard.append(heard_of(first, body))
                    elif first & 0xF0 == PUBACK:
                        self.unacked.discard(int.from_bytes(body[:2], "big"))
                    else:
                        raise ConnectionError(f"no PUBLISH and no PUBACK: {first:#x} {body!r}")
                    self.changed.notify_all()
        except (OSError, ValueError) as error:
            with self.changed:
                self.wrong = error
                self.changed.notify_all()

    def wait(self, condition, what):
        """For something that the broker says."""
        with self.changed:
            done = self.changed.wait_for(lambda: self.wrong or condition(), ANSWER_SECONDS)
            if self.wrong:
                raise AssertionError(f"{self.wrong} while waiting: {what}")
            assert done, f"not within {ANSWER_SECONDS} s: {what}"

    def publish(self, topic, payload, qos=0, retain=False, properties=b""):
        if isinstance(payload, str):
            payload = payload.encode()
        packet_id = b""
        if qos:
            self.wait(lambda: len(self.unacked) < WINDOW, "the broker acks what was published")
            self.next_id = self.next_id % 0xFFFF + 1
            packet_id = self.next_id.to_bytes(2, "big")
            with self.changed:
                self.unacked.add(self.next_id)
        head = field(topic.encode()) + packet_id + bytes([len(properties)]) + properties
        self.socket.sendall(packet(PUBLISH | qos << 1 | retain, head + payload))

    def flush(self):
        """Until the broker has acked all that was published at QoS 1."""
        self.wait(lambda: not self.unacked, "the broker acks what was published")

    def close(self):
        try:
            self.socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        self.thread.join(ANSWER_SECONDS)
        self.stream.close()
        self.socket.close()


def heard_of(first, body):
    """A PUBLISH at QoS 0, as it came."""
    assert not first & QOS
    end = 2 + int.from_bytes(body[:2], "big")
    # Properties of more than 127 bytes are not expected.
    size = body[end]
    start = end + 1 + size
    return Heard(body[2:end].decode(), body[start:], bool(first & RETAIN), body[end + 1 : start])


class BrokerTest(EndToEnd):
    """With a broker of its own."""

    def setUp(self):
        super().setUp()
        self.broker = Mosquitto(self.folder)
        self.open_things.append(self.broker)
        self.broker.start()

    def client(self, name, *filters):
        client = Client(self.broker.port, name, *filters)
        self.open_things.append(client)
        return client

    def serve(self, prefixes=("",), media="off", more="", **environment):
        """A server that has subscribed. `more` goes on in [cyberwave]."""
        named = ", ".join(f'"{prefix}"' for prefix in prefixes)
        settings = SETTINGS.format(port=self.broker.port, prefixes=named, media=media) + more
        server = self.server(settings)
        server.environment = environment
        server.start()
        connections = 3 if media == "count" else 2
        wait_until(
            server.process, lambda: server.text().count("mqtt_subscribed") == connections, SECONDS,
            "the server subscribes",
        )  # fmt: skip
        return server

    def wait(self, server, condition, what, seconds=SECONDS):
        return wait_until(server.process, condition, seconds, what)

    def outcomes(self, server, received, seconds=SECONDS):
        """What became of the messages, once so many have come and none of them is in flight."""

        def look():
            found = numbers(server)
            return found if found["messages_received_total"] >= received and not found["messages_in_flight"] else None

        found = self.wait(server, look, f"{received} messages are settled", seconds)
        self.assertEqual(found["messages_received_total"], received)
        settled = labelled(found, "messages_settled_total")
        self.assertEqual(sum(settled.values()), received)
        return settled

    def robot(self, server, ruri):
        found = server.get(f"/api/v1/robots/{quoted(ruri)}")
        self.assertIsNotNone(found, f"no robot {ruri}")
        return found

    def said(self, server, ruri):
        """The state of a twin, as it shows."""
        return self.robot(server, ruri).get("cyberwave", {})


def numbers(server):
    """The samples of what comes from the broker: `name`, or `name label`."""
    with urllib.request.urlopen(f"http://{server.http}/metrics", timeout=ANSWER_SECONDS) as page:
        text = page.read().decode()
    return {
        " ".join([name, *LABEL.findall(labels)]): float(value) for name, labels, value in SAMPLE.findall(text)
    }


def labelled(found, name):
    """The samples of a name that are not zero, by label."""
    return {
        key.partition(" ")[2]: int(value) for key, value in found.items() if key.startswith(name + " ") and value
    }


def quoted(ruri):
    return urllib.parse.quote(ruri, safe="")


def rows(server, path):
    """All rows of a list, the first to come first; nothing while the server cannot be reached."""
    found, token = [], ""
    while True:
        mark = "&" if "?" in path else "?"
        answer = server.get(f"{path}{mark}pageSize=1000" + (f"&pageToken={quoted(token)}" if token else ""))
        if answer is None:
            return None
        found += next(value for value in answer.values() if isinstance(value, list))
        token = answer.get("nextPageToken", "")
        if not token:
            return found[::-1]
