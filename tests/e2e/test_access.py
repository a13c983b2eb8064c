"""Who may ask what by HTTP: addresses, TLS, tokens, certificates, roles and fleets."""

import contextlib
import http.client
import json
import os
import pathlib
import re
import signal
import socket
import ssl
import stat
import subprocess
import unittest

from harness import BIN, EndToEnd, run, wait_until

WAIT_SECONDS = 30
# Linux has all of 127.0.0.0/8.
ELSEWHERE = "127.0.0.2"
FAILURES_MAX = 10
# By path: whether a viewer and an operator of one fleet, and of all, and a scraper of each, may ask.
PROBES = ("/livez", "/readyz")
RIGHTS = {
    "/metrics": {"metrics*", "viewer*", "operator*", "admin*"},
    "/metrics/robots": {"metrics*", "viewer*", "operator*", "admin*", "metrics", "viewer", "operator", "admin"},
    "/api/v1/status": {"viewer*", "operator*", "admin*"},
    "/api/v1/config": {"operator*", "admin*"},
    "/api/v1/audit": {"admin*"},
    "/api/v1/certificates/revocations": {"admin*"},
}
# The same of paths that take POST.
OPERATE = {"operator*", "admin*", "operator", "admin"}
COMMANDS = {
    **{f"/api/v1/robot/{verb}": OPERATE for verb in ("block", "unblock", "disconnect", "note")},
    "/api/v1/faults/acknowledge": OPERATE,
    "/api/v1/robot/add": {"operator*", "admin*"},
    **{path: {"admin*"} for path in ("/api/v1/certificates/revoke", "/api/v1/certificates/unrevoke", "/api/v1/reload")},
}
READ = {"viewer*", "operator*", "admin*", "viewer", "operator", "admin"}
ROLES = ("metrics", "viewer", "operator", "admin")


class UnixConnection(http.client.HTTPConnection):
    def __init__(self, path):
        super().__init__("localhost", timeout=WAIT_SECONDS)
        self.path = path

    def connect(self):
        self.sock = socket.socket(socket.AF_UNIX)
        self.sock.settimeout(WAIT_SECONDS)
        self.sock.connect(self.path)


class Answer:
    def __init__(self, response):
        self.status = response.status
        self.headers = response.headers
        # That answer has no end.
        events = response.headers.get_content_type() == "text/event-stream"
        self.body = b"" if events else response.read()

    def error(self):
        return json.loads(self.body)["error"]


def ask(connection, path, token=None, method="GET", headers=None):
    headers = dict(headers or {})
    if token:
        headers["Authorization"] = f"Bearer {token}"
    if method == "POST":
        headers.setdefault("Content-Type", "application/json")
    with contextlib.closing(connection):
        connection.request(method, path, headers=headers)
        return Answer(connection.getresponse())


class Access(EndToEnd):
    def setUp(self):
        super().setUp()
        self.tokens = pathlib.Path(self.folder) / "tokens"
        self.tokens.touch(mode=0o600)

    def token(self, role, *fleets, expires="1d"):
        """A new one, by the operator's own tool."""
        scope = [part for fleet in fleets or ("*",) for part in ("--fleet", fleet)]
        made = run(BIN / "uplinkctl", "tokens", "new", "--tokens-file", self.tokens, "--role", role, *scope,
                   "--expires", expires)  # fmt: skip
        return made.stdout.strip()

    def certificate(self, server, role, fleet="*"):
        """Certificate and key of an operator of the server's authority."""
        name = f"{role}-{'all' if fleet == '*' else fleet}"
        server.uplinkctl("pki", "operator", "--dir", server.pki, "--name", name, "--role", role, "--fleet", fleet)
        return server.pki / f"{name}.crt", server.pki / f"{name}.key"

    def served(self, http, settings, metrics=False, environment=None):
        """A server with these keys of [http]."""
        server = self.server(f"[http]\n{settings}\n")
        server.http = http
        server.environment = dict(environment or {})
        if metrics:
            server.environment["UPLINKD_LISTEN_METRICS"] = f"{ELSEWHERE}:0"
        return server.start()

    def with_tls(self, settings="", **others):
        server = self.server()
        return self.served(
            f"{ELSEWHERE}:0",
            f'tls.certificate_file = "{server.pki}/server.crt"\ntls.key_file = "{server.pki}/server.key"\n{settings}',
            **others,
        )

    def https(self, server, pair=None):
        context = ssl.create_default_context(cafile=server.pki / "ca.crt")
        context.check_hostname = False  # the certificate names 127.0.0.1
        if pair:
            context.load_cert_chain(*pair)
        host, port = server.http.rsplit(":", 1)
        return http.client.HTTPSConnection(host, int(port), timeout=WAIT_SECONDS, context=context)

    def plain(self, server):
        host, port = server.http.rsplit(":", 1)
        return http.client.HTTPConnection(host, int(port), timeout=WAIT_SECONDS)

    def paths(self):
        for line in (pathlib.Path(__file__).parents[2] / "docs/reference/openapi.yaml").read_text().splitlines():
            if found := re.fullmatch(r"  (/\S*):", line):
                yield found.group(1)


