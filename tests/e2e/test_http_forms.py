"""The forms in which /api answers: lines, gzip, what a client has already, the file of the API, and the configuration
in effect."""

import gzip
import http.client
import json
import signal
import unittest

from harness import EndToEnd, wait_until
from openapi import FILE
from openapi_server import LISTS, WAIT_SECONDS, Served, target

LINES = "application/x-ndjson"


def ask(server, path, method="GET", **headers):
    """Status, headers, and the body as it came."""
    connection = http.client.HTTPConnection(server.http, timeout=60)
    try:
        connection.request(method, path, headers={name.replace("_", "-"): value for name, value in headers.items()})
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()
    finally:
        connection.close()


class Lists(Served):
    def test_each_list_goes_as_lines_and_every_other_answer_as_it_is(self):
        server, fleet = self.play('[presence]\ntimeout = "1h"')
        fleet.finish()
        ruri = self.ruri(server)
        for path, operation in self.operations.items():
            if not path.startswith("/api/"):
                continue
            with self.subTest(path):
                documented = LINES in self.document.response(operation, 200)["content"]
                pages = "pageToken" in self.document.parameters(operation, "query")
                self.assertEqual(documented, pages or path in ("/api/v1/top", "/api/v1/candidates"))
                status, headers, body = ask(server, target(path, ruri), Accept=LINES)
                self.assertEqual(status, 200)
                self.assertEqual(headers["Content-Type"] == LINES, documented)
                if operation["operationId"] in LISTS:
                    self.assert_walked_alike(server, path, ruri, LISTS[operation["operationId"]])

    def assert_walked_alike(self, server, path, ruri, name):
        """Pages of lines are the rows of the JSON, and end where it ends."""
        whole = json.loads(ask(server, target(path, ruri, {"pageSize": "1000"}))[2])[name][:20]
        self.assertTrue(whole)
        walked, token = [], ""
        while len(walked) < len(whole):
            parameters = {"pageSize": "7", "pageToken": token}
            _, headers, body = ask(server, target(path, ruri, parameters), Accept=LINES)
            self.assertTrue(body.endswith(b"\n"))
            walked += [json.loads(line) for line in body.splitlines()]
            token = headers["Uplink-Next-Page-Token"]
            if token is None:
                break
        self.assertEqual(walked[: len(whole)], whole)

    def test_answers_are_zipped_for_those_who_take_it(self):
        server, fleet = self.play()
        fleet.finish()
        path = "/api/v1/events?pageSize=1000"
        plain = ask(server, path)[2]
        for taken in ("gzip", "deflate, gzip;q=0.5", "*"):
            status, headers, body = ask(server, path, Accept_Encoding=taken)
            self.assertEqual((status, headers["Content-Encoding"]), (200, "gzip"), taken)
            self.assertEqual(headers["Content-Length"], str(len(body)))
            self.assertEqual(headers["Vary"], "Accept, Accept-Encoding")
            self.assertLess(len(body), len(plain) / 2)
            self.assertEqual(gzip.decompress(body), plain)
            status, headers, nothing = ask(server, path, "HEAD", Accept_Encoding=taken)
            self.assertEqual((headers["Content-Length"], nothing), (str(len(body)), b""))
        for refused in ("", "identity", "gzip;q=0", "gzip;q=0, *", "gzip;q=7", "br", ";;,q=,="):
            _, headers, body = ask(server, path, Accept_Encoding=refused)
            self.assertIsNone(headers["Content-Encoding"], refused)
            self.assertEqual(body, plain, refused)

    def test_what_a_client_has_is_not_sent_again(self):
        server, fleet = self.play('[presence]\ntimeout = "1h"')
        fleet.finish()
        ruri = self.ruri(server)
        for path in ("/api/v1/robots", "/api/v1/robots/{ruri}", "/api/v1/robot", "/api/v1/openapi.yaml"):
            _, headers, body = ask(server, target(path, ruri))
            tag = headers["ETag"]
            for has in (tag, f'"x", {tag}', tag.removeprefix("W/"), "*"):
                for method in ("GET", "HEAD"):
                    status, headers, nothing = ask(server, target(path, ruri), method, If_None_Match=has)
                    self.assertEqual((status, headers["ETag"], nothing), (304, tag, b""), (path, has))
                    self.assertIsNone(headers["Content-Length"])
            # Gzip carries the same text.
            _, headers, _ = ask(server, target(path, ruri), Accept_Encoding="gzip")
            self.assertEqual((headers["ETag"], headers["Content-Encoding"]), (tag, "gzip"))
            for other in ('"x"', "x", '"', "W/", f"{tag[:-2]}"):
                status, _, again = ask(server, target(path, ruri), If_None_Match=other)
                self.assertEqual((status, again), (200, body), (path, other))
        before = ask(server, "/api/v1/robots")[1]["ETag"]
        self.fleet(server, "--robots", 5)
        wait_until(
            server.process,
            lambda: ask(server, "/api/v1/robots", If_None_Match=before)[0] == 200,
            WAIT_SECONDS,
            "a changed list is another",
        )
        self.assertRegex(ask(server, "/metrics")[2].decode(), r'route="robots",code="3xx"\} [1-9]')


