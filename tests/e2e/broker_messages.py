"""What tests of a broker's messages share: how twins publish, a server that reads it, and what that server
says of what came.
"""

import itertools
import json
import re
import struct
import urllib.parse
import urllib.request

from harness import EndToEnd, wait_until
from mosquitto import Mosquitto
from mqtt_client import Client

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
ROOT = "rcan://local.rcan/cyberwave/"
A = "11111111-2222-4333-8444-00000000000a"
B = "11111111-2222-4333-8444-00000000000b"
# Sessions of the vendor's clients: of a live one, of a simulation, of somebody who watches.
LIVE, SIMULATION = "driver_live_0a1b2c3d4e5f", "driver_sim_0a1b2c3d4e5f"
VIEWER = "viewer_live_0a1b2c3d4e5f"
ONLINE, OFFLINE = "online", "offline"
NOON = 1795262400.0


def twin(uuid, kind="twin"):
    return f"{ROOT}{kind}/{uuid}"


def topic(uuid, tail, prefix=""):
    return f"{prefix}cyberwave/twin/{uuid}/{tail}"


def joints(uuid):
    return f"cyberwave/joint/{uuid}/update"


def position(x, source="edge", **more):
    said = {"source_type": source, "position": {"x": x, "y": 0, "z": 0}, **more}
    return json.dumps({name: value for name, value in said.items() if value is not None})


def event(number, **more):
    return json.dumps({"event_type": "step", "data": {"n": number}, **more})


def mark(kind, session):
    return json.dumps({"type": kind, "session_id": session, "timestamp": NOON})


def frame(content, content_type="application/json"):
    """As the vendor's bridge passes on what a worker made."""
    header = json.dumps({"content_type": content_type}).encode()
    head = struct.pack("<dq", NOON, 0) + header
    return struct.pack("<I", len(head)) + head + content


def numbers_of(events):
    return [each["detail"]["data"]["n"] for each in events]


class MessageTest(EndToEnd):
    """With a broker of its own, and what a server says of the robots that it reads there."""

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
        self.wait(server, lambda: is_subscribed(server, media == "count"), "the server subscribes")
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

    def assert_same(self, found, expected):
        """Of long lists, which unittest would compare for minutes: it shows the first that differs."""
        for place, (one, other) in enumerate(itertools.zip_longest(found, expected)):
            if one != other:
                self.fail(f"{len(found)} and {len(expected)}: at {place} {one!r} is not {other!r}")

    def robot(self, server, ruri):
        found = server.get(f"/api/v1/robots/{quoted(ruri)}")
        self.assertIsNotNone(found, f"no robot {ruri}")
        return found

    def said(self, server, ruri):
        """The state of a twin, as it shows."""
        return self.robot(server, ruri).get("cyberwave", {})

    def x(self, server, ruri):
        return self.said(server, ruri).get("position", {}).get("x")

    def presence(self, server, ruri):
        return self.robot(server, ruri)["presence"]

    def history(self, server, ruri, what):
        found = rows(server, f"/api/v1/{what}?ruri={quoted(ruri)}")
        self.assertIsNotNone(found, f"no {what} of {ruri}")
        return found

    def series(self, server, sample):
        """The values of a sample of the robots' series."""
        with urllib.request.urlopen(f"http://{server.http}/metrics/robots", timeout=ANSWER_SECONDS) as page:
            lines = page.read().decode().splitlines()
        return [line.rsplit(" ", 1)[1] for line in lines if line.startswith(sample + " ")]

    def ruris(self, server):
        return {robot["ruri"] for robot in rows(server, "/api/v1/robots")}


def connection(server, name):
    """What the status says of this connection to the broker."""
    connections = ((server.get("/api/v1/status") or {}).get("mqtt") or {}).get("connections", [])
    return next((each for each in connections if each["name"] == name), {})


def is_subscribed(server, media=False):
    names = ["durable", "live"] + media * ["media"]
    return all(connection(server, name).get("state") == "subscribed" for name in names)


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
