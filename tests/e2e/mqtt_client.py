"""A client by MQTT 5, on its own: it publishes, and keeps what its filters match."""

import collections
import socket
import threading

from mqtt_publishers import CONNECT, PUBACK, field, packet

PUBLISH, SUBSCRIBE = 0x30, 0x82
VERSION_5 = b"\x05"
CLEAN_START, PASSWORD, USER_NAME = 0x02, 0x40, 0x80
NO_KEEPALIVE = b"\x00\x00"
NO_PROPERTIES = b"\x00"
CORRELATION_DATA, RESPONSE_TOPIC = b"\x09", b"\x08"
# For an hour without a connection.
SESSION_EXPIRY = b"\x11" + (3600).to_bytes(4, "big")
QOS, RETAIN = 0x06, 0x01
# Messages at QoS 1 that wait for their PUBACK.
WINDOW = 1000
ANSWER_SECONDS = 30
# Reason codes of refusals begin here.
REFUSED = 0x80

Publication = collections.namedtuple("Publication", "topic payload retain properties")
# How somebody comes to a broker that takes not everybody; `tls` is an ssl.SSLContext.
Login = collections.namedtuple("Login", "tls username password")


def correlation(data):
    """The properties of a message with this correlation data."""
    return CORRELATION_DATA + field(data)


def response_topic(topic):
    return RESPONSE_TOPIC + field(topic.encode())


def connect_packet(name, clean_start, login):
    flags, properties = (CLEAN_START, b"") if clean_start else (0, SESSION_EXPIRY)
    payload = field(name.encode())
    if login:
        flags |= USER_NAME | PASSWORD
        payload += field(login.username.encode()) + field(login.password.encode())
    head = field(b"MQTT") + VERSION_5 + bytes([flags]) + NO_KEEPALIVE + bytes([len(properties)]) + properties
    return packet(CONNECT, head + payload)


class Client:
    """By MQTT 5. It publishes, and keeps what its filters match; ConnectionError once the broker has ended
    it. Without a clean start it goes on with a session that is kept, and acks nothing of it. Thread-safe.
    """

    def __init__(self, port, name, *filters, clean_start=True, login=None):
        self.heard = []
        self.next_id = 0
        # What is done when the broker acks, by packet id.
        self.unacked = {}
        self.wrong = None
        self.changed = threading.Condition()
        self.socket = socket.create_connection(("127.0.0.1", port), ANSWER_SECONDS)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if login:
            self.socket = login.tls.wrap_socket(self.socket, server_hostname="localhost")
        self.stream = self.socket.makefile("rb")
        self.socket.sendall(connect_packet(name, clean_start, login))
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
                        self.take_ack(body)
                    else:
                        raise ConnectionError(f"no PUBLISH and no PUBACK: {first:#x} {body!r}")
                    self.changed.notify_all()
        except (OSError, ValueError, KeyError) as error:
            with self.changed:
                self.wrong = error
                self.changed.notify_all()

    def take_ack(self, body):
        if body[2:3] and body[2] >= REFUSED:
            raise ConnectionError(f"the broker refuses what was published: {body!r}")
        self.unacked.pop(int.from_bytes(body[:2], "big"))()

    def is_connected(self):
        """Whether the broker has it still."""
        with self.changed:
            return self.wrong is None

    def wait(self, condition, what):
        """For something that the broker says."""
        with self.changed:
            done = self.changed.wait_for(lambda: self.wrong or condition(), ANSWER_SECONDS)
            if self.wrong:
                raise ConnectionError(f"{self.wrong} while waiting: {what}")
            assert done, f"not within {ANSWER_SECONDS} s: {what}"

    def publish(self, topic, payload, qos=0, retain=False, properties=b"", acked=lambda: None):
        """`acked` is called, on a thread of the client's, when the broker has acked it."""
        if isinstance(payload, str):
            payload = payload.encode()
        packet_id = b""
        if qos:
            self.wait(lambda: len(self.unacked) < WINDOW, "the broker acks what was published")
            self.next_id = self.next_id % 0xFFFF + 1
            packet_id = self.next_id.to_bytes(2, "big")
            with self.changed:
                self.unacked[self.next_id] = acked
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
    """A PUBLISH, as it came."""
    end = 2 + int.from_bytes(body[:2], "big")
    # Behind the packet id, if it has one. Properties of more than 127 bytes are not expected.
    size_at = end + 2 if first & QOS else end
    start = size_at + 1 + body[size_at]
    return Publication(body[2:end].decode(), body[start:], bool(first & RETAIN), body[size_at + 1 : start])
