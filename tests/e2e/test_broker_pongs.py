"""What uplinkd publishes: a pong for each ping, and nothing else."""

import collections
import json
import time
import unittest

from broker_messages import A, ANSWER_SECONDS, VIEWER, MessageTest, event, mark, numbers, position, topic
from mqtt_client import correlation, response_topic


class Pings(MessageTest):
    PINGS = 50
    # Of one name; in any second.
    OF_NAME_MAX = 10

    def test_each_ping_has_its_pong(self):
        server = self.serve(("", "site/"))
        client = self.client("pinger", "cyberwave/pong/+/response", "site/cyberwave/pong/+/response", "elsewhere/#")
        took = []
        for number in range(self.PINGS):
            prefix = "site/" if number % 2 else ""
            # As long as a name may be, and spelled as it comes.
            name = f"Front-{number}".ljust(128, "x") if number % 3 else f"Front-{number}"
            data = number.to_bytes(4, "big")
            # A response topic is not followed.
            properties = correlation(data) + response_topic("elsewhere/x")
            before, began = time.time(), time.monotonic()
            client.publish(f"{prefix}cyberwave/ping/{name}/request", '{"type": "ping"}', properties=properties)
            client.wait(lambda: len(client.heard) > number, f"pong {number}")
            took.append(time.monotonic() - began)
            pong = client.heard[number]
            self.assertEqual(pong.topic, f"{prefix}cyberwave/pong/{name}/response")
            self.assertEqual((pong.properties, pong.retain), (correlation(data), False))
            said = json.loads(pong.payload)
            self.assertEqual(list(said), ["type", "timestamp"])
            self.assertEqual(said["type"], "pong")
            # It says its clock by the millisecond.
            self.assertTrue(before - 0.001 <= said["timestamp"] <= time.time(), said)
        took.sort()
        print(f"pongs: p50 {1000 * took[len(took) // 2]:.2f} ms, most {1000 * took[-1]:.2f} ms")
        self.assertEqual(self.outcomes(server, self.PINGS), {"observed": self.PINGS})
        self.assertEqual(server.metric("uplinkd_mqtt_pongs_total"), self.PINGS)
        self.assertEqual(len(client.heard), self.PINGS)
        self.assertEqual(self.ruris(server), set())

    def test_pings_that_are_none_or_too_many_have_no_pong(self):
        server = self.serve()
        client = self.client("pinger", "cyberwave/pong/#")
        wrong = [("x" * 129, '{"type": "ping"}'), ("front", "ping"), ("front", "{}"), ("front", "[]")]
        for name, payload in wrong:
            client.publish(f"cyberwave/ping/{name}/request", payload)
        self.assertEqual(self.outcomes(server, len(wrong)), {"rejected": len(wrong)})
        began = time.monotonic()
        for _ in range(self.PINGS):
            client.publish("cyberwave/ping/front/request", '{"type": "ping"}')
        client.publish("cyberwave/ping/last/request", '{"type": "ping"}')
        last = "cyberwave/pong/last/response"
        client.wait(lambda: client.heard and client.heard[-1].topic == last, "the pong of another name")
        seconds = time.monotonic() - began
        pongs = len(client.heard) - 1
        self.assertGreaterEqual(pongs, self.OF_NAME_MAX)
        self.assertLessEqual(pongs, self.OF_NAME_MAX * (1 + int(seconds)))
        self.outcomes(server, len(wrong) + self.PINGS + 1)
        found = numbers(server)
        self.assertEqual(found["pongs_total"], pongs + 1)
        self.assertEqual(found["pongs_withheld_total"], self.PINGS - pongs)


class Published(MessageTest):
    def test_nothing_but_pongs_is_published(self):
        server = self.serve(("", "site/"), "count")
        observer = self.client("observer", "#")
        client = self.client("publisher")
        said = []
        for prefix in ("", "site/"):
            for tail, payload in (("position", position(1)), ("event", event(1)), ("command", '{"command": "arm"}'),
                                  ("webrtc-offer", '{"sdp": "v=0"}'), ("telemetry", mark("connected", VIEWER)),
                                  ("depth", "x"), ("event", "{")):  # fmt: skip
                said += [(topic(A, tail, prefix), payload.encode(), qos) for qos in (0, 1)]
            said.append((f"{prefix}cyberwave/ping/{A}/request", b'{"type": "ping"}', 0))
        for where, payload, qos in said:
            client.publish(where, payload, qos)
        self.outcomes(server, len(said))
        # A client of the broker's that comes last hears what was retained, if anything was.
        late = self.client("late", "#")
        self.assertEqual(server.terminate(ANSWER_SECONDS), 0)
        client.publish("the/last", "one")
        observer.wait(lambda: observer.heard and observer.heard[-1].topic == "the/last", "the last one")
        late.wait(lambda: late.heard and late.heard[-1].topic == "the/last", "the last one")
        self.assertEqual([each.topic for each in late.heard], ["the/last"])
        heard = collections.Counter((each.topic, each.payload) for each in observer.heard[:-1])
        heard -= collections.Counter((where, payload) for where, payload, _ in said)
        self.assertEqual(
            sorted(where for where, _ in heard.elements()),
            sorted(f"{prefix}cyberwave/pong/{A}/response" for prefix in ("", "site/")),
        )


if __name__ == "__main__":
    unittest.main()