class Rights(Access):
    def test_each_role_gets_what_the_table_of_rights_says(self):
        holders = {role + star: self.token(role, *fleets) for role in ROLES for star, fleets in (("*", ()), ("", ("north",)))}
        server = self.served("127.0.0.1:0", f'tokens_file = "{self.tokens}"')
        paths = [path.replace("{ruri}", "rcan%3A%2F%2Fa") for path in self.paths()]
        self.assertGreater(len(paths), 20)
        for path in paths:
            method = "POST" if path in COMMANDS else "GET"
            may = {**RIGHTS, **COMMANDS}.get(path, READ)
            nothing = ask(self.plain(server), path, method=method)
            if path in PROBES:
                self.assertEqual(nothing.status, 200, path)
                continue
            self.assertEqual((nothing.status, nothing.headers["WWW-Authenticate"]), (401, "Bearer"), path)
            for holder, token in holders.items():
                answer = ask(self.plain(server), path, token, method)
                with self.subTest(path=path, holder=holder):
                    if holder in may:
                        self.assertIn(answer.status, (200, 400, 404), answer.body)
                    else:
                        self.assertEqual(answer.status, 403, answer.body)
                        self.assertIn(f"has the role {holder.rstrip('*')}", answer.error()["message"])
        self.assertEqual(ask(self.plain(server), "/nowhere").status, 401)
        self.assertEqual(ask(self.plain(server), "/nowhere", holders["viewer"]).status, 404)
        for token in holders.values():
            self.assertNotIn(token, server.text())

    def test_a_fleet_out_of_scope_is_as_one_that_is_not_there(self):
        server = self.server().start()
        fleet = self.fleet(server, "--robots", 2)
        server.wait_for_status(lambda status: int(status["messages"]["counts"].get("stored", 0)) > 5, WAIT_SECONDS, "messages")
        self.assert_agrees(fleet)
        self.assertEqual(server.terminate(60), 0)
        tokens = {fleet: self.token("viewer", fleet) for fleet in ("*", "no-such-fleet")}
        server.settings = f'[http]\ntokens_file = "{self.tokens}"\n'
        server.start()

        def get(target, fleet="no-such-fleet"):
            return ask(self.plain(server), f"/api/v1/{target}", tokens[fleet])

        robot = json.loads(get("robots", "*").body)["robots"][0]
        self.assertEqual(json.loads(get("robots").body)["robots"], [])
        for path in ("robots", "events", "faults", "presence", "connections", "missions"):
            out, unknown = (get(f"{path}?fleet={fleet}") for fleet in (robot["fleet"], "unknown"))
            self.assertEqual((out.status, out.body), (unknown.status, unknown.body), path)
        other = robot["ruri"] + "-unknown"
        for path in ("robot", "robot/story"):
            self.assertEqual(get(f"{path}?ruri={robot['ruri']}", "*").status, 200, path)
            out, unknown = (get(f"{path}?ruri={ruri}") for ruri in (robot["ruri"], other))
            self.assertEqual((out.status, unknown.status), (404, 404), path)
            self.assertEqual(out.body.replace(robot["ruri"].encode(), b""), unknown.body.replace(other.encode(), b""))


