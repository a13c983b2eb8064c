"""All that the vendor's client publishes, through a real broker to a real server."""

import base64
import collections
import json
import unittest

from broker_messages import MessageTest, numbers, quoted, rows, twin
from harness import SOURCE

VECTORS = SOURCE / "tests/conformance/cyberwave"
# What it says of itself is rejected, and yet it was heard.
HEARD_AND_REJECTED = {twin("33333333-3333-4333-8333-333333333333")}
# Of this one there are commands alone.
NEVER_HEARD = {twin("44444444-4444-4444-8444-444444444444")}


def without_arrivals(value):
    """Without the times of arrival, which are this run's own."""
    if not isinstance(value, dict):
        return value
    return {name: without_arrivals(each) for name, each in value.items() if name != "receivedAt"}


class Vectors(MessageTest):
    """All that the vendor's client published, in the order in which it was captured."""

    # As tests/conformance has them.
    PREFIXES = {"": "", "local": ".local", "site/a/": ".site%2Fa%2F"}
    # Of twins by sdk-0.7.4.state; three of environments, and three pings.
    SCOPES, PINGS = 3, 3

    def publish_all(self, server, client):
        """How many there are, and how many of them are on topics without a subscriber. A message comes once
        those of other topics have: else one connection may bring it before what another one brings."""
        lines = (VECTORS / "sdk-0.7.4.jsonl").read_text(encoding="utf-8").splitlines()
        judged = (VECTORS / "sdk-0.7.4.expected").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len(lines), len(judged))
        asked, before = 0, None
        for line, judgement in zip(map(json.loads, lines), judged, strict=True):
            if before not in (None, line["topic"]):
                self.wait(server, lambda sent=asked: numbers(server)["messages_received_total"] >= sent, "they come")
            asked, before = asked + (not judgement.startswith("other ")), line["topic"]
            payload = line["payload"] if "payload" in line else base64.b64decode(line["payload_base64"])
            # uplinkd asks for nothing above QoS 1.
            client.publish(line["topic"], payload, qos=min(line["qos"], 1), retain=line["retain"])
        client.flush()
        return len(lines), sum(line.startswith("other ") for line in judged)

    def expected(self):
        """Of sdk-0.7.4.state: outcomes, robots that are alive, records by robot, and state by robot."""
        outcomes, alive = {}, set()
        records, parts = collections.defaultdict(collections.Counter), collections.defaultdict(dict)
        for line in (VECTORS / "sdk-0.7.4.state").read_text(encoding="utf-8").splitlines():
            first, rest = line.split(" ", 1)
            if first == "alive":
                alive.add(rest.split()[0])
            elif not first.startswith("rcan:"):
                outcomes[first] = int(rest)
            elif rest.startswith(("event ", "log ", "run ")):
                record, count = rest.rsplit(" ", 1)
                records[first][record] = int(count)
            else:
                name, value = rest.split(" ", 1)
                part, dot, member = name.partition(".")
                if dot:
                    parts[first].setdefault(part, {})[member] = json.loads(value)
                else:
                    parts[first][part] = json.loads(value)
        return outcomes, alive, records, parts

    def found_records(self, server, ruri):
        found = collections.Counter()
        for each in self.history(server, ruri, "events"):
            found["event " + each["kind"]] += 1
        for each in self.history(server, ruri, "messages"):
            found["log " + each["message"]] += 1
        for each in rows(server, f"/api/v1/missions?ruri={quoted(ruri)}"):
            # Of a run the number of its reports is shown, and the last one.
            found["run " + each["runId"]] += int(each["updates"])
        return found

    def test_come_to_what_is_expected_through_a_broker(self):
        server = self.serve(self.PREFIXES, "count")
        observer = self.client("observer", "#")
        client = self.client("publisher")
        count, others = self.publish_all(server, client)
        self.assertGreater(count, 100)
        outcomes, alive, records, parts = self.expected()
        outcomes["observed"] += self.PINGS
        outcomes["stored"] += self.SCOPES
        self.assertEqual(sum(outcomes.values()) + others, count)
        self.assertEqual(self.outcomes(server, count - others), outcomes)
        # What is shown is what the lines come to one after the other.
        self.assertEqual(self.ruris(server), set(records) | set(parts) - NEVER_HEARD)
        online = {robot["ruri"] for robot in rows(server, "/api/v1/robots?presence=online")}
        self.assertEqual(online, alive | HEARD_AND_REJECTED)
        for ruri in self.ruris(server):
            with self.subTest(ruri):
                self.assertEqual(without_arrivals(self.said(server, ruri)), parts[ruri])
                wanted = collections.Counter()
                for record, number in records[ruri].items():
                    wanted[" ".join(record.split(" ")[:2]) if record.startswith("run ") else record] += number
                self.assertEqual(self.found_records(server, ruri), wanted)
        reasons = collections.Counter(row["reason"] for row in rows(server, "/api/v1/quarantine?source=cyberwave"))
        self.assertEqual(reasons, {"missing_field": 2, "text_not_utf8": 1, "malformed": 1})
        self.assertEqual(len(rows(server, "/api/v1/scope-updates?scope=environment")), self.SCOPES)
        # And nothing was published but pongs, each under the prefix of its ping.
        observer.wait(lambda: len(observer.heard) >= count + self.PINGS, "the observer hears all")
        pongs = [each.topic for each in observer.heard if "/pong/" in each.topic]
        self.assertEqual(len(observer.heard), count + self.PINGS)
        expected = {prefix + "cyberwave/pong/aaaaaaaa-aaaa-4aaa-8aaa-aaaaaaaaaaaa/response" for prefix in self.PREFIXES}
        self.assertEqual(set(pongs), expected)


if __name__ == "__main__":
    unittest.main()
