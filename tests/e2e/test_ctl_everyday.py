"""The verbs of uplinkctl that an operator types every day, against a running server."""

import csv
import io
import json
import os
import pty
import re
import socket
import subprocess
import unittest

from harness import BIN, EndToEnd, run, uplinkctl, wait_until
from ports import free_port

ROBOTS = 3
PREFIX = "rcan://local.rcan/uplink/synthetic/1.0/robot-000"
WAIT_SECONDS = 60
LISTS = (
    "events", "messages", "presence", "gaps", "connections", "quarantine", "scope-updates", "faults", "missions",
    "operator-requests", "shapes", "objects",
)  # fmt: skip


class Everyday(EndToEnd):
    def setUp(self):
        super().setUp()
        self.home = self.folder / "home"
        self.home.mkdir()

    def ctl(self, *arguments, code=0, **environment):
        """uplinkctl of a user who has set only this."""
        env = {name: value for name, value in os.environ.items() if not name.startswith(("UPLINKCTL", "XDG"))}
        return uplinkctl(*arguments, code=code, env={**env, "HOME": str(self.home), **environment})

    def rows(self, *arguments):
        """The rows of a list, by its CSV."""
        return list(csv.DictReader(io.StringIO(self.ctl(*arguments, "-o", "csv").stdout)))


