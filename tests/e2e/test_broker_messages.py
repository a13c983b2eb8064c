"""Messages that a real broker delivers to a real server: each one lands where it belongs, and is counted."""

import base64
import collections
import itertools
import json
import sqlite3
import struct
import threading
import time
import unittest
import urllib.request

from broker_messages import ANSWER_SECONDS, BrokerTest, correlation, labelled, numbers, quoted, rows
from harness import SOURCE

VECTORS = SOURCE / "tests/conformance/cyberwave"
ROOT = "rcan://local.rcan/cyberwave/"
A = "11111111-2222-4333-8444-00000000000a"
B = "11111111-2222-4333-8444-00000000000b"
C = "11111111-2222-4333-8444-00000000000c"
# A session of the vendor's client, live and of a simulation.
LIVE, SIMULATION = "driver_live_0a1b2c3d4e5f", "driver_sim_0a1b2c3d4e5f"
VIEWER = "viewer_live_0a1b2c3d4e5f"
ONLINE, OFFLINE = "PRESENCE_ONLINE", "PRESENCE_OFFLINE"
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


class MessageTest(BrokerTest):
    """What a robot's histories and parts say, in short."""

    def x(self, server, ruri):
        return self.said(server, ruri).get("position", {}).get("x")

    def presence(self, server, ruri):
        return self.robot(server, ruri)["presence"]

    def history(self, server, ruri, what):
        found = rows(server, f"/api/v1/robots/{quoted(ruri)}/{what}")
        self.assertIsNotNone(found, f"no {what} of {ruri}")
        return found

    def ruris(self, server):
        return {robot["ruri"] for robot in rows(server, "/api/v1/robots")}


class Prefixes(MessageTest):
    def test_one_twin_is_a_robot_of_its_own_under_each_prefix(self):
        prefixes = {"": "", "site/": ".site%2F", "site": ".site", "site/b/": ".site%2Fb%2F"}
        server = self.serve(prefixes)
        client = self.client("publisher")
        for number, prefix in enumerate(prefixes):
            client.publish(topic(A, "position", prefix), position(number))
            client.publish(topic(A, "event", prefix), event(number), qos=1)
            client.publish(topic(A, "position", prefix), position(-1 - number, "sim"))
        self.assertEqual(self.outcomes(server, 12), {"applied": 8, "stored": 4})
        expected = {twin(A, kind + name) for name in prefixes.values() for kind in ("twin", "sim")}
        self.assertEqual(self.ruris(server), expected)
        for number, name in enumerate(prefixes.values()):
            self.assertEqual(self.x(server, twin(A, "twin" + name)), number)
            self.assertEqual(self.x(server, twin(A, "sim" + name)), -1 - number)
            self.assertEqual(numbers_of(self.history(server, twin(A, "twin" + name), "events")), [number])
            self.assertEqual(self.history(server, twin(A, "sim" + name), "events"), [])

    def test_topics_under_other_prefixes_are_not_taken(self):
        server = self.serve(("site/",))
        client = self.client("publisher")
        # Among them those that begin or end as the known one does.
        for prefix in ("", "site", "sit", "site/b/", "b/site/", "/site/", "Site/", "$site/"):
            client.publish(topic(A, "position", prefix), position(1))
            client.publish(topic(A, "event", prefix), event(1), qos=1)
        # Below the known prefix, and no topics that anybody asked for.
        for tail in ("positions", "position/", "position/x", "map_update", "webrtc-command"):
            client.publish(topic(A, tail, "site/"), position(1))
        # What the same connections deliver last.
        client.publish(topic(B, "position", "site/"), position(2))
        client.publish(topic(B, "event", "site/"), event(2), qos=1)
        self.assertEqual(self.outcomes(server, 2), {"applied": 1, "stored": 1})
        self.assertEqual(self.ruris(server), {twin(B, "twin.site%2F")})
        self.assertEqual(rows(server, "/api/v1/quarantine"), [])


