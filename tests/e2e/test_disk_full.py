"""A store without space: acks stop, the log says where, and all goes on when there is space again.

And one whose disk is about to be full by one robot: that one is slowed down, and the others go on.
And one that another program reads for long, so that SQLite's WAL takes what the disk has left.
"""

import errno
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import unittest

from chaos import Campaign
from chaos_stores import Sqlite
from harness import EndToEnd, mismatches, wait_until

DISK_MIB = 40
FILLER_MIB = 30
FULL_BYTES = 8 << 20
MIB = 1 << 20
# Below 16 MiB the greedy robot is slowed down, below 8 MiB nothing is stored.
FREE_MIN_MIB = 16
STOP_MIB = FREE_MIN_MIB // 2
ROUND_SECONDS = 60
GREEDY = "rcan://greedy"
# The disk alone is to hold the greedy robot back.
SCARCE = f"""
free_min = "{FREE_MIN_MIB}MiB"
[limits]
durable_records_rate = 0
durable_bytes_rate = "0"
"""
# What the fleet compares with the server's counters, where others send too.
OF_COUNTERS = {"messages, each once", "messages with repeats", "durable, stored",
               "good: stored, applied or superseded", "wrong on purpose, rejected",
               "in flight at the end"}  # fmt: skip
# The name space of mounts is the server's own: nothing of it is seen outside, or left behind.
NAMESPACE = ["unshare", "--mount"] if os.geteuid() == 0 else ["unshare", "--user", "--map-root-user", "--mount"]
# What a reader leaves on its disk of 40 MiB: the WAL takes that in a few seconds.
HELD_FILLER_MIB = 10
WAL_USUAL_MIB = 5
UNLIMITED = """
[limits]
durable_records_rate = 0
durable_bytes_rate = "0"
"""
# Reads one state of the store until its standard input ends.
HOLD = (
    "import sqlite3, sys; file = sqlite3.connect(sys.argv[1], isolation_level=None);"
    "file.execute('BEGIN'); file.execute('SELECT count(*) FROM robots').fetchall();"
    "print('reads', flush=True); sys.stdin.read()"
)
FULL_FOR_MS = 2000
STALL_MS = 3000
FULL = """
CREATE FUNCTION uplinkd.full() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN
  RAISE EXCEPTION 'could not extend file "base/16384/16385": No space left on device'
  USING ERRCODE = '53100';
END $$;
CREATE TRIGGER full_disk BEFORE INSERT ON uplinkd.sessions FOR EACH ROW EXECUTE FUNCTION uplinkd.full();
CREATE TRIGGER full_disk BEFORE INSERT ON uplinkd.messages FOR EACH ROW EXECUTE FUNCTION uplinkd.full();
"""
SPACE = "DROP FUNCTION uplinkd.full() CASCADE"


class SqliteInside(Sqlite):
    """The file as the server has it: SQLite itself finds no way through /proc."""

    READ = (
        "import json, sqlite3, sys; file = sqlite3.connect(sys.argv[1], timeout=30);"
        "print(json.dumps(file.execute(sys.stdin.read()).fetchall()))"
    )

    def __init__(self, folder, pid):
        super().__init__(folder)
        user = [] if os.geteuid() == 0 else ["--user", "--preserve-credentials"]
        self.inside = ["nsenter", "--target", str(pid), *user, "--mount"]

    def read(self, sql):
        command = [*self.inside, sys.executable, "-c", self.READ, str(self.path)]
        return json.loads(subprocess.run(command, input=sql, text=True, check=True, capture_output=True).stdout)


class SmallDisk:
    """A small tmpfs with a file in it that leaves when space is asked for."""

    def __init__(self, folder, filler_mib=FILLER_MIB):
        self.folder = folder / "disk"
        self.folder.mkdir()
        script = (
            'mount -t tmpfs -o size="$1"m tmpfs "$2" && head -c "$3"M /dev/zero >"$2/filler"'
            ' && shift 3 && exec "$@"'
        )
        self.wrapper = [*NAMESPACE, "sh", "-c", script, "sh", str(DISK_MIB), str(self.folder), str(filler_mib)]

    def store(self, process):
        return SqliteInside(self.folder, process.pid)

    def filler(self, process):
        return pathlib.Path(f"/proc/{process.pid}/root{self.folder}/filler")

    def free_bytes(self, process):
        disk = os.statvfs(self.filler(process).parent)
        return disk.f_bavail * disk.f_frsize

    def leave(self, process, free_bytes):
        """Fills the disk until so much is left, if there is more."""
        with self.filler(process).open("ab", buffering=0) as file:
            try:
                file.write(bytes(max(0, self.free_bytes(process) - free_bytes)))
            except OSError as error:
                # The server took the last of it meanwhile: the disk is as full as it can be.
                if error.errno != errno.ENOSPC:
                    raise

    def make_space(self, process):
        self.filler(process).unlink()


