"""What operators decide, by HTTP and by uplinkctl, and the audit of it."""

import concurrent.futures
import http.client
import json
import os
import unittest
import urllib.error
import urllib.request

from harness import EndToEnd, uplinkctl, wait_until
from ports import free_port

WAIT_SECONDS = 60
ROBOT = "rcan://example.org/acme/rover/1.0/r17"
KEY = "a" * 64


def post(server, path, body=None, headers=None):
    """Status and JSON of a command."""
    data = b"" if body is None else json.dumps(body).encode()
    kind = {} if body is None else {"Content-Type": "application/json"}
    asked = urllib.request.Request(f"http://{server.http}{path}", data=data, method="POST",
                                   headers={**kind, **(headers or {})})  # fmt: skip
    if body is None:
        # urllib's own, of a form.
        asked.add_header("Content-Type", "application/json")
    try:
        with urllib.request.urlopen(asked, timeout=WAIT_SECONDS) as answer:
            return answer.status, json.load(answer)
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.loads(error.read())


class Commands(EndToEnd):
    def ctl(self, *arguments, code=0):
        env = {name: value for name, value in os.environ.items() if not name.startswith(("UPLINKCTL", "XDG"))}
        return uplinkctl(*arguments, code=code, env={**env, "HOME": str(self.folder)})

    def audit(self, server):
        return server.get("/api/v1/audit?orderBy=oldest")["audit"]

    def actions(self, server):
        return [(row["action"], row["outcome"]) for row in self.audit(server)]

    def wait_for_action(self, server, action):
        wait_until(server.process, lambda: action in [each for each, _ in self.actions(server)], WAIT_SECONDS, action)

    def test_what_is_decided_is_in_the_audit(self):
        server = self.server().start()
        status, setting = post(server, f"/api/v1/robot/block?ruri={ROBOT}", {"reason": "stolen"})
        self.assertEqual((status, setting["blocked"], setting["blockedWhy"]), (200, True, "stolen"))
        self.assertEqual(post(server, "/api/v1/robot/block", {"ruri": "nothing"})[0], 400)
        self.assertEqual(post(server, f"/api/v1/robot/note?ruri={ROBOT}", {"labels": {"site": "hall2"}})[0], 200)
        self.assertEqual(post(server, "/api/v1/certificates/revoke", {"keySha256": KEY, "reason": "lost"})[0], 200)
        self.assertEqual(post(server, "/api/v1/faults/acknowledge", {"ruri": ROBOT, "faultId": "x"})[0], 404)
        self.wait_for_action(server, "fault_acknowledge")
        actions = self.actions(server)
        self.assertIn(("server_start", "ok"), actions)
        self.assertIn(("robot_block", "INVALID_ARGUMENT"), actions)
        self.assertIn(("robot_block", "ok"), actions)
        self.assertIn(("certificate_revoke", "ok"), actions)
        self.assertIn(("fault_acknowledge", "NOT_FOUND"), actions)
        [revoked] = server.get("/api/v1/certificates/revocations")["revocations"]
        self.assertEqual((revoked["keySha256"], revoked["reason"], revoked["by"]), (KEY, "lost", "local"))
        self.assertIn(" audit who=local ", server.text())

    def test_pages_of_other_sites_change_nothing(self):
        server = self.server().start()
        path = f"/api/v1/robot/block?ruri={ROBOT}"
        for headers in ({"Origin": "https://evil.example"}, {"Sec-Fetch-Site": "cross-site"}):
            self.assertEqual(post(server, path, {}, headers)[0], 403)
        beside = {"Origin": f"http://{server.http.rsplit(':', 1)[0]}:1"}
        for headers in (beside, {"Sec-Fetch-Site": "same-site"}):
            self.assertEqual(post(server, path, {}, headers)[0], 403)
        asking = http.client.HTTPConnection(server.http, timeout=WAIT_SECONDS)
        self.addCleanup(asking.close)
        asking.request("POST", path)
        untyped = asking.getresponse()
        self.assertEqual(untyped.status, 415)
        self.assertIn("Content-Type: application/json", untyped.read().decode())
        form = urllib.request.Request(f"http://{server.http}{path}", data=b"a=b", method="POST")
        with self.assertRaises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(form, timeout=WAIT_SECONDS)
        with refused.exception:
            self.assertEqual(refused.exception.code, 415)
        self.assertNotIn("robot_block", [action for action, _ in self.actions(server)])

    def test_uplinkctl_does_the_same_with_and_without_a_server(self):
        server = self.server()
        # That the file names, so that it can be asked whether a server runs.
        server.http = f"127.0.0.1:{free_port()}"
        server.start()
        file = str(self.folder / "uplinkd.toml")
        at = ("--server", f"http://{server.http}")
        shown = json.loads(self.ctl("robots", "block", ROBOT, "--reason", "stolen", "-o", "json", *at).stdout)
        self.assertTrue(shown["blocked"])
        self.ctl("certificates", "revoke", "--key-sha256", KEY, *at)
        self.assertIn(KEY, self.ctl("certificates", "revoked", *at).stdout)
        self.assertIn("robot_block", self.ctl("audit", "list", *at).stdout)
        self.assertIn("NAME=VALUE", self.ctl("robots", "note", ROBOT, "--label", "site", *at, code=2).stderr)
        self.assertEqual(server.terminate(60), 0)

        without = self.ctl("robots", "unblock", ROBOT, "-o", "json", "--config", file)
        self.assertFalse(json.loads(without.stdout)["blocked"])
        self.assertIn("no server answers", without.stderr)
        short = self.ctl("robots", "unblock", "r17", "--config", file, code=1)
        self.assertIn("takes the robot's whole RURI in place of r17", short.stderr)
        self.ctl("certificates", "unrevoke", "--key-sha256", KEY, "--config", file)
        listed = json.loads(self.ctl("audit", "list", "--config", file, "-o", "json", "--oldest").stdout)
        told = [(row["action"], row["proof"]) for row in listed["audit"]]
        done = [("robot_unblock", "store"), ("certificate_unrevoke", "store")]
        self.assertEqual(told[-3:], [("server_stop", "server"), *done])
        only = self.ctl("audit", "list", "--config", file, "--target", ROBOT, "--since", "1h", "--limit", "1")
        self.assertIn("robot_unblock", only.stdout)
        self.assertNotIn("robot_block", only.stdout)
        self.assertIn("no server answers", only.stderr)
        twin = self.ctl("robots", "disconnect", "rcan://local.rcan/cyberwave/twin/a", "--config", file, code=1)
        self.assertIn("has no stream that could end", twin.stderr)
        self.assertNotIn("try again", twin.stderr)

        server.start()
        self.assertEqual(server.get("/api/v1/certificates/revocations")["revocations"], [])
        proofs = {(row["action"], row["proof"]) for row in self.audit(server)}
        self.assertLessEqual({("robot_block", "local"), ("robot_unblock", "store"), ("server_stop", "server")}, proofs)

    def test_a_caller_who_floods_is_refused_and_admins_and_uplinkctl_are_not(self):
        server = self.server().start()
        self.assertEqual(post(server, "/api/v1/robot/note", {"ruri": ROBOT, "note": "same"})[0], 200)

        def note(_):
            return post(server, "/api/v1/robot/note", {"ruri": ROBOT, "note": "same"})

        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            answers = list(pool.map(note, range(200)))
        refused = [answer for status, answer in answers if status == 429]
        self.assertGreater(len(refused), 0)
        self.assertIn("5 commands about robots per second, 20 at once", refused[0]["error"]["message"])
        self.assertEqual({status for status, _ in answers}, {200, 429})
        self.assertGreaterEqual(server.metric(r'uplinkd_http_denied_total\{why="rate"\}'), len(refused))
        # What changed nothing left no row.
        self.assertEqual(self.actions(server).count(("robot_note", "ok")), 1)
        for number in range(100):
            self.assertEqual(post(server, "/api/v1/certificates/revoke", {"sha256": f"{number:064x}"})[0], 200)
        at = ("--server", f"http://{server.http}")
        for _ in range(25):
            self.ctl("robots", "disconnect", ROBOT, *at)

    def test_a_reload_says_what_it_took_over(self):
        server = self.server('[log]\nlevel = "info"').start()
        at = ("--server", f"http://{server.http}")
        server.settings = '[log]\nlevel = "debug"\n[presence]\ntimeout = "11s"'
        server.configuration()
        answer = json.loads(self.ctl("reload", "-o", "json", *at).stdout)
        # The server may have seen the change before.
        self.assertIn((answer["takenOver"], answer["problems"]), ((["log.level"], []), ([], [])))
        server.wait_for_line("reloaded taken_over=log.level")
        self.assertIn("presence.timeout", answer["needsRestart"])
        server.settings = '[log]\nlevel = "loud"'
        server.configuration()
        refused = self.ctl("reload", *at, code=1)
        self.assertIn("nothing was taken over", refused.stderr)

    def test_a_changed_file_is_read(self):
        server = self.server('[log]\nlevel = "info"').start()
        server.settings = '[log]\nlevel = "warn"'
        server.configuration()
        server.wait_for_line("reloaded taken_over=log.level")
        server.settings += '\n[view]\nwatch_interval = "1s"'
        server.configuration()
        server.wait_for_line("reloaded taken_over=view.watch_interval")
        self.wait_for_action(server, "reload")


if __name__ == "__main__":
    unittest.main()