class Sources(MessageTest):
    def test_setpoints_beside_states_are_counted_and_change_no_state(self):
        server = self.serve()
        client = self.client("publisher")
        client.publish(joints(A), json.dumps({"source_type": "edge", "positions": {"_1": 0.5, "_2": 0.25}}))
        both = {"source_type": "edge", "positions": {"_1": 0.75}, "target_positions": {"_1": 9, "_3": 9}}
        client.publish(joints(A), json.dumps(both))
        client.publish(joints(A), json.dumps({"source_type": "tele", "positions": {"_2": 9}}))
        client.publish(joints(A), json.dumps({"source_type": "edit", "_2": 9}))
        client.publish(topic(A, "position"), position(9, "tele"))
        for uuid in (A, B):
            # Such a twin does not exist by what others want of it.
            client.publish(topic(uuid, "position"), position(9, "sim_tele"))
        client.publish(joints(B), json.dumps({"source_type": "tele", "target_positions": {"_1": 9}}))
        client.publish(topic(B, "command"), json.dumps({"command": "arm"}))
        self.assertEqual(self.outcomes(server, 9), {"applied": 2, "observed": 7})
        self.assertEqual(self.ruris(server), {twin(A)})
        said = self.said(server, twin(A))
        shown = {name: joint["position"] for name, joint in said["joints"]["edge"].items()}
        self.assertEqual(shown, {"_1": 0.75, "_2": 0.25})
        self.assertEqual(list(said["joints"]), ["edge"])
        self.assertNotIn("position", said)
        # Each value that was wanted of a joint: two beside what is measured, and one of each commander.
        self.assertEqual(said["observed"], {"joint/update": 2, "twin/position": 1, "setpoints": 4})

    def test_leader_and_follower_are_kept_apart(self):
        server = self.serve()
        client = self.client("publisher")
        for source, value in (("edge_leader", 0.5), ("edge_follower", 0.25), ("edge", 0.125)):
            state = {"position": value, "velocity": -value}
            said = {"source_type": source, "joint_name": "elbow", "joint_state": state}
            client.publish(joints(A), json.dumps(said))
        # What it does not say of the joint stays.
        more = {"source_type": "edge_leader", "joint_name": "elbow", "joint_state": {"position": 0.75}}
        client.publish(joints(A), json.dumps(more))
        self.assertEqual(self.outcomes(server, 4), {"applied": 4})
        shown = {
            source: (table["elbow"]["position"], table["elbow"]["velocity"])
            for source, table in self.said(server, twin(A))["joints"].items()
        }
        expected = {"edge_leader": (0.75, -0.5), "edge_follower": (0.25, -0.25), "edge": (0.125, -0.125)}
        self.assertEqual(shown, expected)

    def test_a_simulation_is_a_robot_beside_the_real_one(self):
        server = self.serve()
        client = self.client("publisher")
        client.publish(topic(A, "position"), position(1))
        client.publish(topic(A, "position"), position(2, "sim"))
        client.publish(joints(A), json.dumps({"source_type": "edge", "_1": 0.5}))
        client.publish(joints(A), json.dumps({"source_type": "sim", "_1": 0.25}))
        # Without a source its session says whose it is.
        client.publish(topic(A, "event"), event(1, session_id=LIVE), qos=1)
        client.publish(topic(A, "event"), event(2, session_id=SIMULATION), qos=1)
        client.publish(topic(B, "position"), position(3, None, session_id=SIMULATION))
        self.assertEqual(self.outcomes(server, 7), {"applied": 5, "stored": 2})
        self.assertEqual(self.ruris(server), {twin(A), twin(A, "sim"), twin(B, "sim")})
        for ruri, source, x, joint, number in (
            (twin(A), "edge", 1, 0.5, 1),
            (twin(A, "sim"), "sim", 2, 0.25, 2),
        ):
            said = self.said(server, ruri)
            self.assertEqual(said["position"]["x"], x)
            self.assertEqual(list(said["joints"]), [source])
            self.assertEqual(said["joints"][source]["_1"]["position"], joint)
            self.assertEqual(numbers_of(self.history(server, ruri, "events")), [number])
            self.assertEqual(self.presence(server, ruri), ONLINE)
        self.assertEqual(self.x(server, twin(B, "sim")), 3)

    def test_marks_of_a_simulation_are_of_the_simulated_robot_and_no_life(self):
        server = self.serve()
        client = self.client("publisher")
        client.publish(topic(A, "position"), position(1))
        client.publish(topic(A, "telemetry"), mark("connected", LIVE), qos=1)
        client.publish(topic(A, "telemetry"), mark("connected", SIMULATION), qos=1)
        client.publish(topic(A, "telemetry"), mark("telemetry_start", SIMULATION), qos=1)
        client.publish(topic(A, "telemetry"), mark("disconnected", SIMULATION), qos=1)
        self.assertEqual(self.outcomes(server, 5), {"applied": 1, "stored": 4})
        self.assertEqual(list(self.said(server, twin(A))["sessions"]), [LIVE])
        self.assertTrue(self.said(server, twin(A))["sessions"][LIVE]["connected"])
        said = self.said(server, twin(A, "sim"))["sessions"]
        self.assertEqual(list(said), [SIMULATION])
        self.assertEqual((said[SIMULATION]["connected"], said[SIMULATION]["telemetry"]), (False, False))
        kinds = [each["kind"] for each in self.history(server, twin(A, "sim"), "events")]
        self.assertEqual(kinds, ["cyberwave/connected", "cyberwave/telemetry_start", "cyberwave/disconnected"])
        self.assertEqual(self.presence(server, twin(A)), ONLINE)
        self.assertNotEqual(self.presence(server, twin(A, "sim")), ONLINE)