class Tokens(Access):
    def test_a_token_counts_within_seconds_until_it_is_revoked(self):
        server = self.served("127.0.0.1:0", f'tokens_file = "{self.tokens}"')
        token = self.token("viewer")
        status = lambda: ask(self.plain(server), "/api/v1/robots", token).status  # noqa: E731
        wait_until(server.process, lambda: status() == 200, WAIT_SECONDS, "the token counts")
        (line,) = self.tokens.read_text().splitlines()
        run(BIN / "uplinkctl", "tokens", "revoke", "--tokens-file", self.tokens, json.loads(line)["id"])
        wait_until(server.process, lambda: status() in (401, 429), WAIT_SECONDS, "the token is revoked")
        self.assertIn(f"http_caller name={json.loads(line)['id']} role=viewer", server.text())

    def test_a_token_in_an_address_is_refused(self):
        server = self.served("127.0.0.1:0", f'tokens_file = "{self.tokens}"')
        for path in ("/api/v1/robots?token=x", "/api/v1/robots?access_token=x", "/livez?token=x"):
            answer = ask(self.plain(server), path)
            self.assertEqual(answer.status, 400, path)
            self.assertIn("Authorization: Bearer", answer.error()["message"])

    def test_too_many_wrong_ones_get_429_and_a_good_one_passes(self):
        token = self.token("viewer")
        server = self.served("127.0.0.1:0", f'tokens_file = "{self.tokens}"')
        for _ in range(FAILURES_MAX):
            answer = ask(self.plain(server), "/api/v1/robots", "wrong")
            self.assertEqual((answer.status, answer.headers["WWW-Authenticate"]), (401, 'Bearer error="invalid_token"'))
        answer = ask(self.plain(server), "/api/v1/robots", "wrong")
        self.assertEqual((answer.status, answer.headers["Retry-After"]), (429, "60"))
        self.assertEqual(ask(self.plain(server), "/api/v1/robots", token).status, 200)
        through = {"X-Forwarded-For": "198.51.100.1, 203.0.113.9"}
        self.assertEqual(ask(self.plain(server), "/api/v1/robots", "wrong", headers=through).status, 401)
        page = ask(self.plain(server), "/metrics", token).body.decode()
        self.assertIn('uplinkd_http_denied_total{why="bad_token"} 11', page)
        self.assertIn('uplinkd_http_denied_total{why="too_many"} 1', page)
        self.assertIn("uplinkd_http_tokens 1", page)
        self.assertIn("http_denied why=bad_token", server.text())

    def test_a_file_that_breaks_later_leaves_the_last_good_tokens(self):
        token = self.token("viewer")
        server = self.served("127.0.0.1:0", f'tokens_file = "{self.tokens}"')
        self.tokens.write_text("no token\n")
        server.wait_for_line("tokens_unreadable")
        self.assertEqual(ask(self.plain(server), "/api/v1/robots", token).status, 200)
        self.assertIn(b"tokens_unread", ask(self.plain(server), "/readyz").body)

    def test_a_flaw_in_the_file_of_metrics_keeps_no_revoked_token_alive(self):
        token = self.token("viewer")
        secret = pathlib.Path(self.folder) / "metrics-token"
        secret.write_text("a-token-of-metrics\n")
        secret.chmod(0o600)
        server = self.served("127.0.0.1:0", f'tokens_file = "{self.tokens}"\nmetrics_token_file = "{secret}"', metrics=True)
        self.assertEqual(ask(self.plain(server), "/api/v1/robots", token).status, 200)
        secret.write_text("short\n")
        server.wait_for_line("tokens_unreadable")
        (line,) = self.tokens.read_text().splitlines()
        run(BIN / "uplinkctl", "tokens", "revoke", "--tokens-file", self.tokens, json.loads(line)["id"])
        wait_until(server.process, lambda: ask(self.plain(server), "/api/v1/robots", token).status in (401, 429),
                   WAIT_SECONDS, "the token is revoked")  # fmt: skip

    def test_a_broken_file_refuses_the_start(self):
        self.tokens.write_text("no token\n")
        server = self.server(f'[http]\ntokens_file = "{self.tokens}"\n')
        done = subprocess.run(
            [BIN / "uplinkd", "--config", server.configuration()], capture_output=True, text=True,
            timeout=WAIT_SECONDS, check=False,
        )  # fmt: skip
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("http.tokens_file", done.stderr)

    def test_the_token_of_metrics_opens_scrapes_there_and_nothing_else(self):
        secret = pathlib.Path(self.folder) / "metrics-token"
        secret.write_text("a-token-of-metrics\n")
        secret.chmod(0o600)
        server = self.served("127.0.0.1:0", f'metrics_token_file = "{secret}"', metrics=True)
        port = int(re.search(r" listening .*? metrics=\"?[^ \"]*:(\d+)", server.text()).group(1))
        there = lambda *arguments: ask(http.client.HTTPConnection(ELSEWHERE, port, timeout=WAIT_SECONDS), *arguments)  # noqa: E731
        for path in ("/metrics", "/metrics/robots"):
            self.assertEqual(there(path).status, 401)
            self.assertEqual(there(path, "another-token-here").status, 401)
            self.assertEqual(there(path, "a-token-of-metrics").status, 200)
        self.assertEqual(there("/readyz").status, 200)
        self.assertEqual(there("/api/v1/robots", "a-token-of-metrics").status, 404)
        page = http.client.HTTPConnection(ELSEWHERE, port, timeout=WAIT_SECONDS)
        self.assertEqual(ask(page, "/metrics/robots", "a-token-of-metrics").status, 200)
        self.assertEqual(ask(self.plain(server), "/api/v1/status").status, 200)


