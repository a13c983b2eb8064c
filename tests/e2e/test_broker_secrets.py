"""What others negotiate by a broker is secret: uplinkd counts it, and keeps and shows none of it."""

import base64
import json
import unittest
import urllib.request

from broker_messages import A, ANSWER_SECONDS, B, MessageTest, frame, position, quoted, rows, topic, twin
from mqtt_client import correlation


def shapes(text):
    """As it is, by UTF-16, and as base64 shows it: three shapes, by how many bytes are before it."""
    data = text.encode()
    coded = []
    for before in range(3):
        whole = base64.b64encode(b"x" * before + data)
        # The characters that consist only of its bits.
        coded.append(whole[-(-8 * before // 6) : 8 * (before + len(data)) // 6])
    return [data, text.encode("utf-16-le"), text.encode("utf-16-be"), *coded]


class Secrets(MessageTest):
    """What others negotiate by the broker, and what uplinkd says there."""

    # Of each kind of secret: what no place may show, whole or in part.
    SECRET = "s3cr3t"
    # What the search must find, so that it is known to work.
    PLAIN = "pl41n"
    PATHS = ("/livez", "/readyz", "/metrics", "/metrics/robots", "/api/v1/status", "/api/v1/robots",
             "/api/v1/robots?parts=motion,status,extras,health,usage,consumables,directives,agentInfo,settings,"
             "uiCapabilities,rcanState,cyberwave", "/api/v1/quarantine", "/api/v1/scope-updates",
             "/api/v1/faults", "/api/v1/missions", "/api/v1/shapes", "/api/v1/objects")  # fmt: skip
    OF_ROBOT = ("events", "messages", "presence", "quarantine", "gaps")

    def read_ones(self):
        """Topics that uplinkd reads, with payloads good and not, and a secret in each."""
        sdp = f"v=0 a=ice-pwd:{self.SECRET}0 a=fingerprint:{self.SECRET}1"
        offer = json.dumps({"type": "offer", "sdp": sdp, "source_type": "edge"})
        ice = json.dumps({"candidate": f"candidate:1 1 udp 1 {self.SECRET}2 9 typ host"})
        login = json.dumps({"command": "login", "data": {"password": self.SECRET, "token": self.SECRET}})
        found = []
        for tail, good in (("webrtc-offer", offer), ("webrtc-answer", offer), ("webrtc-candidate", ice),
                           ("command", login), ("navigate/command", login)):  # fmt: skip
            payloads = [good, good[:-1], f"[{good}]", good.encode() + b"\xff", good.encode("utf-16"),
                        good.replace(": ", ": NaN, ", 1), f'"{self.SECRET}"', self.SECRET,
                        good.ljust(70_000), frame(good.encode())]  # fmt: skip
            found += [(topic(uuid, tail), payload) for uuid in self.ids() for payload in payloads]
        # What is said of a field that is not as it must be could quote it.
        fields = [{"command": {self.SECRET: self.SECRET}}, {"status": [self.SECRET]}, {"timestamp": self.SECRET},
                  {"command": f"\0{self.SECRET}" * 1000}, {self.SECRET: {self.SECRET: 1}}]  # fmt: skip
        for payload in map(json.dumps, fields):
            found += [(topic(uuid, tail), payload) for uuid in self.ids() for tail in ("command", "webrtc-offer")]
        for tail in ("depth", "pointcloud"):
            found += [(topic(uuid, tail), f"{{{self.SECRET}") for uuid in self.ids()]
        return found

    def ids(self):
        """Of a twin that is heard, of one that is not, and what is no id."""
        return A, B, f"{self.SECRET}-uuid"

    def unread_ones(self):
        """The same on topics that uplinkd does not read."""
        offer = json.dumps({"type": "offer", "sdp": self.SECRET})
        tails = ("webrtc-command", "webrtc-offer/x", "auth", "credentials")
        others = (f"cyberwave/auth/{A}/request", f"cyberwave/ping/{A}/response", f"cyberwave/token/{A}")
        return [(where, offer) for where in (*(topic(A, tail) for tail in tails), *others)]

    def places(self, server, store):
        """All texts that somebody could read, by where they are."""
        yield "the log", server.text().encode()
        for path in sorted(store.parent.glob(store.name + "*")):
            yield path.name, path.read_bytes()
        paths = list(self.PATHS)
        for ruri in self.ruris(server):
            paths.append(f"/api/v1/robots/{quoted(ruri)}")
            paths += [f"/api/v1/{name}?ruri={quoted(ruri)}" for name in self.OF_ROBOT]
        for path in paths:
            mark = "&" if "?" in path else "?"
            more = f"{mark}pageSize=1000" if path.partition("?")[0].endswith(("events", "messages", "quarantine", "faults")) else ""
            with urllib.request.urlopen(f"http://{server.http}{path}{more}", timeout=ANSWER_SECONDS) as answer:
                yield path, answer.read()

    def found(self, server, text):
        store = self.folder / "uplinkd.db"
        return [where for where, content in self.places(server, store)
                if any(shape in content for shape in shapes(text))]  # fmt: skip

    def test_no_signalling_and_no_credential_is_kept_or_shown(self):
        password = self.folder / "password"
        password.write_text(self.SECRET + "-mqtt\n", encoding="utf-8")
        server = self.serve(
            media="count", UPLINKD_LOG_LEVEL="debug", UPLINKD_MQTT_USERNAME="uplinkd",
            UPLINKD_MQTT_PASSWORD_FILE=str(password),
        )
        observer = self.client("observer", "#")
        client = self.client("publisher")
        client.publish(topic(A, "position"), position(1))
        client.publish(topic(A, "event"), json.dumps({"event_type": self.PLAIN}), qos=1)
        client.publish(topic(A, "driverlog"), f"{{{self.PLAIN}", qos=1)
        self.outcomes(server, 3)
        read, published = self.read_ones(), self.read_ones() + self.unread_ones()
        for qos in (0, 1):
            for where, payload in published:
                client.publish(where, payload, qos, properties=correlation(self.SECRET.encode()))
        client.flush()
        settled = self.outcomes(server, 3 + 2 * len(read))
        self.assertGreater(settled["observed"], 100)
        self.assertGreater(settled["rejected"], 100)
        # The plain one is found where it belongs, in an event and in the payload of a rejected line.
        seen = self.found(server, self.PLAIN)
        self.assertTrue(any(where.startswith("uplinkd.db") for where in seen), seen)
        self.assertIn(f"/api/v1/events?ruri={quoted(twin(A))}", seen)
        self.assertIn("/api/v1/quarantine", seen)
        self.assertNotIn("the log", seen)
        self.assertEqual(self.found(server, self.SECRET), [])
        # That they came is shown.
        self.assertIn("twin/webrtc-offer", self.said(server, twin(A))["observed"])
        listed = rows(server, "/api/v1/quarantine")
        self.assertIn(topic("?", "webrtc-offer"), {row["topic"] for row in listed})
        # After an orderly end, with the connections' ends in the log and all of the store in its file.
        self.assertEqual(server.terminate(ANSWER_SECONDS), 0)
        for path in (server.log, *self.folder.glob("uplinkd.db*")):
            content = path.read_bytes()
            self.assertFalse([shape for shape in shapes(self.SECRET) if shape in content], path)
        # And the server has published nothing.
        count = 3 + 2 * len(published)
        observer.wait(lambda: len(observer.heard) >= count, "the observer hears all")
        self.assertEqual(len(observer.heard), count)


class TheSearch(unittest.TestCase):
    def test_finds_a_text_in_base64_wherever_it_begins(self):
        for before in range(6):
            shown = base64.b64encode(b"a" * before + b"s3cr3t and more")
            self.assertTrue(any(shape in shown for shape in shapes("s3cr3t")), shown)
            self.assertFalse(any(shape in shown for shape in shapes("pl41n")), shown)


if __name__ == "__main__":
    unittest.main()
