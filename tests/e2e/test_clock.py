"""A civil clock that jumps erases nothing: real servers, their clock shifted by a preloaded library."""

import os
import pathlib
import sqlite3
import struct
import subprocess
import time
import unittest
import unittest.mock

from harness import BIN, Cluster, EndToEnd, Fleet, Server, run, wait_until

SHIM = pathlib.Path(__file__).with_name("civil_shift.c")
DAYS_100 = 100 * 86_400
FOLLOWS_SECONDS = 30
# The sweep of expired shapes and objects is due a minute after the start, and then each minute.
SWEEP_SECONDS = 65
# What retention and the sweep would take.
TABLES = [
    "robots", "sessions", "faults_history", "events", "messages", "mission_reports", "mission_runs",
    "quarantine", "shapes", "objects",
]  # fmt: skip


class ShiftedClock:
    """The civil clock of the programs that are started in `environment`."""

    def __init__(self, folder):
        library = folder / "civil_shift.so"
        run("cc", "-shared", "-fPIC", "-O1", "-Wall", "-o", library, SHIM, "-ldl")
        self.file = folder / "civil_shift"
        self.set(0)
        # A build under AddressSanitizer wants its runtime to come first, but for this.
        sanitizer = os.environ.get("ASAN_OPTIONS", "") + ":verify_asan_link_order=0"
        self.environment = {"LD_PRELOAD": str(library), "CIVIL_SHIFT_FILE": str(self.file),
                            "ASAN_OPTIONS": sanitizer}  # fmt: skip

    def set(self, seconds):
        # In place: the programs have the file in their memory.
        with self.file.open("r+b" if self.file.exists() else "wb") as file:
            file.write(struct.pack("=q", seconds))


class SqliteRows:
    def __init__(self, folder):
        self.path = folder / "uplinkd.db"
        self.url = f"sqlite://{self.path}"

    def count(self, table, where="true"):
        connection = sqlite3.connect(self.path, timeout=30)
        try:
            return connection.execute(f"SELECT count(*) FROM {table} WHERE {where}").fetchone()[0]
        finally:
            connection.close()


class PostgresRows:
    def __init__(self, folder):
        self.cluster = Cluster(folder).create().migrate()
        self.url = self.cluster.url("uplinkd")
        self.close = self.cluster.close

    def count(self, table, where="true"):
        return int(self.cluster.sql(f"SELECT count(*) FROM uplinkd.{table} WHERE {where}"))


class OnShiftedClock(EndToEnd):
    def begin(self, rows):
        """A server whose store holds histories and present objects, and that was stopped."""
        self.rows = rows
        if hasattr(rows, "close"):
            self.open_things.append(rows)
        self.clock = ShiftedClock(self.folder)
        self.server = Server(self.folder, store_url=rows.url)
        self.server.environment = self.clock.environment
        self.open_things.append(self.server)
        self.server.start()
        fleet = Fleet(self.server, "--robots", 5, "--faults", 10, "--pace", 100, "--malformed-share", 0.02)
        self.open_things.append(fleet)
        kinds = [table for table in TABLES if table != "mission_runs"]
        wait_until(
            fleet.process,
            lambda: all(rows.count(table) for table in kinds) and rows.count("objects", "expires_ms > 0"),
            120,
            "there are rows of each kind",
            every=0.2,
        )
        fleet.finish()
        self.assertEqual(self.server.terminate(60), 0)
        self.before = self.counts()

    def counts(self):
        """Without the sessions of servers: each start adds one."""
        mine = {"sessions": "ruri <> 'server'"}
        return {table: self.rows.count(table, mine.get(table, "true")) for table in TABLES}

    def degraded(self):
        return (self.server.get("/api/v1/status") or {"degraded": []})["degraded"]

    def wait_for_clock(self, trusted):
        def look():
            status = self.server.get("/api/v1/status")
            return status is not None and ("clock" not in status["degraded"]) == trusted

        wait_until(self.server.process, look, FOLLOWS_SECONDS, f"the clock is trusted: {trusted}")
        self.assertEqual(self.server.metric("uplinkd_clock_vouched"), float(trusted))

    def ask(self, *arguments, code):
        return run(
            BIN / "uplinkctl", "store", "clock", "--url", self.rows.url, *arguments,
            code=code, env={**os.environ, **self.clock.environment},
        ).stdout  # fmt: skip


