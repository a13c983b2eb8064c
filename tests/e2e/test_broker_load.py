"""Many twins, one that floods, and one with a camera: the others come through, and nothing grows."""

import json
import sqlite3
import threading
import time
import unittest

from broker_messages import (
    A, ANSWER_SECONDS, B, MessageTest, event, labelled, numbers, numbers_of, position, rows, topic, twin,
)  # fmt: skip
from broker_watch import Watch


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
        expected = [(twin(uuid), number) for number, uuid in enumerate(uuids)]
        shown = [(robot["ruri"], robot["cyberwave"]["position"]["x"]) for robot in listed]
        self.assert_same(sorted(shown), expected)
        stored = [(ruri, json.loads(detail)["data"]["n"]) for ruri, detail in self.stored()]
        self.assert_same(sorted(stored), expected)
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
    LARGE = 3_000
    # What of one id is looked into at once, at QoS 0.
    AT_ONCE_BYTES = 32 * 1024 * 1024
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
        watch = Watch([server])
        self.open_things.append(watch)
        watch.start()
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
        watch.close()
        self.assertGreater(watch.scrapes, 1)
        self.assertEqual(watch.breaches, [])
        limited = settled.pop("rejected", 0)
        # The live state of who floods, and nothing else, is limited.
        self.assertEqual(labelled(numbers(server), "rejects_total"), {"rate_limited": limited} if limited else {})
        self.assertEqual(settled, {"stored": self.DURABLE + self.OTHERS, "observed": self.OTHERS,
                                   "applied": self.LIVE - limited + self.OTHERS})  # fmt: skip
        self.assertGreater(limited, 0)
        self.assert_same(numbers_of(self.history(server, twin(A), "events")), range(self.DURABLE))
        self.assert_same(numbers_of(self.history(server, twin(B), "events")), range(1, self.OTHERS + 1))
        self.assertEqual(rows(server, "/api/v1/quarantine"), [])

    def test_large_messages_of_one_id_are_not_all_looked_into(self):
        """Of a twin that never reported: its commands make no robot, and no robot's rate holds them back."""
        server = self.serve()
        large = json.dumps({"command": "x", "data": [{}] * 15_000})
        flood = self.flood(self.client("flood"), self.LARGE, topic(A, "command"), lambda _: large, 0)
        other = self.client("other")
        for number in range(1, self.OTHERS + 1):
            other.publish(topic(B, "position"), position(number))
            self.wait(server, lambda: twin(B) in self.ruris(server) and self.x(server, twin(B)) == number,
                      f"state {number} is shown", self.SHOWN_SECONDS)  # fmt: skip
        flood.join(ANSWER_SECONDS)
        settled = self.outcomes(server, self.LARGE + self.OTHERS)
        self.assertEqual(labelled(numbers(server), "rejects_total"), {"rate_limited": settled["rejected"]})
        self.assertEqual(settled["applied"], self.OTHERS)
        self.assertGreaterEqual(settled["observed"], self.AT_ONCE_BYTES // len(large))
        self.assertGreater(settled["rejected"], 0)
        self.assertEqual(self.ruris(server), {twin(B)})
        server.wait_for_line(f"twin_limited id={A}")

    def test_what_is_stored_is_limited_only_while_the_journal_is_over_half_full(self):
        records_max = 4000
        server = self.serve(more=f"[journal]\nrecords_max = {records_max}\nrobot_share = 1\n")
        client = self.client("durable")
        # Its budget of messages is used up, and what must be stored passes all the same.
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
        published = 1000 + records_max // 2 - 100
        for number in range(1000, published):
            client.publish(topic(A, "event"), event(number))
        self.wait(server, lambda: self.received(server) == 10_000 + published, "they have come")
        self.assertEqual(self.records(server), published - 1000)
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
            self.assertLess(published, 1000 + records_max, "nothing is limited")
        store.execute("ROLLBACK")
        last = self.outcomes(server, 10_000 + lives + published)
        self.assertLess(last["stored"], published)
        self.assertGreaterEqual(last["stored"], 1000 + records_max // 2)
        self.assertEqual(labelled(numbers(server), "rejects_total"), {"rate_limited": last["rejected"]})
        self.assertNotIn("refused", last)
        shown = numbers_of(self.history(server, twin(A), "events"))
        self.assertEqual(len(shown), last["stored"])
        self.assert_same(shown, sorted(set(shown)))

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
        # It exists by what it says, not by what a camera sees.
        client.publish(topic(A, "position"), position(-1))
        self.outcomes(server, 1)
        resident = began = 0
        # As fast as they go, which is more than 30 each second.
        for number in range(self.WARM + self.FRAMES):
            if number == self.WARM:
                self.outcomes(server, 1 + 2 * number)
                resident, began = self.resident(server), time.monotonic()
            camera.publish(topic(A, "pointcloud" if number % 2 else "depth"), self.FRAME)
            client.publish(topic(A, "position"), position(number))
        total = self.WARM + self.FRAMES
        settled = self.outcomes(server, 1 + 2 * total)
        rate = self.FRAMES / (time.monotonic() - began)
        grown = self.resident(server) - resident
        print(f"media: {rate:.0f} frames/s, memory grew by {grown / 2**20:.1f} MiB")
        self.assertEqual(settled, {"applied": 1 + total, "observed": total})
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


if __name__ == "__main__":
    unittest.main()