class Asking(Everyday):
    """A fleet that sends a few wrong messages, and has gone."""

    def setUp(self):
        super().setUp()
        self.settings = self.server()
        self.settings.start()
        fleet = self.fleet(self.settings, "--robots", ROBOTS, "--pace", 20, "--faults", 5, "--malformed-share", 0.05,
                           "--fleet", "north")  # fmt: skip
        self.settings.wait_for_status(
            lambda status: int(status["messages"]["counts"].get("stored", 0)) > 200
            and int(status["messages"]["counts"].get("rejected", 0)) > 5,
            WAIT_SECONDS, "rows are stored, and some rejected",
        )  # fmt: skip
        self.assert_agrees(fleet)
        uplinkctl("contexts", "add", "hall", "--server", f"http://{self.settings.http}",
                  env={**os.environ, "HOME": str(self.home), "XDG_CONFIG_HOME": ""})  # fmt: skip

    def test_what_a_fleet_is(self):
        status = self.ctl("status").stdout
        self.assertRegex(status, r"(?m)^does not work +nothing$")
        self.assertRegex(status, r"(?m)^messages +.*\d stored")
        self.assertEqual(json.loads(self.ctl("status", "-o", "json").stdout)["version"],
                         self.settings.get("/api/v1/status")["version"])  # fmt: skip
        table = self.ctl("robots", "list").stdout
        self.assertRegex(table, r"(?m)^ROBOT +FLEET +PRESENCE +FOR ")
        for number in range(1, ROBOTS + 1):
            self.assertRegex(table, rf"(?m)^robot-000{number} +north +(online|offline) ")
        self.assertNotIn("\x1b", table)
        self.assertEqual([row["ruri"] for row in self.rows("robots", "list")],
                         [f"{PREFIX}{number}" for number in range(1, ROBOTS + 1)])  # fmt: skip
        self.assertEqual(self.ctl("robots", "list", "--fleet", "south").stderr, "uplinkctl: nothing matches\n")
        fleets = self.rows("fleets", "list")
        self.assertEqual([(row["fleet"], row["robots"]) for row in fleets], [("north", str(ROBOTS))])
        self.ctl("robots", "top", "--by", "bytes")

    def test_each_list_answers_in_each_form(self):
        for noun in LISTS:
            with self.subTest(noun):
                before = self.as_json(noun)
                as_csv = len(self.rows(noun, "list", "--limit", 1000))
                lines = self.ctl(noun, "list", "--limit", 1000).stdout.splitlines()
                # Objects expire meanwhile.
                counts = range(self.as_json(noun), before + 1)
                self.assertIn(as_csv, counts)
                self.assertIn(max(len(lines) - 1, 0), counts)

    def as_json(self, noun):
        """How many rows the list has now."""
        document = json.loads(self.ctl(noun, "list", "-o", "json", "--limit", 1000).stdout)
        return len(next(iter(document.values())))

    def test_a_robot_has_a_short_name(self):
        robot = json.loads(self.ctl("robots", "get", "robot-0002", "-o", "json").stdout)
        self.assertEqual(robot["ruri"], f"{PREFIX}2")
        self.assertRegex(self.ctl("robots", "get", "robot-0002").stdout, r"(?m)^lastSignOfLife +\S+Z \(")
        events = self.rows("presence", "list", "--robot", "robot-0002", "--since", "1h")
        self.assertEqual({row["ruri"] for row in events}, {f"{PREFIX}2"})
        story = self.rows("robots", "story", "robot-0002")
        self.assertTrue(story)
        error = self.ctl("robots", "get", "robot-0009", code=1).stderr
        self.assertIn("there is no robot robot-0009 now", error)
        error = self.ctl("robots", "get", "robot-000", code=1).stderr
        self.assertIn(f"alike are {PREFIX}1, {PREFIX}2", error)

    def test_an_ambiguous_name_lists_its_robots(self):
        other = "rcan://local.rcan/uplink/other/2.0"
        fleet = self.fleet(self.settings, "--robots", 1, "--ruri-prefix", other)
        self.settings.wait_for_status(lambda status: sum(map(int, status["robots"].values())) > ROBOTS,
                                      WAIT_SECONDS, "one more robot")  # fmt: skip
        self.assert_agrees(fleet)
        error = self.ctl("robots", "get", "robot-0001", code=2).stderr
        self.assertIn(f"{other}/robot-0001", error)
        self.assertIn(f"{PREFIX}1", error)
        self.assertIn(other, self.ctl("robots", "get", "2.0/robot-0001").stdout)
        self.assertRegex(self.ctl("robots", "list").stdout, r"(?m)^2\.0/robot-0001 ")

    def test_what_was_rejected_is_shown_with_its_bytes(self):
        rows = json.loads(self.ctl("quarantine", "list", "-o", "json").stdout)["quarantined"]
        # One message per second and reason is kept whole.
        row = next(row for row in rows if row["payload"])
        shown = self.ctl("quarantine", "show", row["ruri"].rsplit("/", 1)[-1], "--seq", row["seq"]).stdout
        self.assertIn(row["reason"], shown)
        self.assertRegex(shown, r"(?m)^00000000  [0-9a-f]{2} ")
        self.assertRegex(shown.rsplit("\n\n", 1)[-1], r"\(|it cannot be read")
        self.ctl("quarantine", "show", "robot-0001", "--seq", 10**12, code=1)

    def test_a_run_has_its_reports(self):
        run_id = self.rows("missions", "list")[0]["runId"]
        done = json.loads(self.ctl("missions", "show", run_id, "-o", "json").stdout)
        self.assertEqual(done["runId"], run_id)
        self.assertEqual(len(done["missionReports"]), int(done["updates"]))
        self.assertRegex(self.ctl("missions", "show", run_id).stdout, r"(?m)^TIME +AGO +STATUS")
        self.assertIn("the store has no run none", self.ctl("missions", "show", "none", code=1).stderr)

    def test_a_table_fits_the_terminal_and_has_colours_there(self):
        env = {**os.environ, "HOME": str(self.home), "XDG_CONFIG_HOME": "", "TERM": "xterm"}
        leader, follower = pty.openpty()
        try:
            subprocess.run(["stty", "cols", "60", "rows", "40"], stdin=follower, check=True)
            subprocess.run([BIN / "uplinkctl", "faults", "list", "--history", "--limit", "5"], stdout=follower,
                           stderr=subprocess.DEVNULL, env=env, check=True)  # fmt: skip
            os.close(follower)
            text = b""
            while True:
                try:
                    part = os.read(leader, 65536)
                except OSError:
                    break
                text += part
                if not part:
                    break
        finally:
            os.close(leader)
        self.assertIn(b"\x1b[", text)
        plain = re.sub(r"\x1b\[[0-9;]*m", "", text.decode()).splitlines()
        self.assertEqual(len(plain), 6)
        for line in plain:
            self.assertLessEqual(len(line), 60, line)

    def test_follow_shows_what_comes(self):
        env = {**os.environ, "HOME": str(self.home), "XDG_CONFIG_HOME": ""}
        with (self.folder / "followed").open("w+", encoding="utf-8") as out:
            follower = subprocess.Popen(
                [BIN / "uplinkctl", "presence", "list", "--follow", "-o", "csv", "--since", "1h"], stdout=out, env=env
            )
            try:
                fleet = self.fleet(self.settings, "--robots", 1, "--ruri-prefix", "rcan://local.rcan/late/robots/1.0")
                path = self.folder / "followed"
                wait_until(follower, lambda: "rcan://local.rcan/late/robots" in path.read_text(encoding="utf-8"),
                           WAIT_SECONDS, "the new robot's row")  # fmt: skip
                self.assert_agrees(fleet)
            finally:
                follower.terminate()
                follower.wait(10)
        rows = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8"))))
        keys = [(row["at"], row["ruri"], row["presence"]) for row in rows]
        self.assertEqual(len(keys), len(set(keys)), "each row once")

    def test_a_wrong_question_says_what_to_write(self):
        self.assertIn("write 2h", self.ctl("events", "list", "--since", "yesterday", code=2).stderr)
        self.assertIn("batteryBelow", self.ctl("robots", "list", "--battery-below", "x", code=2).stderr)
        self.assertIn("must be one of", self.ctl("robots", "list", "--presence", "gone", code=2).stderr)

    def test_config_is_shown(self):
        rows = {row["key"]: row for row in self.rows("config", "show")}
        self.assertEqual(rows["listen.relay"]["source"], "file")
        path = self.settings.configuration()
        self.assertIn("[listen]", self.ctl("config", "show", "--config", path).stdout)
        self.assertIn("good", self.ctl("config", "check", "--config", path).stdout)

    def test_the_store_of_a_running_server_is_only_looked_at(self):
        shown = self.ctl("store", "status", "--config", self.settings.configuration()).stdout
        for line in (r"schema +((\d+) of \2|in the WAL.*)", r"server has it +yes", r"file +[\d.]+ \w+"):
            self.assertRegex(shown, f"(?m)^{line}$")


