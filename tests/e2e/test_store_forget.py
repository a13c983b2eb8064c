"""`uplinkctl store forget` beside real servers, on both stores."""

import os
import subprocess
import unittest
from pathlib import Path

from harness import BIN, Cluster, EndToEnd, Fleet, Server, uplinkctl, wait_until

DEADLINE_SECONDS = 60
ROBOTS = 3
SETTINGS = """
[presence]
timeout = "2s"
startup_grace = "0"
"""


class StoreForget(EndToEnd):
    def keep(self, thing):
        self.open_things.append(thing)
        return thing

    def robots(self, server, query=""):
        answer = server.get(f"/api/v1/robots?pageSize=1000{query}") or {}
        return {robot["ruri"]: robot for robot in answer.get("robots", [])}

    def wait_for(self, server, condition, what):
        return wait_until(server.process, condition, DEADLINE_SECONDS, f"{what}\n{server.text()[-2000:]}", 0.1)

    def stream(self, server, seed=1):
        fleet = self.keep(Fleet(server, "--robots", ROBOTS, "--ruri-prefix", "rcan://forget", "--seed", seed))
        server.wait_for_status(lambda status: status["streams"] == str(ROBOTS), DEADLINE_SECONDS, "all stream")
        self.wait_for(server, lambda: len(self.robots(server, "&presence=online")) == ROBOTS, "all are heard")
        return fleet

    def forget(self, *arguments, code=0):
        return uplinkctl("store", "forget", "--url", self.url, *arguments, code=code)

    def comes_back_after_its_removal(self, server, ruri):
        """uplinkctl says so. False if the agent was too fast or too slow for that: then it is tried again."""
        done = subprocess.run(
            [BIN / "uplinkctl", "store", "forget", "--url", self.url, "--yes", "--end-stream", ruri],
            capture_output=True, text=True, check=False, timeout=60,
        )  # fmt: skip
        if "removed, then came back" in done.stdout:
            self.assertEqual(done.returncode, 0, done.stderr)
            return True
        if done.returncode == 0:
            # It dialled later than uplinkctl looks. The next try ends the stream of its return.
            self.assertIn("forgotten", done.stdout)
            self.wait_for(server, lambda: ruri in self.robots(server, "&presence=online"), "it is back")
        else:
            self.assertRegex(done.stderr, "the robot spoke meanwhile|nothing of")
        return False

    def rows_of(self, ruri):
        """The tables that have rows of it, as uplinkctl names them."""
        done = subprocess.run([BIN / "uplinkctl", "store", "forget", "--url", self.url, ruri], input="no\n",
                              capture_output=True, text=True, check=False, timeout=60)  # fmt: skip
        self.assertEqual(done.returncode, 1, done.stderr)
        lines = done.stdout.splitlines()
        # A checkpoint writes live states when it is due.
        tables = [line.split()[0] for line in lines if line.startswith("  ")]
        return [table for table in tables if table != "live"], done

    def a_robot_is_forgotten(self, server):
        fleet = self.stream(server)
        ruris = sorted(self.robots(server))
        done = self.forget("--yes", ruris[0], code=1)
        self.assertIn("has a stream", done.stderr)
        self.assertIn(ruris[0], self.robots(server))
        fleet.finish()
        server.wait_for_status(lambda status: status["streams"] == "0", DEADLINE_SECONDS, "all left")

        # Asked first, and a no changes nothing.
        tables, done = self.rows_of(ruris[0])
        self.assertIn("nothing was deleted", done.stdout)
        for table in ("robots", "sessions", "latest", "presence_changes"):
            self.assertIn(table, tables)
        self.assertIn(ruris[0], self.robots(server))
        others, _ = self.rows_of(ruris[1])

        self.assertIn("forgotten", self.forget("--yes", ruris[0]).stdout)
        self.wait_for(server, lambda: sorted(self.robots(server)) == ruris[1:], "the server follows")
        server.wait_for_line("forget_answered")
        self.assertIn("nothing of", self.forget("--yes", ruris[0], code=1).stderr)
        self.assertEqual(self.rows_of(ruris[1])[0], others)

        # It is there again when it speaks, as a new one; what it sends is stored once.
        fleet = self.stream(server, seed=2)
        self.assertEqual(sorted(self.robots(server)), ruris)
        return fleet, ruris

    def test_a_store_that_a_server_has_is_not_written_by_another_name(self):
        server = self.server(SETTINGS).start()
        self.stream(server).finish()
        ruri = sorted(self.robots(server))[0]
        link = self.folder / "link.db"
        os.link(self.folder / "uplinkd.db", link)
        for url in (f"sqlite://{link}", server.store_url):
            self.url = url
            clock = uplinkctl("store", "clock", "--confirm", "--yes", "--url", url, code=1)
            for done in (clock, self.forget("--yes", ruri, code=1)):
                self.assertIn(f"{url.removeprefix('sqlite://')} has 2 names (hard links)", done.stderr)
        self.assertFalse((self.folder / "link.db-wal").exists())
        link.unlink()
        self.assertIn("forgotten", self.forget("--yes", ruri).stdout)
        self.assertEqual(server.terminate(60), 0)
        server.start()
        self.assertEqual(len(self.robots(server)), ROBOTS - 1)

    def test_a_robot_is_forgotten_beside_a_server_on_sqlite(self):
        server = self.server(SETTINGS).start()
        self.url = server.store_url
        fleet, ruris = self.a_robot_is_forgotten(server)
        # With its stream, which ends; the others do not notice, and it comes back.
        self.wait_for(server, lambda: self.comes_back_after_its_removal(server, ruris[2]), "uplinkctl sees its return")
        server.wait_for_status(lambda status: status["streams"] == str(ROBOTS), DEADLINE_SECONDS, "it is back")
        self.assertEqual(sorted(self.robots(server)), ruris)
        self.wait_for(server, lambda: f" robot_removed ruri={ruris[2]} came_back=" in server.text(), "the log says so")
        fleet.finish()
        self.assertEqual(server.terminate(DEADLINE_SECONDS), 0)
        # Without a server.
        self.assertIn("no server", self.forget("--yes", ruris[1]).stdout)
        server.start()
        self.assertEqual(sorted(self.robots(server)), [ruris[0], ruris[2]])

    def test_a_lock_that_cannot_be_opened_is_named_and_nothing_is_waited_for(self):
        server = self.server(SETTINGS).start()
        self.url = server.store_url
        fleet = self.stream(server)
        ruri = min(self.robots(server))
        fleet.finish()
        self.assertEqual(server.terminate(DEADLINE_SECONDS), 0)
        lock = Path(self.url.removeprefix("sqlite://") + ".lock")
        lock.unlink()
        lock.mkdir()
        done = self.forget("--yes", ruri, code=1)
        self.assertIn(str(lock), done.stderr)
        self.assertNotIn("did not let go", done.stderr)
        lock.rmdir()
        self.assertIn("forgotten", self.forget("--yes", ruri).stdout)

    def test_a_robot_is_forgotten_beside_two_servers_on_postgres(self):
        cluster = self.keep(Cluster(self.folder).create().migrate())
        self.url = cluster.url("uplinkd")
        servers = []
        for name in "AB":
            folder = self.folder / name
            folder.mkdir()
            if servers:
                (folder / "pki").symlink_to(servers[0].pki)
            servers.append(self.keep(Server(folder, SETTINGS, cluster.url("uplinkd"))).start())
        fleet, ruris = self.a_robot_is_forgotten(servers[0])
        self.wait_for(servers[1], lambda: sorted(self.robots(servers[1])) == ruris, "the other shows them")
        fleet.finish()
        servers[0].wait_for_status(lambda status: status["streams"] == "0", DEADLINE_SECONDS, "all left")
        self.assertIn("forgotten", self.forget("--yes", ruris[1]).stdout)
        for server in servers:
            self.wait_for(server, lambda server=server: ruris[1] not in self.robots(server), "both follow")
        # The holder is gone: there is no server to ask.
        self.assertEqual(servers[1].terminate(DEADLINE_SECONDS), 0)
        self.assertEqual(servers[0].terminate(DEADLINE_SECONDS), 0)
        self.assertIn("no server", self.forget("--yes", ruris[0]).stdout)
        servers[1].start()
        self.assertEqual(sorted(self.robots(servers[1])), [ruris[2]])

    def test_a_robot_that_a_start_left_out_is_forgotten_beside_the_server_on_sqlite(self):
        server = self.server(SETTINGS).start()
        self.url = server.store_url
        self.stream(server).finish()
        ruris = set(self.robots(server))
        self.assertEqual(server.terminate(DEADLINE_SECONDS), 0)
        server.settings += "[limits]\nrobots_max = 1\n"
        server.start()
        left_out = ruris - set(self.robots(server))
        self.assertEqual(len(left_out), ROBOTS - 1)
        # Their rows name a process that is gone, and the file has a server: it answers for them.
        for ruri in left_out:
            self.assertIn("forgotten", self.forget("--yes", ruri).stdout)
            self.assertIn("nothing of", self.forget("--yes", ruri, code=1).stderr)
        self.assertEqual(set(self.robots(server)), ruris - left_out)

    def test_a_robot_of_a_killed_server_is_forgotten_on_postgres(self):
        cluster = self.keep(Cluster(self.folder).create().migrate())
        self.url = cluster.url("uplinkd")
        server = self.keep(Server(self.folder, SETTINGS, self.url)).start()
        fleet = self.stream(server)
        ruris = sorted(self.robots(server))
        fleet.finish()
        server.kill()

        def heard(ago):
            cluster.sql(f"UPDATE uplinkd.processes SET renewed_at = now() - interval '{ago}'")

        heard("1 minute")
        done = self.forget("--yes", ruris[0], code=1)
        self.assertIn("did not stop in order", done.stderr)
        self.assertIn("--end-stream", done.stderr)
        self.assertIn("forgotten", self.forget("--yes", "--end-stream", ruris[0]).stdout)
        # After a day it counts as gone.
        heard("23 hours 59 minutes")
        self.assertIn("did not stop in order", self.forget("--yes", ruris[1], code=1).stderr)
        heard("24 hours 1 minute")
        done = self.forget("--yes", ruris[1])
        self.assertIn("no server", done.stdout)
        self.assertIn("forgotten", done.stdout)

    def test_a_path_that_cannot_be_looked_at_is_named(self):
        loop = self.folder / "loop.db"
        loop.symlink_to("loop.db")
        for path in (loop, self.folder / ("n" * 300)):
            self.url = f"sqlite://{path}"
            self.assertIn(str(path), self.forget("--yes", "rcan://a", code=1).stderr)

    def test_wrong_use_is_named(self):
        self.url = "mysql://a"
        self.assertIn("sqlite:///", self.forget("--yes", "rcan://a", code=2).stderr)
        self.url = f"sqlite://{self.folder}/none.db"
        self.assertIn("none.db", self.forget("--yes", "rcan://a", code=1).stderr)
        self.assertFalse((self.folder / "none.db").exists())
        self.assertIn("ruri", self.forget(code=2).stderr)
        # What the servers number their own records by is no robot.
        self.assertIn("no RURI", self.forget("--yes", "server", code=2).stderr)


if __name__ == "__main__":
    unittest.main()
