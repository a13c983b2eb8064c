"""uplinkd and uplinkctl on a PostgreSQL cluster of their own."""

import os
import time
import unittest
import urllib.request

from harness import BIN, Cluster, EndToEnd, Fleet, Server, run, uplinkctl, wait_until

# Robots that die while sessions with the database end so often, and how long the row with their offline may
# take then: presence.timeout (10 s), the sweep after it (1 s), a commit that is tried again, and a busy machine.
DEAD = 3
SESSION_SECONDS = 2
OFFLINE_SECONDS = 18
# By the number in the table.
ONLINE, OFFLINE = 1, 2
END_SESSIONS = (
    "SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity WHERE application_name LIKE 'uplinkd%'"
)


class Schema(EndToEnd):
    def setUp(self):
        super().setUp()
        self.cluster = Cluster(self.folder, "fsync = off\nmax_prepared_transactions = 1").create()
        self.open_things.append(self.cluster)

    def start_that_fails(self, *text, **environment):
        """A server that ends with 1 and says all of `text`."""
        path = self.server().configuration()
        done = run(BIN / "uplinkd", "--config", path, code=1, env=dict(os.environ, **environment))
        for part in text:
            self.assertIn(part, done.stdout + done.stderr)

    def server(self, settings=""):
        server = Server(self.folder, settings, self.cluster.url("uplinkd"))
        self.open_things.append(server)
        return server

    def test_the_owner_migrates_and_the_server_only_serves(self):
        owner = self.cluster.url("uplinkd_owner")
        self.assertIn("schema          0 of ", uplinkctl("store", "status", "--url", owner, code=1).stdout)
        self.start_that_fails("uplinkctl store migrate", UPLINKD_STORE_ACCEPT_UNSAFE="true")
        denied = uplinkctl("store", "migrate", "--url", self.cluster.url("uplinkd"), code=1)
        self.assertIn("permission denied", denied.stderr)
        applied = uplinkctl("store", "migrate", "--url", owner, "--grant-to", "uplinkd").stdout
        self.assertIn("applied 0001_schema", applied)
        self.assertIn("granted to uplinkd", applied)
        status = uplinkctl("store", "status", "--url", self.cluster.url("uplinkd")).stdout
        self.assertIn("server          PostgreSQL ", status)
        self.assertIn("fsync           no", status)
        self.assertIn("nothing to apply", uplinkctl("store", "migrate", "--url", owner).stdout)

    def test_a_newer_schema_that_shuts_the_program_out_is_refused(self):
        self.cluster.migrate()
        self.cluster.sql("INSERT INTO uplinkd.schema_migrations VALUES (99, 99, 'later', 'sum')")
        self.start_that_fails("run a newer uplinkd", UPLINKD_STORE_ACCEPT_UNSAFE="true")
        status = uplinkctl("store", "status", "--url", self.cluster.url("uplinkd"), code=1)
        self.assertIn("run a newer uplinkd", status.stderr)
        self.assertRegex(status.stdout, r"\nschema          99 \(this program knows \d+; may not use it\)\n")
        self.cluster.sql("UPDATE uplinkd.schema_migrations SET oldest = 1 WHERE version = 99")
        status = uplinkctl("store", "status", "--url", self.cluster.url("uplinkd")).stdout
        self.assertRegex(status, r"\nschema          99 \(this program knows \d+; may use it\)\n")
        self.cluster.sql("ALTER TABLE uplinkd.schema_migrations DROP COLUMN oldest")
        status = uplinkctl("store", "status", "--url", self.cluster.url("uplinkd"), code=1)
        self.assertRegex(status.stdout, r"\nschema          99 \(this program knows \d+; may not use it\)\n")
        self.assertIn("made by an earlier build", status.stderr)

    def test_fsync_off_is_refused_unless_it_is_accepted(self):
        self.cluster.migrate()
        self.start_that_fails("fsync = off", "store.accept_unsafe")
        server = Server(self.folder, "accept_unsafe = true", self.cluster.url("uplinkd")).start()
        self.open_things.append(server)
        server.wait_for_line("store_unsafe")
        self.assertIn("store_unsafe", server.get("/readyz")["degraded"])
        with urllib.request.urlopen(f"http://{server.http}/metrics", timeout=10) as page:
            text = page.read().decode()
        self.assertIn("uplinkd_store_unsafe 1\n", text)
        self.assertIn('uplinkd_degraded{reason="store_unsafe"} 1\n', text)
        self.assertIn('uplinkd_degraded{reason="journal_backlog"} 0\n', text)
        self.assertIn('uplinkd_journal_shard_oldest_seconds{shard="0"} ', text)
        self.assertEqual(server.terminate(30), 0)

    def test_an_old_snapshot_is_seen(self):
        self.cluster.migrate()
        server = self.server("accept_unsafe = true").start()
        self.cluster.sql("BEGIN; SELECT txid_current(); PREPARE TRANSACTION 'left'")

        def age():
            self.cluster.sql("SELECT txid_current()")  # a transaction that would be cleaned up after
            return server.metric("uplinkd_store_oldest_snapshot_seconds")

        wait_until(server.process, lambda: age() > 0, 60, "the prepared transaction is seen")
        self.cluster.sql("ROLLBACK PREPARED 'left'")
        wait_until(server.process, lambda: age() == 0, 60, "it is gone")
        self.assertNotIn("store_old_snapshot", server.text(), "it was not that old")

    def test_a_read_only_database_is_refused(self):
        self.cluster.migrate()
        self.cluster.sql("ALTER DATABASE uplinkd SET default_transaction_read_only = on")
        self.start_that_fails("read-only", UPLINKD_STORE_ACCEPT_UNSAFE="true")

    def test_a_parameter_that_the_server_refuses_ends_the_start(self):
        self.cluster.migrate()
        url = self.cluster.url("uplinkd") + "&options=-c%20geqo%3Dperhaps"
        self.start_that_fails("geqo", "22023", "store.url", UPLINKD_STORE_URL=url, UPLINKD_STORE_ACCEPT_UNSAFE="true")

    def test_a_database_that_is_not_there_says_what_to_do(self):
        nowhere = self.cluster.url("uplinkd", "none_such")
        said = "(3D000); create the database, or correct its name in the URL"
        self.assertIn(said, uplinkctl("store", "status", "--url", nowhere, code=1).stderr)
        self.start_that_fails("none_such", said, UPLINKD_STORE_URL=nowhere, UPLINKD_STORE_ACCEPT_UNSAFE="true")

    def test_wrong_use_ends_with_2(self):
        url = self.cluster.url("uplinkd")
        for flags, text in (
            (["store", "status"], "give either --config or --url"),
            (["store", "status", "--url", url, "--config", "x"], "give either --config or --url"),
            (["store", "migrate", "--url", "sqlite:///x.db"], "the server migrates it when it starts"),
            (["store", "status", "--url", "foo"], "the URL is of no store"),
            (["store", "migrate", "--url", "foo"], "the URL is of no store"),
            (["store", "status", "--url", url + "&colour=red"], "colour"),
            (["store", "migrate", "--url", "postgresql://me:secret@db/x"], "password_file"),
        ):
            with self.subTest(flags):
                done = uplinkctl(*flags, code=2)
                self.assertIn(text, done.stdout + done.stderr)
                self.assertNotIn("secret", done.stdout + done.stderr)


