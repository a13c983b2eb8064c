"""A server at a broker that takes not everybody: deploy/mosquitto as it stands there, with TLS, passwords and
the list of who may write what."""

import json
import socket
import ssl
import unittest

from broker_messages import A, B, ONLINE, MessageTest, event, is_subscribed, labelled, numbers, numbers_of, position
from broker_messages import connection, topic, twin
from harness import SOURCE, run, uplinkctl
from mosquitto import Mosquitto
from mqtt_client import ANSWER_SECONDS, CLEAN_START, NO_KEEPALIVE, PASSWORD, USER_NAME, Client, Login
from mqtt_publishers import CONNECT, PUBACK, PUBLISH_QOS1, field, packet

MQTT = """[mqtt]
url = "mqtts://localhost:{port}"
username = "uplinkd"
password_file = "{folder}/uplinkd.password"
ca_file = "{ca}"
{more}
[cyberwave]
"""
DEPLOYED = SOURCE / "deploy/mosquitto"
UPLINKDS_OWN = "uplinkd's own"
DISCONNECT = 0xE0
# Who watches the broker, and what it is there for.
MONITOR, DROPPED = "monitor", "$SYS/broker/publish/messages/dropped"


class Deployed(Mosquitto):
    """By the configuration that is delivered: only paths, port and the process's user are the test's."""

    def __init__(self, folder, pki):
        super().__init__(folder)
        text = (DEPLOYED / "mosquitto.conf").read_text(encoding="utf-8")
        for what, there in (
            ("listener 8883", f"listener {self.port} 127.0.0.1"),
            ("/etc/mosquitto/certs/server.crt", str(pki / "server.crt")),
            ("/etc/mosquitto/certs/server.key", str(pki / "server.key")),
            ("/etc/mosquitto/passwords", str(self.folder / "passwords")),
            ("/etc/mosquitto/acl", str(DEPLOYED / "acl")),
            ("/var/lib/mosquitto/", f"{self.folder}/"),
        ):
            assert what in text, f"{what} stands in mosquitto.conf"
            text = text.replace(what, there)
        self.configuration.write_text(text + "user root\n", encoding="utf-8")
        (self.folder / "passwords").touch(mode=0o600)

    def allow(self, user, password):
        run("mosquitto_passwd", "-b", self.folder / "passwords", user, password)


