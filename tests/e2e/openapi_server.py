"""A running server with something in every list, and its answers held against the OpenAPI file."""

import sqlite3

from harness import EndToEnd, wait_until
from openapi import Document, request, target

WAIT_SECONDS = 60
# Answers without an end: test_watch.py reads them.
STREAMS = {"watch"}
# The list of each answer that holds one.
LISTS = {
    "robots": "robots", "fleets": "fleets", "events": "events", "messages": "messages", "presence": "presenceChanges",
    "connections": "connections", "quarantine": "quarantined", "gaps": "gaps", "mission_reports": "missionReports",
    "scope_updates": "scopeUpdates", "faults": "faults", "missions": "missions",
    "shapes": "shapes", "objects": "objects",
}  # fmt: skip


class Served(EndToEnd):
    """A server with something in every list."""

    def setUp(self):
        super().setUp()
        self.document = Document()
        self.operations = {
            path: operation
            for path, operation in self.document.operations().items()
            if operation["operationId"] not in STREAMS
        }

    def play(self, settings=""):
        """A fleet sends of everything, some of it wrong, until there is something in each list."""
        server = self.server(settings).start()
        fleet = self.fleet(server, "--robots", 4, "--malformed-share", 0.1, "--pace", 4, "--faults", 4)
        server.wait_for_status(
            lambda status: int(status["uplinks"]["stored"]) > 0, WAIT_SECONDS, "the fleet is at work"
        )
        self.add_gaps()
        self.add_scope_updates()
        empty = []

        def full():
            empty[:] = self.empty_lists(server)
            return not empty

        try:
            wait_until(fleet.process, full, WAIT_SECONDS, "something in each list")
        except AssertionError as error:
            raise AssertionError(f"{error}; empty: {empty}\n{fleet.log()[-2000:]}") from None
        return server, fleet

    def add_gaps(self):
        """The fleet skips no numbers: these rows say that each robot did, twice."""
        with sqlite3.connect(self.folder / "uplinkd.db", timeout=WAIT_SECONDS) as store:
            for first in (5, 20):
                store.execute(
                    "INSERT INTO gaps (ruri, session, first, last, fleet, seen_at, entry)"
                    " SELECT ruri, x'00112233445566778899aabbccddeeff', ?, ? + 4, fleet, ?, row_number() OVER () FROM robots",
                    (first, first, 1763683200000 + first),
                )
        store.close()

    def add_scope_updates(self):
        """The fleet has no environments and workflow runs: these rows say that two changed."""
        with sqlite3.connect(self.folder / "uplinkd.db", timeout=WAIT_SECONDS) as store:
            for scope in (0, 1):
                store.execute(
                    "INSERT INTO scope_updates VALUES ('cyberwave:', ?, 0, 'default',"
                    " x'00112233445566778899aabbccddeeff', ?, 5, ?, ?, 'running', '{\"status\":\"running\"}')",
                    (1763683200000 + scope, scope + 1, scope, f"5b1f0c2e-7d0b-4a6f-9d57-0c6a2f1f3b1{scope}"),
                )
        store.close()

    def ruris(self, server):
        return [robot["ruri"] for robot in server.get("/api/v1/robots")["robots"]]

    def ruri(self, server):
        return self.ruris(server)[0]

    def empty_lists(self, server):
        """The lists in which no robot has a row."""
        ruris = self.ruris(server)
        return [
            operation["operationId"]
            for path, operation in self.operations.items()
            if operation["operationId"] in LISTS
            and not any(server.get(target(path, ruri))[LISTS[operation["operationId"]]] for ruri in ruris)
        ]

    def assert_documented(self, server, path, ruri, parameters=None, method="GET", headers=None):
        """Requests, and holds the answer against the file; gives it."""
        operation = self.operations[path]
        answer = request(server, target(path, ruri, parameters), method, headers)
        where = f"{method} {target(path, ruri, parameters)} {answer.status} {answer.body[:2000]}"
        self.assertIn(str(answer.status), operation["responses"], where)
        response = self.document.response(operation, answer.status)
        self.assertEqual(self.document.answer_problems(response, answer), [], where)
        return answer

    def assert_error(self, answer, status, code, field=None):
        self.assertEqual(answer.status, status, answer.body)
        self.assertEqual(answer.content_type, "application/json")
        self.assertEqual(self.document.named("Error", answer.json()), [])
        self.assertEqual(answer.json()["error"]["code"], code)
        self.assertEqual(answer.json()["error"].get("field"), field)
