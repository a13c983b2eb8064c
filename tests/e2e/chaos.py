"""The crash campaign: kills everything at random moments, and compares what the robots were told is
durable with what is stored. chaos_run.py runs it.

A robot's messages follow from their numbers (tests/chaos/script.h), so a comparison knows every row
that must be there. With a canary, a server that is wrong on purpose, it goes on until something is
lost.
"""

import random
import signal
import sqlite3
import subprocess

from chaos_stores import RAISE_STEP, RECOVERY_SECONDS, STEPS, Postgres, Sqlite, durable
from harness import BIN, Server, wait_until

ROBOTS = 20
# Between two frames of a robot. A canary's robots have always something on its way.
PACE_MS = 150
CANARY_PACE_MS = 2
PROGRESS_EVERY = 50
CANARIES = {"acks_early": "uplinkd_acks_early", "unsynced": "uplinkd_unsynced"}


class Robots:
    def __init__(self, folder, seed, pace_ms):
        self.folder = folder
        self.seed = seed
        self.pace_ms = pace_ms
        self.acked_path = folder / "acked.log"
        self.acked_path.touch()
        self.process = None
        self.offset = 0
        self.through = dict.fromkeys(range(ROBOTS), 0)

    def start(self, port):
        with (self.folder / "robots.log").open("ab") as log:
            self.process = subprocess.Popen(
                [str(BIN / "uplink_chaos_robots"), "--port", str(port), "--pki",
                 str(self.folder / "pki"), "--acked", str(self.acked_path), "--robots", str(ROBOTS),
                 "--seed", str(self.seed), "--pace-ms", str(self.pace_ms)],
                stdout=log, stderr=subprocess.STDOUT,
            )  # fmt: skip

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait(30)

    def acked(self):
        """The highest number that each robot was told is durable."""
        with self.acked_path.open("rb") as lines:
            lines.seek(self.offset)
            text = lines.read()
        whole = text[: text.rfind(b"\n") + 1]
        self.offset += len(whole)
        for line in whole.splitlines():
            robot, through = map(int, line.split())
            self.through[robot] = through
        return self.through

    def count(self):
        return sum(self.acked().values())


class Campaign:
    def __init__(self, folder, store, seed, canary=None):
        self.random = random.Random(seed)
        self.folder = folder
        self.canary = canary
        self.server = Server(folder)
        self.servers = [self.server]
        self.store = Postgres(folder) if store == "postgres" else Sqlite(folder)
        self.server.store_url = self.store.url
        self.robots = Robots(folder, seed, CANARY_PACE_MS if canary else PACE_MS)
        self.done = 0
        self.lost = self.doubled = 0
        self.wrong = []
        self.acked = self.stored = 0

    def start_server(self, server):
        """With SQLite alternately the program itself and the one that loses what is not synced."""
        programs = ["uplinkd"]
        if self.canary:
            programs = [CANARIES[self.canary]]
        elif isinstance(self.store, Sqlite):
            programs = ["uplinkd", "uplinkd_held"]
        server.program = BIN / programs[server.starts % len(programs)]
        server.environment = {"UPLINK_HELD_SEED": str(self.random.randrange(1 << 30))}
        server.start()

    def port(self):
        """Where the robots connect."""
        return self.server.relay.rsplit(":", 1)[1]

    def start(self):
        for server in self.servers:
            self.start_server(server)
        self.robots.start(self.port())

    def wait_for_more(self, messages):
        """Until so many more were acked: the fleet and the server do their work."""
        before = self.robots.count()
        wait_until(
            self.robots.process,
            lambda: self.robots.count() >= before + messages,
            RECOVERY_SECONDS,
            f"acks of {messages} messages more ({[server.text()[-500:] for server in self.servers]})",
        )

    def compare(self):
        """The acked set, the stored set and the cursors; what was acked is asked first."""
        acked = dict(self.robots.acked())
        listed = ", ".join(f"('rcan://chaos/robot-{robot:03}', {t})" for robot, t in acked.items())
        self.acked = sum(map(durable, acked.values()))
        self.stored = lost = doubled = 0
        try:
            rows = self.store.rows(listed)
        except sqlite3.DatabaseError as error:
            # What cannot be read is lost.
            self.wrong.append(str(error))
            self.lost = self.acked
            return
        for ruri, t, cursor, n, numbers, kept, wrong, top, reports, active, updates, gaps in rows:
            self.stored += n
            lost += durable(t) - kept
            doubled += n - numbers
            raised = int(cursor % STEPS == RAISE_STEP)
            for what, there, due in (
                ("rows that are not what their numbers say", wrong, 0),
                ("numbers up to the cursor", numbers, durable(cursor)),
                ("highest number", top, cursor),
                ("active faults", active, raised),
                ("updates of the run", updates, reports),
                ("gaps", gaps, 0),
            ):
                if there != due:
                    self.wrong.append(f"{ruri}: {what}: {there}, not {due} (acked {t}, cursor {cursor})")
        self.lost = max(self.lost, lost)
        self.doubled = max(self.doubled, doubled)

    def kill_server(self):
        self.server.kill()
        if self.canary:
            self.compare()
        self.start_server(self.server)

    def kill(self):
        kinds = self.store.kills
        kind = self.random.choices(list(kinds), list(kinds.values()))[0]
        if self.canary:
            kind = "server"
        # Any moment of the milliseconds to come.
        try:
            self.robots.process.wait(self.random.random() * 0.02)
        except subprocess.TimeoutExpired:
            pass
        if kind == "server":
            self.kill_server()
        elif kind == "robots":
            self.robots.kill()
            self.robots.start(self.port())
        elif kind == "cluster":
            self.store.cluster.crash()
        elif not self.store.kill_backend(kind == "backend crash"):
            return
        self.done += 1

    def round(self):
        self.wait_for_more(self.random.randrange(1, 200))
        self.kill()
        if self.canary:
            return
        self.wait_for_more(ROBOTS)
        self.compare()

    def clean(self):
        return self.lost == 0 and self.doubled == 0 and not self.wrong

    def line(self):
        return (f"kills {self.done}, acked {self.acked}, stored {self.stored}, lost {self.lost},"
                f" doubled {self.doubled}")  # fmt: skip

    def recovery_lines(self):
        """Of this campaign they are not measured."""
        return []

    def canary_found(self):
        return self.lost > 0

    def run(self, kills, progress=None):
        """To the end, or to the first thing that is wrong."""
        self.start()
        while self.done < kills and (self.lost == 0 if self.canary else self.clean()):
            self.round()
            if progress and self.done % PROGRESS_EVERY == 0:
                print(self.line(), file=progress, flush=True)
        if self.clean() and not self.canary:
            self.finish()
        return self.clean()

    def finish(self):
        self.robots.kill()
        for server in self.servers:
            server.terminate(60)
        self.compare()

    def close(self):
        for process in (self.robots.process, *(server.process for server in self.servers)):
            if process is not None and process.poll() is None:
                process.kill()
                process.wait(30)
        self.store.close()
