"""Robots as they change, by server-sent events."""

import json
import pathlib
import unittest

from events import Events
from harness import BIN, EndToEnd, run, uplinkctl, wait_until

WAIT_SECONDS = 60
ROBOTS = 4


class Watch(EndToEnd):
    def test_a_snapshot_then_what_changes(self):
        server = self.server('[presence]\ntimeout = "3s"').start()
        fleet = self.fleet(server, "--robots", ROBOTS)
        server.wait_for_status(lambda status: status["robots"].get("online") == str(ROBOTS), WAIT_SECONDS, "robots are here")
        with Events(server.http) as events:
            self.assertEqual(events.answer.status, 200)
            self.assertEqual(events.answer.headers.get_content_type(), "text/event-stream")
            robots = events.snapshot()
            self.assertEqual(len(robots), ROBOTS)
            one = sorted(robots)[0]
            self.assertEqual(robots[one]["presence"], "online")
            self.assertIn("motion", robots[one])
            fleet.finish()
            gone = events.until(lambda name, data: name == "robot" and data["robot"]["presence"] == "offline")
            self.assertIsNotNone(gone)
        wait_until(server.process, lambda: server.metric("uplinkd_watches") == 0, WAIT_SECONDS, "the watch ends")

    def test_a_filter_tells_who_matches_no_more(self):
        server = self.server('[presence]\ntimeout = "3s"').start()
        fleet = self.fleet(server, "--robots", ROBOTS)
        server.wait_for_status(lambda status: status["robots"].get("online") == str(ROBOTS), WAIT_SECONDS, "robots are here")
        with Events(server.http, "/api/v1/watch?presence=online&parts=none") as events:
            robots = events.snapshot()
            self.assertEqual(len(robots), ROBOTS)
            self.assertNotIn("motion", next(iter(robots.values())))
            fleet.finish()
            left = set()
            while left != set(robots):
                left.add(events.until(lambda name, _: name == "removed")["removed"])

    def test_every_connection_begins_with_a_snapshot(self):
        server = self.server().start()
        self.fleet(server, "--robots", 1)
        server.wait_for_status(lambda status: status["robots"].get("online") == "1", WAIT_SECONDS, "the robot is here")
        with Events(server.http) as events:
            self.assertEqual(len(events.snapshot()), 1)
        with Events(server.http, last_id="1000") as events:
            self.assertEqual(len(events.snapshot()), 1)

    def test_a_revoked_token_ends_its_watch(self):
        tokens = pathlib.Path(self.folder) / "tokens"
        tokens.touch(mode=0o600)
        server = self.server(f'[http]\ntokens_file = "{tokens}"').start()
        made = run(BIN / "uplinkctl", "tokens", "new", "--tokens-file", tokens, "--role", "viewer", "--fleet", "*",
                   "--expires", "1d")  # fmt: skip
        token = made.stdout.strip()

        def counts():
            with Events(server.http, token=token) as events:
                return events.answer.status == 200

        wait_until(server.process, counts, WAIT_SECONDS, "the token counts")
        with Events(server.http, token=token) as events:
            self.assertEqual(events.snapshot(), {})
            rows = json.loads(uplinkctl("tokens", "list", "--tokens-file", str(tokens), "-o", "json").stdout)
            row = (rows["tokens"] if isinstance(rows, dict) else rows)[0]
            uplinkctl("tokens", "revoke", "--tokens-file", str(tokens), row["id"])
            ended = events.until(lambda name, _: name == "end")
            self.assertEqual(ended["error"]["code"], "UNAUTHENTICATED")

    def test_a_revoked_token_sees_no_more_changes(self):
        """Robots go on and on; the watch of who is revoked ends before the comment that it would get."""
        tokens = pathlib.Path(self.folder) / "tokens"
        tokens.touch(mode=0o600)
        made = run(BIN / "uplinkctl", "tokens", "new", "--tokens-file", tokens, "--role", "viewer", "--fleet", "*",
                   "--expires", "1d")  # fmt: skip
        server = self.server(f'[http]\ntokens_file = "{tokens}"').start()
        self.fleet(server, "--robots", ROBOTS, "--acks-only")
        with Events(server.http, token=made.stdout.strip()) as events:
            events.snapshot()
            self.assertIsNotNone(events.until(lambda name, _: name == "robot"))
            (line,) = tokens.read_text().splitlines()
            uplinkctl("tokens", "revoke", "--tokens-file", str(tokens), json.loads(line)["id"])
            ended = events.until(lambda name, _: name == "end")
            self.assertEqual(ended["error"]["code"], "UNAUTHENTICATED")
            self.assertEqual(events.comments, 0, "it ends before its first comment, which comes after 15 s")

    def test_watches_end_when_the_server_stops(self):
        server = self.server().start()
        with Events(server.http) as events:
            self.assertEqual(events.snapshot(), {})
            self.assertEqual(server.terminate(60), 0)
            # In order if it was sent in time; the connection ends anyway.
            ended = events.until(lambda name, _: name == "end")
            if ended is not None:
                self.assertEqual(ended["error"]["code"], "UNAVAILABLE")


if __name__ == "__main__":
    unittest.main()