class Clients(MessageTest):
    def test_two_clients_of_one_twin_have_clocks_of_their_own(self):
        server = self.serve()
        ahead, behind = self.client("ahead"), self.client("behind")
        ahead.publish(topic(A, "position"), position(1, timestamp=NOON, session_id="a"))
        self.outcomes(server, 1)
        # An hour behind, and yet the latest that came.
        behind.publish(topic(A, "position"), position(2, timestamp=NOON - 3600, session_id="b"))
        self.assertEqual(self.outcomes(server, 2), {"applied": 2})
        self.assertEqual(self.x(server, twin(A)), 2)
        for client, session in ((ahead, "a"), (behind, "b")):
            client.publish(topic(A, "telemetry"), mark("connected", session), qos=1)
            client.flush()
        behind.publish(topic(A, "telemetry"), mark("disconnected", "b"), qos=1)
        self.assertEqual(self.outcomes(server, 5), {"applied": 2, "stored": 3})
        sessions = self.said(server, twin(A))["sessions"]
        self.assertEqual({name: each["connected"] for name, each in sessions.items()}, {"a": True, "b": False})

    def test_late_state_of_one_session_is_superseded(self):
        server = self.serve()
        client = self.client("publisher")
        for x, at in ((1, NOON), (2, NOON - 1), (3, NOON + 1), (4, NOON + 0.5)):
            client.publish(topic(A, "position"), position(x, timestamp=at, session_id=LIVE))
        for name, value, at in (("_1", 1, NOON), ("_1", 2, NOON - 1), ("_2", 3, NOON - 1)):
            said = {"source_type": "edge", "timestamp": at, "positions": {name: value}, "session_id": LIVE}
            client.publish(joints(A), json.dumps(said))
        self.assertEqual(self.outcomes(server, 7), {"applied": 4, "superseded": 3})
        self.assertEqual(self.x(server, twin(A)), 3)
        shown = {name: each["position"] for name, each in self.said(server, twin(A))["joints"]["edge"].items()}
        self.assertEqual(shown, {"_1": 1, "_2": 3})
        self.assertEqual(self.history(server, twin(A), "quarantine"), [])

    def test_marks_of_a_viewer_wake_no_silent_twin(self):
        server = self.serve(more='presence_timeout = "20s"\n[presence]\nstartup_grace = "1ms"\n')
        client = self.client("publisher")
        client.publish(topic(A, "position"), position(1))
        client.publish(topic(A, "command"), json.dumps({"command": "arm"}))
        self.outcomes(server, 2)
        self.assertEqual(self.presence(server, twin(A)), ONLINE)
        self.wait(server, lambda: self.presence(server, twin(A)) == OFFLINE, "the silent twin is offline")
        heard = self.robot(server, twin(A))["lastSignOfLifeMs"]
        for kind in ("connected", "telemetry_start", "initial_observation"):
            client.publish(topic(A, "telemetry"), mark(kind, VIEWER), qos=1)
        client.publish(topic(A, "command"), json.dumps({"command": "disarm"}))
        client.publish(topic(A, "webrtc-offer"), json.dumps({"sdp": "v=0"}))
        client.publish(topic(A, "position"), position(2, "tele"))
        self.assertEqual(self.outcomes(server, 8), {"applied": 1, "observed": 4, "stored": 3})
        robot = self.robot(server, twin(A))
        self.assertEqual((robot["presence"], robot["lastSignOfLifeMs"]), (OFFLINE, heard))
        self.assertTrue(robot["cyberwave"]["sessions"][VIEWER]["connected"])
        changes = [each["presence"] for each in self.history(server, twin(A), "presence")]
        self.assertEqual(changes, [ONLINE, OFFLINE])
        # Its own word does.
        client.publish(topic(A, "position"), position(3))
        self.wait(server, lambda: self.presence(server, twin(A)) == ONLINE, "the twin that speaks is online")