class Clock(OnShiftedClock):
    def what_a_clock_behind_stamps_is_kept(self, rows, old):
        """`old` finds rows that are too old by the right time."""
        self.rows = rows
        if hasattr(rows, "close"):
            self.open_things.append(rows)
        self.clock = ShiftedClock(self.folder)
        self.clock.set(-DAYS_100)
        # Certificates that are good then and now, and robots that live then.
        with unittest.mock.patch.dict(os.environ, self.clock.environment):
            self.server = Server(self.folder, store_url=rows.url)
            self.open_things.append(self.server)
            # The store gets a mark of the right time.
            self.clock.set(0)
            self.server.start()
            self.wait_for_clock(True)
            self.assertEqual(self.server.terminate(60), 0)
            self.clock.set(-DAYS_100)
            self.server.start()
            self.wait_for_clock(False)
            self.server.wait_for_line("before the mark")
            fleet = Fleet(self.server, "--robots", 3, "--faults", 10, "--pace", 100)
            self.open_things.append(fleet)
            wait_until(fleet.process, lambda: rows.count("events") and rows.count("faults_history"), 120,
                       "there are rows")  # fmt: skip
            fleet.close()
            self.assertEqual(self.server.terminate(60), 0)
            self.before = self.counts()
            for table in ("events", "faults_history"):
                self.assertEqual(rows.count(table, old), 0, f"stamped from the mark on: {table}")
            self.clock.set(0)
            self.server.start()
            self.wait_for_clock(True)
            self.assertEqual(self.counts(), self.before)

    def test_what_a_clock_behind_stamps_is_kept_on_sqlite(self):
        self.what_a_clock_behind_stamps_is_kept(
            SqliteRows(self.folder), "received_at < (strftime('%s', 'now') - 86400) * 1000"
        )

    def test_what_a_clock_behind_stamps_is_kept_on_postgres(self):
        self.what_a_clock_behind_stamps_is_kept(
            PostgresRows(self.folder), "received_at < now() - interval '1 day'"
        )

    def test_a_jump_of_hours_is_not_trusted_for_being_near_the_mark(self):
        self.begin(SqliteRows(self.folder))
        self.server.start()
        self.wait_for_clock(True)
        self.clock.set(12 * 3600)
        self.wait_for_clock(False)
        self.clock.set(0)
        self.wait_for_clock(True)

    def an_operator_confirms(self, rows):
        self.begin(rows)
        self.clock.set(DAYS_100)
        self.server.start()
        self.wait_for_clock(False)
        self.assertIn("past the mark", self.ask(code=1))
        refused = subprocess.run(
            [BIN / "uplinkctl", "store", "clock", "--url", rows.url, "--confirm"],
            input="no\n", capture_output=True, text=True, check=False, timeout=60,
            env={**os.environ, **self.clock.environment},
        )  # fmt: skip
        self.assertEqual(refused.returncode, 1)
        self.assertIn("nothing was changed", refused.stdout)
        self.assertIn("clock", self.degraded())
        self.ask("--confirm", "--yes", code=0)
        self.wait_for_clock(True)
        self.assertIn("yes, by the mark", self.ask(code=0))

    def test_an_operator_confirms_on_sqlite(self):
        rows = SqliteRows(self.folder)
        self.an_operator_confirms(rows)
        # What is 100 days old goes at the next retention, which a start begins with.
        self.server.terminate(60)
        self.server.start()
        wait_until(
            self.server.process, lambda: rows.count("faults_history") == 0, FOLLOWS_SECONDS, "it is deleted"
        )

    def test_an_operator_confirms_on_postgres(self):
        self.an_operator_confirms(PostgresRows(self.folder))


class Jumps(OnShiftedClock):
    def wait_for_a_sweep(self):
        due = time.monotonic() + SWEEP_SECONDS
        wait_until(self.server.process, lambda: time.monotonic() > due, 2 * SWEEP_SECONDS, "a sweep was due")

    def a_jump_erases_nothing(self, rows):
        self.begin(rows)
        self.clock.set(DAYS_100)
        self.server.start()
        self.assertIn("clock", self.degraded())
        self.server.wait_for_line("clock_not_vouched")
        self.assertIn("clock", self.server.get("/readyz")["degraded"])
        self.wait_for_a_sweep()
        self.assertEqual(self.counts(), self.before, "100 days ahead")
        self.assertEqual(self.server.terminate(60), 0)

        self.clock.set(0)
        self.server.start()
        self.wait_for_clock(True)
        self.assertEqual(self.counts(), self.before, "with the right clock again")

        # It jumps while the server runs, and comes back.
        self.clock.set(DAYS_100)
        self.wait_for_clock(False)
        self.wait_for_a_sweep()
        self.assertEqual(self.counts(), self.before, "after a jump")
        self.clock.set(0)
        self.wait_for_clock(True)
        self.server.wait_for_line("clock_vouched by=mark")

    def test_a_jump_erases_nothing_on_sqlite(self):
        self.a_jump_erases_nothing(SqliteRows(self.folder))

    def test_a_jump_erases_nothing_on_postgres(self):
        self.a_jump_erases_nothing(PostgresRows(self.folder))


if __name__ == "__main__":
    unittest.main()