class Tls(Access):
    def test_one_port_speaks_tls_to_all_and_plain_http_to_few(self):
        token = self.token("viewer")
        server = self.with_tls(f'tokens_file = "{self.tokens}"\nplain_from = ["127.0.0.3"]')
        self.assertEqual(ask(self.https(server), "/api/v1/robots", token).status, 200)
        self.assertEqual(ask(self.https(server), "/api/v1/robots").status, 401)
        self.assertEqual(ask(self.https(server), "/livez").status, 200)
        with self.assertRaises((http.client.BadStatusLine, ConnectionError)):
            ask(self.plain(server), "/livez")
        host, port = server.http.rsplit(":", 1)
        proxy = http.client.HTTPConnection(host, int(port), timeout=WAIT_SECONDS, source_address=("127.0.0.3", 0))
        self.assertEqual(ask(proxy, "/api/v1/robots", token).status, 200)
        page = ask(self.https(server), "/metrics", token).body.decode()
        self.assertIn('uplinkd_http_denied_total{why="plain"} 1', page)
        self.assertEqual(server.terminate(60), 0)

    def test_curl_speaks_to_it(self):
        server = self.with_tls()
        certificate, key = self.certificate(server, "viewer")
        port = server.http.rsplit(":", 1)[1]
        said = run("curl", "-sS", "--noproxy", "", "--max-time", str(WAIT_SECONDS), "--cacert", server.pki / "ca.crt",
                   "--cert", certificate, "--key", key, "--connect-to", f"localhost:{port}:{server.http}",
                   "-w", "%{http_code} %{http_version}", "-o", os.devnull,
                   f"https://localhost:{port}/api/v1/status").stdout  # fmt: skip
        self.assertEqual(said, "200 1.1")

    def test_certificates_show_role_and_fleet(self):
        server = self.with_tls()
        everything, north = (self.certificate(server, "operator", fleet) for fleet in ("*", "north"))
        self.assertEqual(ask(self.https(server, everything), "/api/v1/config").status, 200)
        self.assertEqual(ask(self.https(server, north), "/api/v1/robots").status, 200)
        self.assertEqual(ask(self.https(server, north), "/api/v1/config").status, 403)
        self.assertEqual(ask(self.https(server), "/api/v1/robots").status, 401)
        scraper = self.certificate(server, "metrics")
        self.assertEqual(ask(self.https(server, scraper), "/metrics").status, 200)
        self.assertEqual(ask(self.https(server, scraper), "/api/v1/robots").status, 403)
        server.uplinkctl("pki", "robot", "--dir", server.pki, "--ruri", "rcan://local.rcan/a/b", "--fleet", "north")
        robot = (server.pki / "robot.crt", server.pki / "robot.key")
        answer = ask(self.https(server, robot), "/api/v1/robots")
        self.assertEqual(answer.status, 403)
        self.assertIn("has the role robot", answer.error()["message"])

    def wait_for_authorities(self, server, count):
        line = re.compile(rf" http_certificate_served .* authorities={count} ")
        wait_until(server.process, lambda: line.search(server.text()), WAIT_SECONDS, f"{count} authorities")

    def test_an_authority_that_is_taken_away_vouches_for_no_further_request(self):
        pki = self.server().pki
        other = pathlib.Path(self.folder) / "operators"
        run(BIN / "uplinkctl", "pki", "init", "--dir", other)
        run(BIN / "uplinkctl", "pki", "operator", "--dir", other, "--name", "ann", "--role", "admin", "--fleet", "*")
        trusted = pathlib.Path(self.folder) / "operators.crt"

        def trust(*files):
            fresh = trusted.with_suffix(".new")
            fresh.write_text("".join(file.read_text() for file in files))
            fresh.rename(trusted)

        trust(other / "ca.crt", pki / "ca.crt")
        server = self.with_tls(environment={"UPLINKD_TLS_OPERATOR_CA_FILE": str(trusted)})
        self.wait_for_authorities(server, 2)
        held = self.https(server, (other / "ann.crt", other / "ann.key"))
        stays = self.https(server, self.certificate(server, "viewer"))
        with contextlib.closing(held), contextlib.closing(stays):

            def status(connection):
                connection.request("GET", "/api/v1/status")
                answer = connection.getresponse()
                answer.read()
                return answer.status

            self.assertEqual((status(held), status(stays)), (200, 200))
            trust(pki / "ca.crt")
            self.wait_for_authorities(server, 1)
            self.assertEqual((status(held), status(stays)), (401, 200))

    def test_strangers_handshakes_that_never_end_keep_others_neither_out_nor_waiting(self):
        server = self.with_tls()
        operator = self.certificate(server, "viewer")
        host, port = server.http.rsplit(":", 1)
        with contextlib.ExitStack() as held:
            for _ in range(40):
                end = held.enter_context(socket.create_connection((host, int(port)), WAIT_SECONDS))
                end.sendall(b"\x16\x03\x01\x02\x00")
            self.assertEqual(ask(self.https(server, operator), "/api/v1/status").status, 200)
            self.assertEqual(ask(self.https(server), "/livez").status, 200)
        self.assertEqual(server.terminate(60), 0)