class Odd(MessageTest):
    def test_what_is_retained_makes_nobody_alive(self):
        client = self.client("publisher")
        client.publish(topic(A, "position"), position(1), retain=True)
        client.publish(topic(A, "event"), event(1), qos=1, retain=True)
        client.flush()
        server = self.serve(UPLINKD_MQTT_VERSION="3.1.1")
        client.publish(topic(B, "position"), position(2))
        client.publish(topic(B, "event"), event(2), qos=1)
        # By 3.1.1 nobody can ask the broker to keep them to itself.
        self.assertEqual(self.outcomes(server, 4), {"applied": 1, "ignored": 2, "stored": 1})
        self.assertEqual(self.ruris(server), {twin(B)})

    def test_by_mqtt_5_what_is_retained_is_not_sent(self):
        client = self.client("publisher")
        client.publish(topic(A, "position"), position(1), retain=True)
        client.publish(topic(A, "event"), event(1), qos=1, retain=True)
        client.flush()
        server = self.serve()
        client.publish(topic(B, "position"), position(2))
        client.publish(topic(B, "event"), event(2), qos=1)
        self.assertEqual(self.outcomes(server, 2), {"applied": 1, "stored": 1})
        self.assertEqual(self.ruris(server), {twin(B)})

    def test_nan_is_rejected_and_state_stays(self):
        server = self.serve()
        client = self.client("publisher")
        client.publish(topic(A, "position"), position(1))
        wrong = [
            (topic(A, "position"), '{"source_type": "edge", "position": {"x": NaN, "y": 0, "z": 0}}'),
            (joints(A), '{"source_type": "edge", "_1": -Infinity}'),
            (topic(A, "event"), '{"event_type": "step", "data": {"n": NaN}}'),
            # It decodes to nothing, so nobody is heard.
            (topic(B, "position"), '{"source_type": "edge", "position": {"x": NaN, "y": 0, "z": 0}}'),
        ]
        for where, payload in wrong:
            client.publish(where, payload, qos=1)
        # The vendor's client writes null instead.
        client.publish(joints(A), json.dumps({"source_type": "edge", "_1": None, "_2": 0.5}))
        self.assertEqual(self.outcomes(server, 6), {"applied": 2, "rejected": 4})
        found = numbers(server)
        self.assertEqual(labelled(found, "rejects_total"), {"malformed": 4})
        self.assertEqual(labelled(found, "fields_dropped_total"), {})
        listed = rows(server, "/api/v1/quarantine?source=cyberwave")
        found = [(row["topic"], int(row["payloadBytes"]), row["reason"]) for row in listed]
        self.assertCountEqual(found, [(where, len(payload), "malformed") for where, payload in wrong])
        # In a second one payload of a reason is kept.
        kept = {base64.b64decode(row["payload"]).decode() for row in listed} - {""}
        self.assertTrue(kept)
        self.assertLessEqual(kept, {payload for _, payload in wrong})
        self.assertEqual(self.x(server, twin(A)), 1)
        self.assertEqual(list(self.said(server, twin(A))["joints"]["edge"]), ["_2"])
        self.assertEqual(self.history(server, twin(A), "events"), [])
        online = {robot["ruri"] for robot in rows(server, "/api/v1/robots?presence=online")}
        self.assertEqual(online, {twin(A)})

    def test_frames_of_the_bridge_are_events_if_they_hold_json(self):
        server = self.serve()
        client = self.client("publisher")
        good = event(7).encode()
        wrong = [
            (frame(good, "application/octet-stream"), "malformed"),
            (frame(b"{"), "malformed"),
            (frame(b'"\xff"'), "text_not_utf8"),
            (frame(b"[]"), "type_mismatch"),
            # A head that says it is longer than the frame is, and a frame that is cut off.
            (struct.pack("<I", 1000) + frame(good)[4:], "malformed"),
            (frame(good)[:30], "malformed"),
        ]
        client.publish(topic(A, "event"), frame(good), qos=1)
        for payload, _ in wrong:
            client.publish(topic(A, "event"), payload, qos=1)
        client.publish(topic(A, "event"), event(8), qos=1)
        self.assertEqual(self.outcomes(server, 2 + len(wrong)), {"stored": 2, "rejected": len(wrong)})
        events = self.history(server, twin(A), "events")
        self.assertEqual(numbers_of(events), [7, 8])
        self.assertEqual({each["kind"] for each in events}, {"cyberwave/step"})
        listed = self.history(server, twin(A), "quarantine")
        found = [(int(row["payloadBytes"]), row["reason"]) for row in listed]
        self.assertEqual(found, [(len(payload), reason) for payload, reason in wrong])


