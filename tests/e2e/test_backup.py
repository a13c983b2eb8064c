"""A copy that was taken under load serves, after the store itself is gone: by the commands of the page."""

import re
import subprocess
import textwrap
import unittest

from chaos import Campaign
from chaos_stores import durable
from harness import BIN, SOURCE, EndToEnd, uplinkctl

PAGE = SOURCE / "docs/operate/backup.md"
SET_UP = SOURCE / "docs/operate/postgresql.md"
BLOCK = re.compile(r"^ *```\n(.*?)^ *```$", re.MULTILINE | re.DOTALL)
URL = re.compile(r"postgresql://(\w+)@db\.example\.org/uplinkd")
COMMAND_SECONDS = 120


def commands(page, heading):
    """The lines that an operator copies from this section."""
    section = page.read_text(encoding="utf-8").split(f"\n## {heading}\n", 1)[1].split("\n## ", 1)[0]
    found = [line for block in BLOCK.findall(section) for line in textwrap.dedent(block).strip().splitlines()]
    assert found, f"{heading} has no commands: the pattern is out of date"
    return found


class Backup(EndToEnd):
    def setUp(self):
        super().setUp()
        (self.folder / "backup").mkdir()

    def run_line(self, line, **others):
        # Without a terminal a program reads passwords from its input.
        done = subprocess.run(
            ["bash", "-eu", "-c", line], cwd=self.folder, capture_output=True, text=True, timeout=COMMAND_SECONDS,
            start_new_session=True, check=False, **others,
        )  # fmt: skip
        self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}\n{done.stderr}")
        return done.stdout

    def take_and_restore(self, campaign, take, restore):
        """What was acked after the copy was taken is lost with the store; nothing else is."""
        campaign.start()
        campaign.wait_for_more(500)
        at_least = dict(campaign.robots.acked())
        take()
        campaign.wait_for_more(500)
        campaign.robots.kill()
        lost_from = {}

        def stop():
            campaign.server.terminate(60)
            lost_from.update(campaign.robots.acked())

        restore(stop, campaign.start)
        campaign.wait_for_more(500)
        campaign.robots.kill()
        campaign.server.terminate(60)
        acked = campaign.robots.acked()
        listed = ", ".join(f"('rcan://chaos/robot-{robot:03}', {t})" for robot, t in lost_from.items())
        for robot, row in enumerate(campaign.store.rows(listed)):
            _, t, cursor, n, numbers, kept, wrong, top, *_, gaps = row
            self.assertEqual((n, wrong), (numbers, 0), "a row doubled, or not what its number says")
            self.assertGreaterEqual(kept, durable(at_least[robot]), "what was acked before the copy is there")
            # The robot went on above all that it was told is durable, and that is all there.
            self.assertGreaterEqual(cursor, acked[robot] - 1)
            self.assertEqual(top, cursor)
            self.assertEqual(numbers - kept, durable(cursor) - durable(t))
            self.assertEqual(gaps, 0, "no list shows what is lost")

    def campaign(self, store):
        campaign = Campaign(self.folder, store, 1)
        self.open_things.append(campaign)
        return campaign

    def test_a_dump_of_postgres(self):
        campaign = self.campaign("postgres")
        cluster = campaign.store.cluster
        (self.folder / "uplinkd.password").write_text("uplinkd\n", encoding="utf-8")

        def run_here(line, **others):
            line = URL.sub(lambda found: f"'{cluster.url(found.group(1))}'", line)
            line = line.replace("-h db.example.org", f"-h {cluster.place['folder']} -p {cluster.place['port']}")
            return self.run_line(line.replace("uplinkctl ", f"{BIN / 'uplinkctl'} "), **others)

        def take():
            for line in commands(PAGE, "How do I back up PostgreSQL?"):
                run_here(line)

        def restore(stop, start):
            stop()
            drop, *rest = commands(PAGE, "How do I restore PostgreSQL?")
            self.assertTrue(drop.startswith("dropdb "))
            run_here(drop)
            # An empty server: it has no roles of ours either.
            cluster.sql("DROP ROLE uplinkd; DROP ROLE uplinkd_owner", "postgres")
            run_here(drop)
            for line in commands(SET_UP, "Set it up"):
                if line.startswith(("createuser ", "createdb ")):
                    run_here(line, input="uplinkd\nuplinkd\n")
            for line in rest:
                run_here(line)
            start()

        self.take_and_restore(campaign, take, restore)

    def run_of_sqlite(self, line):
        for there, here in (
            ("/var/lib/uplinkd/", f"{self.folder}/"),
            ("/backup/", f"{self.folder}/backup/"),
            ("$(date +%F)", "2026-11-27"),
            ("-o uplinkd -g uplinkd ", ""),
        ):
            line = line.replace(there, here)
        return self.run_line(line)

    def take_sqlite(self):
        said = [self.run_of_sqlite(line) for line in commands(PAGE, "How do I back up SQLite?")]
        self.assertEqual(said[-1], "ok\n")

    def restore_sqlite(self, stop, start):
        steps = {"systemctl stop uplinkd": stop, "systemctl start uplinkd": start}
        look, *rest = commands(PAGE, "How do I restore SQLite?")
        self.assertEqual(self.run_of_sqlite(look), "ok\n")
        for line in rest:
            if line in steps:
                steps.pop(line)()
            else:
                self.run_of_sqlite(line)
        self.assertEqual(steps, {})
        self.assertTrue((self.folder / "old/uplinkd.db").exists(), "the old store is put aside")

    def test_without_the_backup_nothing_of_the_old_store_is_lost(self):
        server = self.server().start()
        robots = self.fleet(server, "--robots", 2)
        server.wait_for_status(lambda status: status["streams"] == "2", 30, "both stream")
        self.assert_agrees(robots)
        server.kill()
        look, *rest = commands(PAGE, "How do I restore SQLite?")
        with self.assertRaisesRegex(AssertionError, "unable to open database"):
            self.run_of_sqlite(look)
        for line in rest:
            if line.startswith("install "):
                with self.assertRaisesRegex(AssertionError, "No such file"):
                    self.run_of_sqlite(line)
            elif not line.startswith("systemctl "):
                self.run_of_sqlite(line)
        for path in (self.folder / "old").iterdir():
            path.rename(self.folder / path.name)
        server.start()
        self.assertEqual(len(server.get("/api/v1/robots")["robots"]), 2)

    def test_a_copy_of_sqlite(self):
        self.take_and_restore(self.campaign("sqlite"), self.take_sqlite, self.restore_sqlite)

    def test_a_robot_that_was_removed_since_is_back(self):
        server = self.server().start()
        robots = self.fleet(server, "--robots", 2)
        server.wait_for_status(lambda status: status["streams"] == "2", 30, "both stream")
        self.assert_agrees(robots)
        server.wait_for_status(lambda status: status["streams"] == "0", 30, "both left")
        self.take_sqlite()

        def listed():
            return {row["ruri"] for row in server.get("/api/v1/robots")["robots"]}

        before = listed()
        self.assertEqual(len(before), 2)
        uplinkctl("store", "forget", "--url", server.store_url, "--yes", min(before))
        self.assertEqual(listed(), {max(before)})
        self.restore_sqlite(lambda: server.terminate(60), server.start)
        self.assertEqual(listed(), before)


if __name__ == "__main__":
    unittest.main()