class Choosing(Everyday):
    """Which server is asked, and what an operator reads where none answers."""

    def refused(self):
        """An address on which nothing listens."""
        return f"http://127.0.0.1:{free_port()}"

    def test_a_server_that_is_down_says_where_it_was_looked_for(self):
        url = self.refused()
        for arguments, environment, source in (
            (("--server", url), {}, "that of --server"),
            ((), {"UPLINKCTL_SERVER": url}, "that of the variable UPLINKCTL_SERVER"),
        ):
            error = self.ctl("status", *arguments, code=1, **environment).stderr
            self.assertIn("Connection refused", error)
            self.assertIn(source, error)
            self.assertIn("uplinkctl contexts use", error)
        self.ctl("contexts", "add", "hall", "--server", url)
        self.assertIn("that of the context hall", self.ctl("robots", "list", code=1).stderr)

    def test_contexts_are_kept_without_secrets(self):
        self.assertIn("there is no context", self.ctl("contexts", "list").stderr)
        self.ctl("contexts", "add", "hall", "--server", "http://192.0.2.7:7480")
        self.ctl("contexts", "add", "yard", "--server", "http://192.0.2.8:7480/uplink", "--use")
        self.assertRegex(self.ctl("contexts", "list").stdout, r"(?m)^yes +yard +http://192.0.2.8:7480/uplink$")
        self.assertIn("http://192.0.2.7:7480", self.ctl("contexts", "use", "hall").stdout)
        self.assertIn("there are: hall, yard", self.ctl("status", "--context", "dock", code=2).stderr)
        error = self.ctl("contexts", "add", "x", "--server", "http://ann:secret@192.0.2.9", code=2).stderr
        self.assertNotIn("secret", error)
        file = self.home / ".config/uplinkctl/config.toml"
        self.assertEqual(file.stat().st_mode & 0o777, 0o600)
        file.write_text('token = "x"\n', encoding="utf-8")
        self.assertIn(f"{file}: token: unknown key", self.ctl("status", code=2).stderr)

    def test_a_path_that_no_proxy_takes_away_is_not_found(self):
        server = self.server().start()
        self.ctl("gaps", "list", "--server", f"http://{server.http}")
        self.assertIn("there is nothing at /x/api/v1/gaps; is", self.ctl("gaps", "list", "--server", f"http://{server.http}/x", code=1).stderr)

    def test_a_503_says_to_try_again(self):
        with socket.create_server(("127.0.0.1", 0)) as listener:
            url = f"http://127.0.0.1:{listener.getsockname()[1]}"
            asked = subprocess.Popen([BIN / "uplinkctl", "events", "list", "--server", url], stderr=subprocess.PIPE,
                                     text=True)  # fmt: skip
            connection, _ = listener.accept()
            with connection:
                connection.recv(65536)
                body = b'{"error":{"code":"UNAVAILABLE","message":"the store is away"}}'
                head = f"HTTP/1.1 503 x\r\nRetry-After: 2\r\nContent-Length: {len(body)}\r\n\r\n"
                connection.sendall(head.encode() + body)
                _, error = asked.communicate(timeout=30)
        self.assertEqual(asked.returncode, 1)
        self.assertIn("the store is away; try again in 2 s", error)


class Certificates(Everyday):
    def test_a_folder_is_listed_and_each_shown(self):
        pki = self.folder / "keys"
        self.ctl("pki", "init", "--dir", pki)
        self.ctl("pki", "server", "--dir", pki, "--host", "uplink.example.org")
        self.ctl("pki", "robot", "--dir", pki, "--name", "r1", "--fleet", "north", "--ruri", "rcan://a/b/c/1/r1")
        (pki / "odd.crt").write_text("no certificate", encoding="utf-8")
        rows = {row["name"]: row for row in self.rows("pki", "list", "--dir", pki)}
        self.assertEqual({name: row["kind"] for name, row in rows.items()},
                         {"ca": "authority", "odd": "unknown", "r1": "robot", "server": "server"})  # fmt: skip
        self.assertIn("odd.crt", rows["odd"]["why"])
        self.assertRegex(self.ctl("pki", "list", "--dir", pki).stdout, r"(?m)^r1 +robot +north +in 36[45] d +yes ")
        shown = json.loads(self.ctl("pki", "show", "--dir", pki, "r1", "-o", "json").stdout)
        self.assertEqual(shown["names"], ["rcan://a/b/c/1/r1"])
        serial = run("openssl", "x509", "-in", pki / "r1.crt", "-noout", "-serial").stdout
        self.assertEqual(f"serial={shown['serial']}\n", serial)
        self.assertIn("pki list", self.ctl("pki", "show", "--dir", pki, "r2", code=1).stderr)
        self.assertIn("name the folder by --dir", self.ctl("pki", "list", "--dir", pki / "none", code=1).stderr)


if __name__ == "__main__":
    unittest.main()
