"""A store without space: acks stop, the log says where, and all goes on when there is space again."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

from chaos import Campaign
from chaos_stores import Sqlite
from harness import EndToEnd, wait_until

DISK_MIB = 40
FILLER_MIB = 30
FULL_BYTES = 8 << 20
# The name space of mounts is the server's own: nothing of it is seen outside, or left behind.
NAMESPACE = ["unshare", "--mount"] if os.geteuid() == 0 else ["unshare", "--user", "--map-root-user", "--mount"]
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

    def __init__(self, folder):
        self.folder = folder / "disk"
        self.folder.mkdir()
        script = (
            'mount -t tmpfs -o size="$1"m tmpfs "$2" && head -c "$3"M /dev/zero >"$2/filler"'
            ' && shift 3 && exec "$@"'
        )
        self.wrapper = [*NAMESPACE, "sh", "-c", script, "sh", str(DISK_MIB), str(self.folder), str(FILLER_MIB)]

    def store(self, process):
        return SqliteInside(self.folder, process.pid)

    def make_space(self, process):
        pathlib.Path(f"/proc/{process.pid}/root{self.folder}/filler").unlink()


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
        self.fill_and_free(campaign, lambda: None, lambda: disk.make_space(process), str(disk.folder))

    def test_postgres_that_reports_a_full_disk(self):
        campaign = self.campaign("postgres", 50)
        campaign.start()
        campaign.wait_for_more(200)
        sql = campaign.store.sql
        self.fill_and_free(campaign, lambda: sql(FULL), lambda: sql(SPACE), "53100", "base/16384/16385")


if __name__ == "__main__":
    unittest.main()