class Access(MessageTest):
    def setUp(self):
        super().setUp()
        self.broker.close()
        # A server that is never started: its PKI is the broker's too.
        self.pki = self.server().pki
        self.broker = self.keep(Deployed(self.make("deployed"), self.pki))
        self.broker.allow("uplinkd", UPLINKDS_OWN)
        for user in (A, B, MONITOR):
            self.broker.allow(user, user)
        self.broker.start()
        self.tls = ssl.create_default_context(cafile=str(self.pki / "ca.crt"))

    def keep(self, thing):
        self.open_things.append(thing)
        return thing

    def make(self, name):
        folder = self.folder / name
        folder.mkdir()
        return folder

    def robot_client(self, uuid, *filters):
        """As a robot comes: its name is its twin's."""
        return self.keep(Client(self.broker.port, f"robot-{uuid}", *filters, login=Login(self.tls, uuid, uuid)))

    def begin(self, more="", ca=None, password=UPLINKDS_OWN):
        (self.folder / "uplinkd.password").write_text(password + "\n", encoding="utf-8")
        settings = MQTT.format(port=self.broker.port, folder=self.folder, ca=ca or self.pki / "ca.crt", more=more)
        return self.server(settings).start()

    def go_through(self, more):
        server = self.begin(more)
        self.wait(server, lambda: is_subscribed(server), "the server subscribes")
        robot = self.robot_client(A, f"cyberwave/pong/{A}/response")
        for number in range(10):
            robot.publish(topic(A, "event"), event(number), qos=1)
        robot.publish(topic(A, "position"), position(7))
        robot.publish(f"cyberwave/ping/{A}/request", json.dumps({"type": "ping"}))
        robot.flush()
        self.outcomes(server, 12)
        robot.wait(lambda: robot.heard, "the pong")
        self.assertEqual(self.presence(server, twin(A)), ONLINE)
        self.assertEqual(self.x(server, twin(A)), 7)
        self.assertEqual(numbers_of(self.history(server, twin(A), "events")), list(range(10)))
        self.assertEqual(numbers(server)["unacked durable"], 0)

    def test_a_robot_is_heard_by_mqtt_5(self):
        self.go_through("")

    def test_a_robot_is_heard_by_mqtt_3_1_1(self):
        self.go_through('version = "3.1.1"')

    def test_a_robot_cannot_speak_for_another_one(self):
        server = self.begin()
        self.wait(server, lambda: is_subscribed(server), "the server subscribes")
        robot = self.robot_client(A)
        robot.publish(topic(B, "position"), position(1))
        robot.publish(f"cyberwave/joint/{B}/update", json.dumps({"joint": 1}))
        robot.publish("cyberwave/environment/e/metrics", "{}")
        # What follows says that the others have come to nothing.
        robot.publish(topic(A, "position"), position(2))
        self.assertEqual(self.outcomes(server, 1), {"applied": 1})
        self.assertEqual(self.ruris(server), {twin(A)})

    def test_who_watches_the_broker_reads_its_numbers_alone(self):
        monitor = self.robot_client(MONITOR, "cyberwave/#", DROPPED)
        monitor.wait(lambda: monitor.heard, "how many messages were dropped")
        # And no other client reads them. What follows says that nothing else has come.
        robot = self.robot_client(A, "cyberwave/#", DROPPED)
        robot.publish(topic(A, "event"), event(1), qos=1)
        robot.wait(lambda: robot.heard, "its own event")
        self.assertEqual([heard.topic for heard in robot.heard], [topic(A, "event")])
        for name in (f"twin/{MONITOR}/event", f"joint/{MONITOR}/update", f"ping/{MONITOR}/request"):
            monitor.publish(f"cyberwave/{name}", "{}")
        monitor.publish(topic(A, "event"), event(2), qos=1)
        with self.assertRaisesRegex(ConnectionError, "refuses what was published"):
            monitor.flush()
        self.assertEqual({heard.topic for heard in monitor.heard}, {DROPPED})

    def answer_to(self, version, size):
        """The first byte of what the broker says to an event of so many bytes at QoS 1; empty if it ends the
        connection instead."""
        properties = b"\x00" if version == b"\x05" else b""
        head = field(b"MQTT") + version + bytes([CLEAN_START | USER_NAME | PASSWORD]) + NO_KEEPALIVE + properties
        login = field(b"large") + field(A.encode()) * 2
        body = field(topic(A, "event").encode()) + b"\x00\x01" + properties + b"x" * size
        with socket.create_connection(("127.0.0.1", self.broker.port), ANSWER_SECONDS) as plain:
            with self.tls.wrap_socket(plain, server_hostname="localhost") as broker:
                broker.sendall(packet(CONNECT, head + login))
                broker.recv(1000)
                try:
                    broker.sendall(packet(PUBLISH_QOS1, body))
                    return broker.recv(1)
                except OSError:
                    return b""

    def test_what_is_too_large_is_not_acked(self):
        for version in (b"\x05", b"\x04"):
            with self.subTest(version):
                self.assertEqual(self.answer_to(version, 1024 * 1024), bytes([PUBACK]))
                self.assertIn(self.answer_to(version, 3 * 1024 * 1024), (bytes([DISCONNECT]), b""))

    def refused(self, server, word):
        """The server says why it is not connected, and goes on trying."""

        def look():
            durable = connection(server, "durable")
            return durable if word in durable.get("lastError", "") else None

        found = self.wait(server, look, f"the last error has {word}")
        self.assertNotEqual(found["state"], "subscribed")
        self.assertIn("mqtt_away", server.get("/readyz")["degraded"])
        self.wait(server, lambda: labelled(numbers(server), "connections_ended_total"), "the end is counted")
        self.assertNotIn(UPLINKDS_OWN, server.text())

    def test_a_wrong_password_is_named(self):
        server = self.begin(password="not " + UPLINKDS_OWN)
        self.refused(server, "not authorized")
        # The file is read again at each connection.
        (self.folder / "uplinkd.password").write_text(UPLINKDS_OWN, encoding="utf-8")
        self.wait(server, lambda: is_subscribed(server), "the server subscribes")

    def test_a_broker_of_another_authority_gets_no_password(self):
        foreign = self.folder / "foreign"
        uplinkctl("pki", "init", "--dir", foreign)
        self.refused(self.begin(ca=foreign / "ca.crt"), "certificate")


if __name__ == "__main__":
    unittest.main()
