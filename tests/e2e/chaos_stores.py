"""The stores of the crash campaign (chaos.py): what they hold of each robot, and what of them is
killed."""

import sqlite3
import subprocess
import time

from harness import Cluster

# What follows from tests/chaos/script.h: the kinds of a robot's numbers repeat, and one of them is
# live state, which leaves no row.
STEPS = 8
LIVE_STEP = 6
RAISE_STEP = 2
RECOVERY_SECONDS = 60
# How often a working session is looked for before a kill is given up.
LOOKS_FOR_WORK = 200

# One statement, so one snapshot: a row a robot. {acked}: (ruri, t) of each robot.
COMPARISON = """
WITH acked (ruri, t) AS (VALUES {acked}),
said AS (
  SELECT ruri, seq, seq % 8 = 0 AS good FROM events
  UNION ALL SELECT ruri, seq, seq % 8 IN (1, 7) AND message = CAST(seq AS TEXT) FROM messages
  UNION ALL SELECT ruri, seq, description = CAST(seq AS TEXT)
    AND seq % 8 = 3 - CAST(active AS INTEGER) FROM faults_history
  UNION ALL SELECT ruri, seq, seq % 8 = 4 AND report LIKE '%"' || seq || '"%' FROM mission_reports
  UNION ALL SELECT ruri, seq, seq % 8 = 5 AND reason = 5 FROM quarantine
),
sums AS (
  SELECT said.ruri, count(*) AS n, count(DISTINCT seq) AS numbers,
    count(DISTINCT seq) FILTER (WHERE seq <= t AND good) AS kept,
    count(*) FILTER (WHERE NOT good) AS wrong, max(seq) AS top,
    count(*) FILTER (WHERE seq % 8 = 4) AS reports
  FROM said JOIN acked ON acked.ruri = said.ruri GROUP BY said.ruri
)
SELECT acked.ruri, acked.t, coalesce(cursor_seq, 0), coalesce(n, 0), coalesce(numbers, 0),
  coalesce(kept, 0), coalesce(wrong, 0), coalesce(top, 0), coalesce(reports, 0),
  (SELECT count(*) FROM faults_active AS f WHERE f.ruri = acked.ruri),
  coalesce((SELECT sum(updates) FROM mission_runs AS m WHERE m.ruri = acked.ruri), 0),
  (SELECT count(*) FROM gaps AS g WHERE g.ruri = acked.ruri)
FROM acked LEFT JOIN sessions AS s ON s.ruri = acked.ruri LEFT JOIN sums ON sums.ruri = acked.ruri
ORDER BY acked.ruri
"""


def durable(through):
    """How many of the numbers 1 to `through` leave a row."""
    return through - (through + STEPS - LIVE_STEP) // STEPS


class Sqlite:
    kills = {"server": 3, "robots": 1}

    def __init__(self, folder):
        self.path = folder / "uplinkd.db"
        self.url = f"sqlite://{self.path}"

    def read(self, sql):
        connection = sqlite3.connect(self.path, timeout=30)
        try:
            return connection.execute(sql).fetchall()
        finally:
            connection.close()

    def rows(self, acked):
        return self.read(COMPARISON.format(acked=acked))

    def close(self):
        pass


class Postgres:
    def __init__(self, folder):
        self.cluster = Cluster(folder).create().migrate()
        self.url = self.cluster.url("uplinkd")

    def sql(self, text, database="uplinkd"):
        """Again until the cluster, which may just have been killed, serves it."""
        deadline = time.monotonic() + RECOVERY_SECONDS
        while True:
            try:
                return self.cluster.sql(text, database)
            except AssertionError:
                if time.monotonic() > deadline:
                    raise

    def rows(self, acked):
        text = self.sql(
            "SET search_path = uplinkd;" + COMPARISON.format(acked=acked)
        )
        return [
            [part if i == 0 else int(part) for i, part in enumerate(line.split("|"))]
            for line in text.splitlines()
        ]

    kills = {"server": 8, "backend": 3, "backend crash": 2, "cluster": 4, "robots": 3}

    def kill_backend(self, crash):
        """Ends a session that works just now: as an administrator does, or by SIGKILL, after which
        PostgreSQL ends all of them. False if none was met working."""
        how = "pid" if crash else "pg_terminate_backend(pid)"
        for _ in range(LOOKS_FOR_WORK):
            found = self.sql(
                f"SELECT {how}, pid FROM pg_stat_activity WHERE application_name = 'uplinkd'"
                " AND state <> 'idle' LIMIT 1", "postgres")  # fmt: skip
            if found:
                if crash:
                    subprocess.run(["kill", "-KILL", found.split("|")[1]], check=False, capture_output=True)
                return True
        return False

    def close(self):
        self.cluster.close()