class Vectors(MessageTest):
    """All that the vendor's client published, in the order in which it was captured."""

    # As tests/conformance has them.
    PREFIXES = {"": "", "local": ".local", "site/a/": ".site%2Fa%2F"}
    # Of twins by sdk-0.7.4.state; three of environments, and three pings.
    SCOPES, PINGS = 3, 3

    def publish_all(self, client):
        """How many there are, and how many of them are on topics that nobody asks for."""
        lines = (VECTORS / "sdk-0.7.4.jsonl").read_text(encoding="utf-8").splitlines()
        judged = (VECTORS / "sdk-0.7.4.expected").read_text(encoding="utf-8").splitlines()
        self.assertEqual(len(lines), len(judged))
        for line in map(json.loads, lines):
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
        count, others = self.publish_all(client)
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


# What it says of itself is rejected, and yet it was heard.
HEARD_AND_REJECTED = {twin("33333333-3333-4333-8333-333333333333")}
# Of this one there are commands alone.
NEVER_HEARD = {twin("44444444-4444-4444-8444-444444444444")}


def without_arrivals(value):
    """Without the times of arrival, which are this run's own."""
    if not isinstance(value, dict):
        return value
    return {name: without_arrivals(each) for name, each in value.items() if name != "receivedAtMs"}


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
            properties = correlation(data) + b"\x08\x00\x0belsewhere/x"
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


class Many(MessageTest):
    TWINS = 10_000

    def stored(self):
        store = sqlite3.connect(f"file:{self.folder}/uplinkd.db?mode=ro", uri=True)
        try:
            return store.execute("SELECT ruri, detail FROM events WHERE kind = 'cyberwave/step'").fetchall()
        finally:
            store.close()

    def test_ten_thousand_twins_are_listed_and_stored_once(self):
        server = self.serve()
        client = self.client("publisher")
        before = set(numbers(server))
        uuids = [f"00000000-2222-4333-8444-{number:012}" for number in range(self.TWINS)]
        for number, uuid in enumerate(uuids):
            client.publish(topic(uuid, "position"), position(number))
            client.publish(topic(uuid, "event"), event(number), qos=1)
        client.flush()
        self.assertEqual(self.outcomes(server, 2 * self.TWINS), {"applied": self.TWINS, "stored": self.TWINS})
        listed = rows(server, "/api/v1/robots?parts=cyberwave")
        self.assertEqual([robot["ruri"] for robot in reversed(listed)], [twin(uuid) for uuid in uuids])
        shown = {robot["ruri"]: robot["cyberwave"]["position"]["x"] for robot in listed}
        self.assertEqual(shown, {twin(uuid): number for number, uuid in enumerate(uuids)})
        stored = [(ruri, json.loads(detail)["data"]["n"]) for ruri, detail in self.stored()]
        self.assertCountEqual(stored, [(twin(uuid), number) for number, uuid in enumerate(uuids)])
        found = numbers(server)
        self.assertEqual(found["twins"], self.TWINS)
        # No sample has a twin's name, whatever their number.
        self.assertLess(len(set(found) - before), 20)
        self.assertFalse([name for name in found if "-2222-4333-" in name])
        # No more than robots_max: one more is told, and what it wanted stored is kept where one looks for it.
        client.publish(topic(A, "position"), position(1))
        client.publish(topic(A, "event"), event(1), qos=1)
        after = self.outcomes(server, 2 * self.TWINS + 2)
        self.assertEqual(after, {"applied": self.TWINS, "stored": self.TWINS, "refused": 1, "rejected": 1})
        self.assertEqual([row["reason"] for row in rows(server, "/api/v1/quarantine")], ["too_many_items"])
        self.wait(server, lambda: "twins_max" in server.get("/readyz")["degraded"], "it is said to be full")