class SmallFiles:
    """Where nothing can be mounted: no file may grow past a limit until space is asked for."""

    def __init__(self, folder):
        self.folder = folder / "disk"
        self.folder.mkdir()
        self.wrapper = ["prlimit", f"--fsize={FULL_BYTES}:"]

    def store(self, _process):
        return Sqlite(self.folder)

    def make_space(self, process):
        subprocess.run(["prlimit", "--pid", str(process.pid), "--fsize=unlimited:"], check=True)


def may_mount():
    probe = [*NAMESPACE, "mount", "-t", "tmpfs", "tmpfs", "/mnt"]
    return shutil.which("unshare") and not subprocess.run(probe, check=False, capture_output=True).returncode


class DiskFull(EndToEnd):
    def fill_and_free(self, campaign, fill, make_space, *words):
        server, robots = campaign.server, campaign.robots
        fill()
        server.wait_for_status(
            lambda s: int(s["journalOldestMs"]) > FULL_FOR_MS and "store" in s["degraded"], 60, "no space"
        )
        # Acks stop: none comes while the oldest record grows older by STALL_MS. A smaller batch may
        # still find room now and then.
        last = {"acked": -1, "oldest": 0}

        def stalled(status):
            acked, oldest = robots.count(), int(status["journalOldestMs"])
            if acked != last["acked"] or oldest < last["oldest"]:
                last.update(acked=acked, oldest=oldest)
            return oldest - last["oldest"] > STALL_MS

        server.wait_for_status(stalled, 120, "acks stop")
        campaign.compare()
        self.assertTrue(campaign.clean(), "\n".join([campaign.line(), *campaign.wrong]))
        fails = [line for line in server.text().splitlines() if "store_fails" in line]
        self.assertTrue(fails, server.text())
        for word in words:
            self.assertIn(word, fails[-1])
        self.assertEqual(server.metric("uplinkd_store_failing"), 1)

        make_space()
        campaign.wait_for_more(200)
        wait_until(server.process, lambda: "store_works_again" in server.text(), 30, "it works again")
        campaign.compare()
        self.assertTrue(campaign.clean(), "\n".join([campaign.line(), *campaign.wrong]))

    def campaign(self, store, pace_ms):
        campaign = Campaign(self.folder, store, 1)
        campaign.robots.pace_ms = pace_ms
        self.open_things.append(campaign)
        return campaign

    def test_sqlite_on_a_small_disk(self):
        campaign = self.campaign("sqlite", 10)
        disk = SmallDisk(self.folder) if may_mount() else SmallFiles(self.folder)
        campaign.server.wrapper = disk.wrapper
        campaign.server.store_url = f"sqlite://{disk.folder}/uplinkd.db"
        campaign.start()
        process = campaign.server.process
        campaign.store = disk.store(process)
        # Others fill it at once: left alone, the robots stop while there is some space (DiskScarce).
        fill = getattr(disk, "leave", lambda _process, _free: None)
        campaign.wait_for_more(200)
        self.fill_and_free(campaign, lambda: fill(process, 0), lambda: disk.make_space(process), str(disk.folder))

    def test_postgres_that_reports_a_full_disk(self):
        campaign = self.campaign("postgres", 50)
        campaign.start()
        campaign.wait_for_more(200)
        sql = campaign.store.sql
        self.fill_and_free(campaign, lambda: sql(FULL), lambda: sql(SPACE), "53100", "base/16384/16385")


