"""The stores of releases, `tests/fixtures/stores/VERSION`: opened with a server of this build, and what it
shows of them. The server's civil clock stands at the time of `read_at`, so nothing has aged since.
"""

import json
import sqlite3
import subprocess
import time
import urllib.parse

from harness import SOURCE, Cluster, Server, run, uplinkctl, wait_until
from test_clock import ShiftedClock

FIXTURES = SOURCE / "tests/fixtures/stores"
RELEASES = sorted(path.parent for path in FIXTURES.glob("*/answers.json"))
SECONDS = 60
# What pg_dump writes for people, and for the psql of the same release.
NOT_DUMPED = ("--", "\n", "\\restrict ", "\\unrestrict ")


class SqliteStore:
    def __init__(self, folder):
        self.path = folder / "uplinkd.db"
        self.url = f"sqlite://{self.path}"

    def sql(self, text):
        """The rows of one statement."""
        file = sqlite3.connect(self.path, timeout=SECONDS)
        try:
            with file:
                return file.execute(text).fetchall()
        finally:
            file.close()

    def tables(self):
        return [name for (name,) in self.sql("SELECT name FROM sqlite_schema WHERE type = 'table'")]

    def dump(self):
        """As text; the number by which uplinkd knows its files is no part of SQLite's own."""
        file = sqlite3.connect(self.path, timeout=SECONDS)
        try:
            (number,) = file.execute("PRAGMA application_id").fetchone()
            return "\n".join([f"PRAGMA application_id = {number};", *file.iterdump()]) + "\n"
        finally:
            file.close()

    def restore(self, text):
        file = sqlite3.connect(self.path)
        try:
            file.executescript(text)
        finally:
            file.close()

    def migrate(self):
        """The server does so itself."""

    def simplify(self):
        """There is nothing to leave out."""

    def close(self):
        pass


class PostgresStore:
    """A cluster with one database, which has no schema yet."""

    def __init__(self, folder):
        self.cluster = Cluster(folder, "timezone = 'UTC'").create()
        self.url = self.cluster.url("uplinkd")
        self.owner = self.cluster.url("uplinkd_owner")

    def sql(self, text):
        found = self.cluster.sql(f"SET search_path = uplinkd; {text}")
        return [tuple(line.split("|")) for line in found.splitlines()]

    def tables(self):
        """Without the days of histories."""
        return [name for (name,) in self.sql(
            "SELECT relname FROM pg_class WHERE relnamespace = 'uplinkd'::regnamespace"
            " AND relkind IN ('r', 'p') AND NOT relispartition"
        )]  # fmt: skip

    def migrate(self):
        """As an operator does before the server of a later build starts."""
        uplinkctl("store", "migrate", "--url", self.owner, "--grant-to", "uplinkd")

    def simplify(self):
        """Without empty days, which a server makes again, and without the name of the machine."""
        for (day,) in self.sql("SELECT relname FROM pg_class WHERE relkind = 'r' AND relname ~ '_[0-9]{8}$'"):
            if not self.sql(f"SELECT 1 FROM {day} LIMIT 1"):
                self.sql(f"DROP TABLE {day}")
        self.sql("UPDATE processes SET name = 'server.example.org:7443', life = 'kernel/pid:[1]/1/1'")

    def dump(self):
        text = run("pg_dump", "--schema=uplinkd", self.owner).stdout
        return "".join(line for line in text.splitlines(True) if not line.startswith(NOT_DUMPED))

    def restore(self, text):
        subprocess.run(["psql", "-X", "-q", "-v", "ON_ERROR_STOP=1", self.owner], input=text, text=True,
                       stdout=subprocess.DEVNULL, check=True, timeout=SECONDS)  # fmt: skip

    def close(self):
        self.cluster.close()


STORES = {"sqlite": SqliteStore, "postgres": PostgresStore}


class Reading:
    """A server on a store, at `read_at` of its civil clock (Unix milliseconds)."""

    def __init__(self, folder, store, read_at):
        self.clock = ShiftedClock(folder)
        self.clock.set(read_at // 1000 - int(time.time()))
        self.server = Server(folder, store_url=store.url, environment=self.clock.environment)

    def start(self):
        """Until it holds all robots, and has read their live state."""
        self.server.start()

        def is_held(robot):
            return not robot["heldBy"] and "lastSignOfLife" in robot

        def holds_all():
            robots = (self.server.get("/api/v1/robots?pageSize=1000") or {}).get("robots")
            return robots and all(is_held(robot) for robot in robots)

        wait_until(self.server.process, holds_all, SECONDS, "the server holds the robots")
        return self

    def stop(self):
        code = self.server.terminate(SECONDS)
        assert code == 0, self.server.text()

    def close(self):
        self.server.close()

    def answer(self, target):
        """The whole answer: of a list, whose target ends with `pageSize=N`, all pages in one."""
        whole = self.server.get(target)
        if whole is None or "nextPageToken" not in whole:
            return whole
        rows = next(value for value in whole.values() if isinstance(value, list))
        while token := whole["nextPageToken"]:
            page = self.server.get(f"{target}&pageToken={urllib.parse.quote(token, safe='')}")
            rows += next(value for value in page.values() if isinstance(value, list))
            whole["nextPageToken"] = page["nextPageToken"]
        return whole

    def answers(self, targets):
        return {target: self.answer(target) for target in targets}


def without_unknown(answer):
    """0.1.0 showed 0 for a clock skew that is unknown, which is absent since."""
    return {name: value for name, value in answer.items() if (name, value) != ("clockSkewMs", "0")}


def recorded(release, kind):
    text = (release / "answers.json").read_text(encoding="utf-8")
    return json.loads(text, object_hook=without_unknown)[kind]


def differences(expected, found, where=""):
    """What is not shown as expected, a text each. An object may have further members, which a later
    version shows; a list may not have further rows."""
    if isinstance(expected, dict) and isinstance(found, dict):
        return [text for name in expected
                for text in differences(expected[name], found.get(name), f"{where}/{name}")]  # fmt: skip
    if isinstance(expected, list) and isinstance(found, list):
        if len(expected) != len(found):
            return [f"{where}: {len(found)} rows, not {len(expected)}"]
        return [text for place, pair in enumerate(zip(expected, found))
                for text in differences(*pair, f"{where}[{place}]")]  # fmt: skip
    return [] if expected == found else [f"{where}: {found!r}, not {expected!r}"]