class Flood(MessageTest):
    LIVE, DURABLE, OTHERS = 60_000, 20_000, 30
    SHOWN_SECONDS = 30

    def flood(self, client, count, where, payload, qos):
        def run():
            for number in range(count):
                client.publish(where, payload(number), qos)

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        self.addCleanup(thread.join)
        return thread

    def test_a_flood_of_one_twin_delays_no_other_and_loses_nothing(self):
        server = self.serve()
        floods = [
            self.flood(self.client("live"), self.LIVE, topic(A, "position"), position, 0),
            self.flood(self.client("durable"), self.DURABLE, topic(A, "event"), event, 1),
        ]
        other = self.client("other", "cyberwave/pong/+/response")
        during, longest = 0, 0
        for number in range(1, self.OTHERS + 1):
            began = time.monotonic()
            during += any(thread.is_alive() for thread in floods)
            other.publish(topic(B, "position"), position(number))
            other.publish(topic(B, "event"), event(number), qos=1)
            other.publish(f"cyberwave/ping/other-{number}/request", '{"type": "ping"}')
            other.wait(lambda: len(other.heard) >= number, f"pong {number}")
            self.wait(
                server, lambda: twin(B) in self.ruris(server) and self.x(server, twin(B)) == number,
                f"state {number} is shown", self.SHOWN_SECONDS,
            )  # fmt: skip
            longest = max(longest, time.monotonic() - began)
        print(f"beside a flood: {during} of {self.OTHERS} states and pongs, the slowest in {longest:.2f} s")
        self.assertGreater(during, 0)
        for thread in floods:
            thread.join(ANSWER_SECONDS)
        everything = self.LIVE + self.DURABLE + 3 * self.OTHERS
        settled = self.outcomes(server, everything)
        limited = settled.pop("rejected", 0)
        # The live state of who floods, and nothing else, is limited.
        self.assertEqual(labelled(numbers(server), "rejects_total"), {"rate_limited": limited} if limited else {})
        self.assertEqual(settled, {"stored": self.DURABLE + self.OTHERS, "observed": self.OTHERS,
                                   "applied": self.LIVE - limited + self.OTHERS})  # fmt: skip
        self.assertGreater(limited, 0)
        self.assertEqual(numbers_of(self.history(server, twin(A), "events")), list(range(self.DURABLE)))
        self.assertEqual(numbers_of(self.history(server, twin(B), "events")), list(range(1, self.OTHERS + 1)))
        self.assertEqual(rows(server, "/api/v1/quarantine"), [])

    def test_what_is_stored_is_limited_only_while_the_journal_is_over_half_full(self):
        records_max = 4000
        server = self.serve(more=f"[journal]\nrecords_max = {records_max}\nrobot_share = 1\n")
        client = self.client("durable")
        # Its messages are used up, and what is to be stored passes all the same.
        for number in range(10_000):
            client.publish(topic(A, "position"), position(number))
        for number in range(1000):
            client.publish(topic(A, "event"), event(number))
        first = self.outcomes(server, 11_000)
        self.assertEqual(first["stored"], 1000)
        self.assertGreater(first["rejected"], 0)
        # A store that cannot be written.
        store = sqlite3.connect(self.folder / "uplinkd.db", isolation_level=None)
        self.addCleanup(store.close)
        store.execute("BEGIN IMMEDIATE")
        published = 1000
        while self.records(server) <= records_max // 2:
            client.publish(topic(A, "event"), event(published))
            published += 1
            if published % 500 == 0:
                self.wait(server, lambda: self.received(server) == 10_000 + published, "they have come")
        self.assertEqual(self.limited(server), first["rejected"])
        # So many at once that the bucket is empty, which refills by 1,000 each second.
        lives = 0
        while self.limited(server) == first["rejected"] or self.stored_or_waiting(server) == published:
            for _ in range(2000):
                client.publish(topic(A, "position"), position(lives))
                lives += 1
            for _ in range(100):
                client.publish(topic(A, "event"), event(published))
                published += 1
            self.wait(server, lambda: self.received(server) == 10_000 + lives + published, "they have come")
            self.assertLess(published, records_max, "nothing is limited")
        store.execute("ROLLBACK")
        last = self.outcomes(server, 10_000 + lives + published)
        self.assertLess(last["stored"], published)
        self.assertGreaterEqual(last["stored"], 1000 + records_max // 2)
        self.assertEqual(labelled(numbers(server), "rejects_total"), {"rate_limited": last["rejected"]})
        self.assertNotIn("refused", last)
        shown = numbers_of(self.history(server, twin(A), "events"))
        self.assertEqual(len(shown), last["stored"])
        self.assertEqual(shown, sorted(set(shown)))

    def records(self, server):
        return int(server.get("/api/v1/status")["journalRecords"])

    def received(self, server):
        return numbers(server)["messages_received_total"]

    def limited(self, server):
        return labelled(numbers(server), "rejects_total").get("rate_limited", 0)

    def stored_or_waiting(self, server):
        found = numbers(server)
        return found.get("messages_settled_total stored", 0) + found["messages_in_flight"]


class Media(MessageTest):
    FRAME = b"\x5a" * 800_000
    FRAMES, WARM = 150, 15
    GROWN_BYTES = 16 << 20

    def resident(self, server):
        with open(f"/proc/{server.process.pid}/status", encoding="utf-8") as status:
            return next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmRSS:"))

    def test_frames_beside_state_are_counted_and_take_no_memory(self):
        server = self.serve(media="count")
        client, camera = self.client("publisher"), self.client("camera")
        began = 0
        resident = 0
        # As fast as they go, which is more than 30 each second.
        for number in range(self.WARM + self.FRAMES):
            if number == self.WARM:
                self.outcomes(server, 2 * number)
                resident, began = self.resident(server), time.monotonic()
            camera.publish(topic(A, "pointcloud" if number % 2 else "depth"), self.FRAME)
            client.publish(topic(A, "position"), position(number))
        total = self.WARM + self.FRAMES
        settled = self.outcomes(server, 2 * total)
        rate = self.FRAMES / (time.monotonic() - began)
        grown = self.resident(server) - resident
        print(f"media: {rate:.0f} frames/s, memory grew by {grown / 2**20:.1f} MiB")
        self.assertEqual(settled, {"applied": total, "observed": total})
        self.assertLess(grown, self.GROWN_BYTES)
        said = self.said(server, twin(A))
        self.assertEqual(said["position"]["x"], total - 1)
        half = total // 2
        self.assertEqual(said["media"], {
            "depth": {"messages": total - half, "bytes": (total - half) * len(self.FRAME)},
            "pointcloud": {"messages": half, "bytes": half * len(self.FRAME)},
        })  # fmt: skip
        self.assertEqual(numbers(server)["payload_bytes_total media"], total * len(self.FRAME))
        self.assertEqual(rows(server, "/api/v1/quarantine"), [])

    def test_without_media_none_are_asked_for(self):
        server = self.serve()
        client = self.client("publisher")
        client.publish(topic(A, "depth"), self.FRAME, qos=1)
        client.publish(topic(A, "pointcloud"), self.FRAME, qos=1)
        client.publish(topic(A, "position"), position(1))
        client.publish(topic(A, "event"), event(1), qos=1)
        self.assertEqual(self.outcomes(server, 2), {"applied": 1, "stored": 1})
        self.assertNotIn("media", self.said(server, twin(A)))
