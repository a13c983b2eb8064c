"""A store that each release wrote shows in this build what it showed then."""

import json
import os
import subprocess
import unittest

from harness import SOURCE, EndToEnd
from store_fixture import RELEASES, STORES, Reading, differences, recorded

# Rows that are read for each answer. Those of `live` and `robots` are read at the start.
READ = [
    "faults_history", "faults_active", "events", "messages", "mission_runs", "scope_updates", "presence_changes",
    "quarantine", "quarantine_dropped", "gaps", "shapes", "objects", "latest",
]  # fmt: skip
# The robot of the fixture that says all kinds, in a session which relay_client.py goes on with.
ROBOT = "rcan://example.org/acme/rover/all"
PYTHON = "/usr/bin/python3"
CLIENT_SECONDS = 60
# Rows that decide what is new, and reports that show in their run alone.
NOT_SHOWN = ["sessions WHERE ruri <> 'server'", "kept_rejects", "mission_reports"]


class StoresOfReleases(EndToEnd):
    def open(self, release, kind):
        """A copy of the store."""
        folder = self.folder / f"{kind}-{release.name}"
        folder.mkdir()
        store = STORES[kind](folder)
        self.open_things.append(store)
        store.restore((release / f"{kind}.sql").read_text(encoding="utf-8"))
        store.migrate()
        return folder, store, recorded(release, kind)

    def reading(self, folder, store, then):
        reading = Reading(folder, store, then["read_at"])
        self.open_things.append(reading)
        return reading

    def not_shown(self, store):
        return [sorted(store.sql(f"SELECT * FROM {rows}")) for rows in NOT_SHOWN]

    def are_shown_as_they_were(self, kind):
        self.assertTrue(RELEASES)
        for release in RELEASES:
            with self.subTest(release.name):
                folder, store, then = self.open(release, kind)
                reading = self.reading(folder, store, then)
                kept = self.not_shown(store)
                for start in ("first", "second"):
                    reading.start()
                    found = reading.answers(then["answers"])
                    self.assertEqual(differences(then["answers"], found), [], f"after the {start} start")
                    reading.stop()
                    self.assertEqual(self.not_shown(store), kept, f"after the {start} start")

    def test_stores_of_sqlite_are_shown_as_they_were(self):
        self.are_shown_as_they_were("sqlite")

    def test_stores_of_postgres_are_shown_as_they_were(self):
        self.are_shown_as_they_were("postgres")

    def numbers(self, store, statement):
        return [int(number) for (number,) in store.sql(statement)]

    def resume(self, server, last):
        """The robot's agent goes on, with a clock like the server's."""
        server.uplinkctl("pki", "robot", "--dir", server.pki, "--ruri", ROBOT, "--fleet", "north")
        modules = server.folder / "modules"
        modules.mkdir()
        subprocess.run(["protoc", f"--proto_path={SOURCE / 'proto'}", f"--python_out={modules}",
                        "uplink/v1/relay.proto"], check=True)  # fmt: skip
        files = [str(server.pki / file) for file in ("ca.crt", "robot.crt", "robot.key")]
        done = subprocess.run(
            [PYTHON, str(SOURCE / "tests/e2e/relay_client.py"), "resume", server.relay, *files, str(last)],
            env={**os.environ, **server.environment, "PYTHONPATH": str(modules)},
            capture_output=True, text=True, timeout=CLIENT_SECONDS, check=False,
        )  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_a_robot_resumes_its_session(self):
        cursor = f"SELECT cursor_seq FROM sessions WHERE ruri = '{ROBOT}'"
        events, rejected = (f"SELECT seq FROM {rows} WHERE ruri = '{ROBOT}' ORDER BY seq"
                            for rows in ("events", "quarantine"))  # fmt: skip
        for release in RELEASES:
            for kind in STORES:
                with self.subTest(f"{release.name} {kind}"):
                    _, store, _ = opened = self.open(release, kind)
                    reading = self.reading(*opened).start()
                    (last,), before, rejects = (self.numbers(store, each) for each in (cursor, events, rejected))
                    self.assertTrue(before and rejects)
                    said = self.resume(reading.server, last)
                    self.assertEqual(said, {"committed": last, "rejects": rejects, "through": last + 1,
                                            "code": "OK", "details": ""})  # fmt: skip
                    reading.stop()
                    self.assertEqual(self.numbers(store, events), [*before, last + 1])
                    self.assertEqual(self.numbers(store, cursor), [last + 1])

    def test_rows_that_are_gone_are_differences(self):
        folder, store, then = self.open(RELEASES[-1], "sqlite")
        reading = self.reading(folder, store, then).start()
        before = then["answers"]
        for table in READ:
            store.sql(f"DELETE FROM {table} WHERE ruri = (SELECT max(ruri) FROM {table})")
            after = reading.answers(before)
            self.assertNotEqual(differences(before, after), [], table)
            before = after

    def test_a_row_too_few_or_too_many_and_another_value_are_differences(self):
        expected = {"rows": [{"a": 1}, {"a": 2}]}
        self.assertEqual(differences(expected, {"rows": [{"a": 1}, {"a": 2, "new": 3}]}), [])
        for rows in ([{"a": 1}], [{"a": 1}, {"a": 2}, {"a": 3}], [{"a": 1}, {"a": 3}], [{"a": 1}, {}]):
            self.assertEqual(len(differences(expected, {"rows": rows})), 1, rows)
        self.assertEqual(len(differences(expected, None)), 1)


if __name__ == "__main__":
    unittest.main()