class Addresses(Access):
    def refused(self, settings, http):
        server = self.server(settings)
        server.http = http
        done = subprocess.run(
            [BIN / "uplinkd", "--config", server.configuration()], capture_output=True, text=True,
            timeout=WAIT_SECONDS, check=False,
        )  # fmt: skip
        self.assertNotEqual(done.returncode, 0)
        return done.stderr

    def test_beyond_loopback_the_start_is_refused_without_authentication(self):
        said = self.refused("", "0.0.0.0:0")
        for way_out in ("listen.http", "http.tokens_file", "tls.operator_ca_file", "127.0.0.1", "unix:"):
            self.assertIn(way_out, said)

    def test_a_socket_has_its_mode_is_replaced_when_left_and_goes_at_the_end(self):
        path = f"{self.folder}/http.sock"
        server = self.served(f"unix:{path}", 'socket_mode = "0600"')
        self.assertEqual(stat.S_IMODE(os.stat(path).st_mode), 0o600)
        self.assertEqual(ask(UnixConnection(path), "/api/v1/status").status, 200)
        self.assertIn("a server listens at", self.refused_beside(server, path))
        server.process.send_signal(signal.SIGKILL)
        server.process.wait(WAIT_SECONDS)
        self.assertTrue(os.path.exists(path))
        server.start()
        self.assertEqual(ask(UnixConnection(path), "/livez").status, 200)
        self.assertEqual(server.terminate(60), 0)
        self.assertFalse(os.path.exists(path))

    def refused_beside(self, server, path):
        """What a second server says that wants the same socket."""
        other = pathlib.Path(self.folder) / "other"
        other.mkdir()
        text = server.configuration().read_text().replace(str(server.relay), "127.0.0.1:0")
        (other / "uplinkd.toml").write_text(text.replace("uplinkd.db", "other.db"))
        done = subprocess.run(
            [BIN / "uplinkd", "--config", other / "uplinkd.toml"], capture_output=True, text=True,
            timeout=WAIT_SECONDS, check=False,
        )  # fmt: skip
        self.assertNotEqual(done.returncode, 0)
        self.assertTrue(os.path.exists(path))
        return done.stderr

    def test_a_proxy_elsewhere_does_not_take_the_health_check_its_way(self):
        server = self.server(f'[http]\ntokens_file = "{self.tokens}"\nplain_from = ["192.0.2.9"]\n')
        server.http = "0.0.0.0:0"
        server.start()
        port = server.http.rsplit(":", 1)[1]
        self.assertEqual(ask(http.client.HTTPConnection("127.0.0.1", int(port), timeout=WAIT_SECONDS), "/livez").status, 200)

    def test_a_socket_asks_for_a_token_where_one_is_set(self):
        token = self.token("viewer")
        path = f"{self.folder}/http.sock"
        self.served(f"unix:{path}", f'tokens_file = "{self.tokens}"')
        self.assertEqual(ask(UnixConnection(path), "/api/v1/status").status, 401)
        self.assertEqual(ask(UnixConnection(path), "/api/v1/status", token).status, 200)


if __name__ == "__main__":
    unittest.main()
