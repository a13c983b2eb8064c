"""Messages that a real broker delivers to a real server: each one lands where it belongs, and is counted."""

import base64
import json
import struct
import unittest

from broker_messages import (
    A, B, LIVE, NOON, OFFLINE, ONLINE, SECONDS, SIMULATION, VIEWER, MessageTest, event, frame, is_subscribed,
    joints, labelled, mark, numbers, numbers_of, position, rows, topic, twin,
)  # fmt: skip


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
            # A wish of others about a twin does not make it known.
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
        # A leader's joints have no series; of the others the value that came later is shown.
        sample = f'rcan_acb_position_rad{{joint="elbow",ruri="{twin(A)}"}}'
        self.assertEqual(self.series(server, sample), ["0.125"])

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

    def changes_to_offline(self, server):
        """The history of presence, once it ends so."""
        changes = self.history(server, twin(A), "presence")
        return changes if changes and changes[-1]["presence"] == OFFLINE else None

    def test_marks_of_a_viewer_wake_no_silent_twin(self):
        server = self.serve(more='presence_timeout = "5s"\n[presence]\nstartup_grace = "1ms"\n')
        client = self.client("publisher")
        client.publish(topic(A, "position"), position(1))
        client.publish(topic(A, "command"), json.dumps({"command": "arm"}))
        self.outcomes(server, 2)
        self.assertEqual(self.presence(server, twin(A)), ONLINE)
        self.wait(server, lambda: self.presence(server, twin(A)) == OFFLINE, "the silent twin is offline")
        heard = self.robot(server, twin(A))["lastSignOfLife"]
        changes = self.wait(server, lambda: self.changes_to_offline(server), "the change is stored")
        self.assertEqual(changes[0]["presence"], ONLINE)
        for kind in ("connected", "telemetry_start", "initial_observation"):
            client.publish(topic(A, "telemetry"), mark(kind, VIEWER), qos=1)
        client.publish(topic(A, "command"), json.dumps({"command": "disarm"}))
        client.publish(topic(A, "webrtc-offer"), json.dumps({"sdp": "v=0"}))
        client.publish(topic(A, "position"), position(2, "tele"))
        self.assertEqual(self.outcomes(server, 8), {"applied": 1, "observed": 4, "stored": 3})
        robot = self.robot(server, twin(A))
        self.assertEqual((robot["presence"], robot["lastSignOfLife"]), (OFFLINE, heard))
        self.assertTrue(robot["cyberwave"]["sessions"][VIEWER]["connected"])
        self.assertEqual(self.history(server, twin(A), "presence"), changes)
        # Its own word does.
        client.publish(topic(A, "position"), position(3))
        self.wait(server, lambda: self.presence(server, twin(A)) == ONLINE, "the twin that speaks is online")


class Faults(MessageTest):
    def active(self, server):
        return [row["faultId"] for row in rows(server, "/api/v1/faults?active=true")]

    def test_those_of_another_fleet_are_cleared_too(self):
        """The twins' fleet has another name after a restart; their robots are the same."""
        server = self.serve(more='fleet = "before"\n')
        client = self.client("errors")
        client.publish(topic(A, "metrics"), json.dumps({"metrics": {"errors": ["hot"]}}), qos=1)
        client.flush()
        self.outcomes(server, 1)
        self.assertEqual(self.active(server), ["hot"])
        self.assertEqual(server.terminate(SECONDS), 0)
        server.settings = server.settings.replace('"before"', '"after"')
        server.start()
        self.wait(server, lambda: is_subscribed(server), "the server subscribes")
        client.publish(topic(A, "metrics"), json.dumps({"metrics": {"errors": ["slow"]}}), qos=1)
        client.flush()
        self.outcomes(server, 1)
        self.assertEqual(self.active(server), ["slow"])


class RetainedOrMalformed(MessageTest):
    def test_what_is_retained_makes_nobody_alive(self):
        client = self.client("publisher")
        client.publish(topic(A, "position"), position(1), retain=True)
        client.publish(topic(A, "event"), event(1), qos=1, retain=True)
        client.flush()
        server = self.serve(UPLINKD_MQTT_VERSION="3.1.1")
        client.publish(topic(B, "position"), position(2))
        client.publish(topic(B, "event"), event(2), qos=1)
        # MQTT 3.1.1 has no option that asks the broker to keep them to itself.
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
            # It decodes to nothing, so no robot counts as heard.
            (topic(B, "position"), '{"source_type": "edge", "position": {"x": NaN, "y": 0, "z": 0}}'),
        ]
        for where, payload in wrong:
            client.publish(where, payload, qos=1)
        # The vendor's client writes null instead.
        client.publish(joints(A), json.dumps({"source_type": "edge", "_1": None, "_2": 0.5}))
        self.assertEqual(self.outcomes(server, 6), {"applied": 2, "rejected": 4})
        counted = numbers(server)
        self.assertEqual(labelled(counted, "rejects_total"), {"malformed": 4})
        self.assertEqual(labelled(counted, "fields_dropped_total"), {})
        status = server.get("/api/v1/status")
        heard = status["messagesBySource"]["cyberwave"]
        found = {column: count for column, count in heard["counts"].items() if count != "0"}
        self.assertEqual(found, {"received": "6", "applied": "2", "rejected": "4"})
        self.assertEqual(heard["rejectsByReason"]["malformed"], "4")
        self.assertEqual(status["messages"], heard, "nothing came by the relay")
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


if __name__ == "__main__":
    unittest.main()