class DiskScarce(EndToEnd):
    def setUp(self):
        super().setUp()
        self.assertTrue(may_mount(), "a small disk needs a name space of mounts: run as root or allow user name spaces")
        self.campaign = Campaign(self.folder, "sqlite", 1)
        self.campaign.robots.pace_ms = 200
        self.open_things.append(self.campaign)
        self.running = self.campaign.server
        self.disk = SmallDisk(self.folder, filler_mib=1)
        self.running.wrapper = self.disk.wrapper
        self.running.store_url = f"sqlite://{self.disk.folder}/uplinkd.db"
        self.running.settings = SCARCE
        self.campaign.start()
        self.campaign.store = self.disk.store(self.running.process)

    def held_back(self):
        """By RURI, why a robot is not read."""
        robots = (self.running.get("/api/v1/robots") or {}).get("robots", [])
        return {robot["ruri"]: robot["heldBack"] for robot in robots}

    def wait_for(self, condition, what):
        return wait_until(self.running.process, condition, ROUND_SECONDS, what)

    def degraded(self):
        return self.running.get("/readyz")["degraded"]

    def flood(self):
        """One robot stores as fast as it can, and is held back."""
        process = self.running.process
        self.disk.leave(process, (FREE_MIN_MIB + 4) * MIB)
        greedy = self.fleet(
            self.running, "--robots", 1, "--ruri-prefix", GREEDY, "--faults", 500, "--settle-for", "300s"
        )
        self.wait_for(lambda: "store_space" in self.degraded(), "the flood passes free_min")
        self.wait_for(lambda: self.running.metric("uplinkd_store_robots_limited") == 1, "one robot is limited")
        self.wait_for(lambda: self.held_back().get(f"{GREEDY}/robot-0001") == "disk", "it is held back")
        return greedy

    def assert_nothing_is_lost(self, greedy):
        self.campaign.compare()
        self.assertTrue(self.campaign.clean(), "\n".join([self.campaign.line(), *self.campaign.wrong]))
        report = json.loads(greedy.process.communicate(timeout=ROUND_SECONDS)[0])
        wrong = [row["what"] for row in mismatches(report) if row["what"] not in OF_COUNTERS]
        self.assertEqual([what for what in wrong if not what.startswith("rejected: ")], [])

    def test_one_robot_that_floods_a_small_disk_is_held_back_alone(self):
        process = self.running.process
        self.campaign.wait_for_more(200)
        self.assertNotIn("store_space", self.degraded())
        self.assertGreater(self.running.metric("uplinkd_store_free_bytes"), FREE_MIN_MIB * MIB)
        self.assertEqual(self.running.metric("uplinkd_store_free_min_bytes"), FREE_MIN_MIB * MIB)
        self.assertEqual(self.running.metric("uplinkd_store_disk_bytes"), DISK_MIB * MIB)

        greedy = self.flood()
        self.assertRegex(self.running.text(), rf"store_space_(scarce|limits) .*{GREEDY}")
        # The others go on, though no space was made.
        self.campaign.wait_for_more(500)
        # It comes and goes: the greedy one stores a record now and then, at the median's rate.
        held = {ruri for ruri, why in self.held_back().items() if why == "disk"}
        self.assertLessEqual(held, {f"{GREEDY}/robot-0001"})
        self.assertEqual(self.running.metric("uplinkd_store_stopped"), 0)

        # Of a WAL that is longer than usual, the rest counts as free.
        self.disk.leave(process, (STOP_MIB - 2) * MIB)
        self.wait_for(lambda: self.running.metric("uplinkd_store_stopped") == 1, "nothing is stored")
        self.wait_for(lambda: set(self.held_back().values()) == {"disk"}, "all are held back")
        self.assertNotIn("store", self.degraded())
        greedy.process.send_signal(signal.SIGINT)

        self.disk.make_space(process)
        self.wait_for(lambda: "store_space_enough" in self.running.text(), "there is space")
        self.campaign.wait_for_more(500)
        self.wait_for(lambda: "disk" not in self.held_back().values(), "no robot is held back")
        self.assert_nothing_is_lost(greedy)
        self.assertNotIn("store_fails", self.running.text())


class WalHeld(EndToEnd):
    """Another program reads an old state of the store for long."""

    def setUp(self):
        super().setUp()
        self.assertTrue(may_mount(), "a small disk needs a name space of mounts: run as root or allow user name spaces")
        self.campaign = Campaign(self.folder, "sqlite", 1)
        self.campaign.robots.pace_ms = 200
        self.open_things.append(self.campaign)
        self.running = self.campaign.server
        disk = SmallDisk(self.folder, HELD_FILLER_MIB)
        self.running.wrapper = disk.wrapper
        self.running.store_url = f"sqlite://{disk.folder}/uplinkd.db"
        self.running.settings = UNLIMITED
        self.campaign.start()
        self.campaign.store = disk.store(self.running.process)

    def hold(self):
        store = self.campaign.store
        command = [*store.inside, sys.executable, "-c", HOLD, str(store.path)]
        holder = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.addCleanup(holder.wait)
        self.addCleanup(holder.stdin.close)
        self.assertEqual(holder.stdout.readline(), "reads\n")
        self.addCleanup(holder.stdout.close)
        return holder

    def wait_for(self, condition, what):
        return wait_until(self.running.process, condition, 2 * ROUND_SECONDS, what)

    def test_the_server_stores_again_once_the_reader_is_gone(self):
        running = self.running
        self.campaign.wait_for_more(200)
        holder = self.hold()
        greedy = self.fleet(running, "--robots", 1, "--ruri-prefix", GREEDY, "--faults", 500, "--settle-for", "300s")
        self.wait_for(
            lambda: running.metric("uplinkd_store_stopped") == 1 or running.metric("uplinkd_store_failing") == 1,
            "the WAL takes the disk",
        )
        self.assertGreater(running.metric("uplinkd_store_wal_bytes"), WAL_USUAL_MIB * MIB)
        self.wait_for(lambda: running.metric("uplinkd_store_oldest_snapshot_seconds") > 0, "the reader is seen")
        greedy.process.send_signal(signal.SIGINT)

        holder.stdin.close()
        holder.wait()
        self.wait_for(
            lambda: running.metric("uplinkd_store_stopped") == 0 and running.metric("uplinkd_store_failing") == 0,
            "it stores again",
        )
        self.campaign.wait_for_more(500)
        self.wait_for(lambda: running.metric("uplinkd_store_oldest_snapshot_seconds") == 0, "the reader is gone")
        greedy.process.communicate(timeout=ROUND_SECONDS)
        self.campaign.compare()
        self.assertTrue(self.campaign.clean(), "\n".join([self.campaign.line(), *self.campaign.wrong]))


if __name__ == "__main__":
    unittest.main()