class Crashes(EndToEnd):

    def test_sessions_that_end_every_two_seconds_keep_no_dead_robot_from_offline(self):
        cluster = Cluster(self.folder).create().migrate()
        self.open_things.append(cluster)
        server = Server(self.folder, store_url=cluster.url("uplinkd")).start()
        self.open_things.append(server)
        fleet = Fleet(server, "--robots", DEAD, "--pace", "2")
        self.open_things.append(fleet)

        def stored(presence):
            return int(cluster.sql(f"SELECT count(*) FROM uplinkd.presence_latest WHERE presence = {presence}"))

        wait_until(server.process, lambda: stored(ONLINE) == DEAD, 60, "the robots are online")
        fleet.process.kill()
        died = ended = time.monotonic()
        sessions = 0

        def all_are_offline():
            nonlocal ended, sessions
            if time.monotonic() - ended > SESSION_SECONDS:
                ended = time.monotonic()
                sessions += int(cluster.sql(END_SESSIONS, "postgres"))
            return stored(OFFLINE) == DEAD

        wait_until(server.process, all_are_offline, 60, "the dead robots are offline")
        self.assertLess(time.monotonic() - died, OFFLINE_SECONDS)
        self.assertGreater(sessions, 4, "those of writers and of the lease, again and again")


if __name__ == "__main__":
    unittest.main()