class Server(EndToEnd):
    def test_the_file_of_the_api_is_part_of_the_program(self):
        server = self.server().start()
        status, headers, body = ask(server, "/api/v1/openapi.yaml")
        self.assertEqual((status, headers["Content-Type"]), (200, "application/yaml"))
        self.assertEqual(body, FILE.read_bytes())

    def test_the_configuration_is_what_print_config_shows_with_its_sources(self):
        server = self.server('[limits]\nrobots_max = 7\n[log]\nlevel = "info"\n[rcan]\nfields = ["robot_online"]')
        server.environment["UPLINKD_PRESENCE_TIMEOUT"] = "11s"
        server.start()
        path = server.folder / "uplinkd.toml"
        answer = json.loads(ask(server, "/api/v1/config")[2])
        self.assertEqual(answer["file"], str(path))
        keys = {f"{section['name']}.{key['key']}": key for section in answer["sections"] for key in section["keys"]}
        self.assertEqual(keys["limits.robots_max"]["value"], 7)
        self.assertEqual(keys["limits.robots_max"]["source"], "file")
        self.assertTrue(keys["limits.robots_max"]["place"].startswith(f"{path}:"))
        self.assertEqual(keys["rcan.fields"]["value"], ["robot_online"])
        timeout = keys["presence.timeout"]
        self.assertEqual((timeout["value"], timeout["source"], timeout["place"]),
                         ("11s", "environment", "UPLINKD_PRESENCE_TIMEOUT"))  # fmt: skip
        self.assertEqual((keys["drain.timeout"]["source"], keys["drain.timeout"]["place"]), ("default", ""))
        # A reload is in effect at once; what needs a restart is not.
        text = path.read_text(encoding="utf-8")
        text = text.replace("robots_max = 7", "robots_max = 8").replace('level = "info"', 'level = "debug"')
        path.write_text(text, encoding="utf-8")
        server.process.send_signal(signal.SIGHUP)

        def level():
            sections = json.loads(ask(server, "/api/v1/config")[2])["sections"]
            return {f"{one['name']}.{key['key']}": key["value"] for one in sections for key in one["keys"]}

        wait_until(server.process, lambda: level()["log.level"] == "debug", WAIT_SECONDS, "the reload is shown")
        self.assertEqual(level()["limits.robots_max"], 7)

    def test_a_server_that_ends_says_when_to_ask_again(self):
        server = self.server().start()
        server.process.send_signal(signal.SIGTERM)

        # It answers until its last robot's stream has ended, and then no longer.
        while server.process.poll() is None:
            try:
                status, headers, _ = ask(server, "/readyz")
            except (OSError, http.client.HTTPException):
                break
            self.assertEqual(headers["Retry-After"], "2" if status == 503 else None)
        self.assertEqual(server.process.wait(WAIT_SECONDS), 0)


if __name__ == "__main__":
    unittest.main()
