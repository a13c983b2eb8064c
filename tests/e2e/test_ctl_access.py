"""How uplinkctl reaches a server and shows who asks: https, Unix sockets, tokens, certificates. A program of
Python stands for the server, so that what uplinkctl sends can be seen."""

import http.server
import json
import os
import socketserver
import ssl
import subprocess
import threading
import unittest

from harness import BIN, EndToEnd, uplinkctl

TOKEN = "uplinkd_0123456789abcdef"
JOIN_SECONDS = 30
DOCTOR_SECONDS = 60
STATUS = {"version": "1"}


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def do_GET(self):
        self.server.heads.append(dict(self.headers.items()))
        code, body, headers = self.server.answers.get(self.path.split("?")[0], (200, STATUS, {}))
        text = json.dumps(body, separators=(",", ":")).encode()
        self.send_response(code)
        for name, value in {**headers, "Content-Length": str(len(text))}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(text)

    def address_string(self):
        return "a client"

    def log_message(self, *_):
        pass


class Quiet(socketserver.ThreadingMixIn):
    """Handshakes that fail are the point of some tests."""

    daemon_threads = True

    def handle_error(self, request, client_address):
        pass


class Tcp(Quiet, http.server.HTTPServer):
    pass


class Unix(Quiet, socketserver.UnixStreamServer):
    pass


class Told:
    """Answers until it is closed; `heads` are those of the requests."""

    def __init__(self, server, context=None):
        self.server = server
        server.heads, server.answers = [], {}
        if context is not None:
            server.socket = context.wrap_socket(server.socket, server_side=True, do_handshake_on_connect=False)
        self.thread = threading.Thread(target=server.serve_forever)
        self.thread.start()

    def close(self):
        self.server.shutdown()
        self.thread.join(JOIN_SECONDS)
        self.server.server_close()


class Asking(EndToEnd):
    def setUp(self):
        super().setUp()
        self.home = self.folder / "home"
        self.home.mkdir()

    def ctl(self, *arguments, code=0, **environment):
        env = {name: value for name, value in os.environ.items() if not name.startswith(("UPLINKCTL", "XDG"))}
        return uplinkctl(*arguments, code=code, env={**env, "HOME": str(self.home), **environment})


class Access(Asking):
    def setUp(self):
        super().setUp()
        self.pki = self.folder / "pki"
        uplinkctl("pki", "init", "--dir", self.pki)
        uplinkctl("pki", "server", "--dir", self.pki, "--host", "localhost")
        uplinkctl("pki", "operator", "--dir", self.pki, "--role", "viewer", "--name", "ann")
        self.token = self.folder / "token"
        self.token.write_text(f"{TOKEN}\n", encoding="utf-8")
        self.token.chmod(0o600)

    def told(self, server, context=None):
        told = Told(server, context)
        self.open_things.append(told)
        return told.server

    def https(self, ask_for_certificate=False):
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(self.pki / "server.crt", self.pki / "server.key")
        if ask_for_certificate:
            context.load_verify_locations(self.pki / "ca.crt")
            context.verify_mode = ssl.CERT_REQUIRED
        server = self.told(Tcp(("127.0.0.1", 0), Handler), context)
        return server, f"https://localhost:{server.server_port}"

    def http(self):
        server = self.told(Tcp(("127.0.0.1", 0), Handler))
        return server, f"http://127.0.0.1:{server.server_port}"

    def test_https_is_believed_by_its_authority_and_name_alone(self):
        server, url = self.https()
        self.ctl("status", "--server", url, "--ca-file", self.pki / "ca.crt")
        self.assertEqual(server.heads[0]["Host"], f"localhost:{server.server_port}")
        strange = self.ctl("status", "--server", url, "--token-file", self.token, code=1)
        self.assertIn("the server's certificate is not believed", strange.stderr)
        self.assertIn("--ca-file FILE", strange.stderr)
        other = f"https://127.0.0.1:{server.server_port}"
        named = self.ctl("status", "--server", other, "--ca-file", self.pki / "ca.crt", code=1)
        self.assertIn("IP address mismatch", named.stderr)
        # Neither of them got the token, or a request.
        self.assertEqual(len(server.heads), 1)

    def test_an_operators_certificate_is_shown(self):
        _, url = self.https(ask_for_certificate=True)
        files = ("--ca-file", self.pki / "ca.crt")
        self.ctl("status", "--server", url, *files, "--certificate-file", self.pki / "ann.crt",
                 "--key-file", self.pki / "ann.key")  # fmt: skip
        self.assertIn("certificate required", self.ctl("status", "--server", url, *files, code=1).stderr)

    def test_a_probe_takes_any_certificate_and_shows_nothing(self):
        server, url = self.https()
        server.answers["/livez"] = (200, {"relayLastHandshakeSeconds": 1}, {})
        self.assertIn("alive: ", self.ctl("health", "--url", url, UPLINKCTL_TOKEN_FILE=str(self.token)).stdout)
        self.assertNotIn("Authorization", server.heads[0])

    def test_the_wrong_scheme_is_named(self):
        _, secure = self.https()
        _, plain = self.http()
        said = self.ctl("status", "--server", plain.replace("http:", "https:"), code=1).stderr
        self.assertIn("TLS handshake: ", said)
        self.assertIn("does it speak http there?", said)
        self.assertIn("does it want https?", self.ctl("status", "--server", secure.replace("https:", "http:"),
                                                      code=1).stderr)  # fmt: skip

    def test_a_unix_socket_is_asked_as_localhost(self):
        path = self.folder / "http.sock"
        server = self.told(Unix(str(path), Handler))
        self.ctl("status", "--server", f"unix:{path}", "--token-file", self.token)
        self.assertEqual(server.heads[0]["Host"], "localhost")
        self.assertEqual(server.heads[0]["Authorization"], f"Bearer {TOKEN}")
        server.answers["/livez"] = (200, {"relayLastHandshakeSeconds": 1}, {})
        config = self.folder / "uplinkd.toml"
        config.write_text(f'[listen]\nhttp = "unix:{path}"\n', encoding="utf-8")
        self.assertIn("alive: ", self.ctl("health", "--config", config).stdout)
        self.ctl("status", "--config", config)
        gone = self.ctl("status", "--server", f"unix:{path}.gone", code=1).stderr
        self.assertIn(f"unix:{path}.gone /api/v1/status: connect: No such file or directory", gone)

    def test_a_token_comes_from_a_flag_a_variable_or_a_context(self):
        server, url = self.http()
        self.ctl("status", "--server", url)
        self.assertNotIn("Authorization", server.heads[-1])
        self.ctl("status", "--server", url, "--token-file", self.token)
        self.assertEqual(server.heads[-1]["Authorization"], f"Bearer {TOKEN}")
        self.ctl("status", "--server", url, UPLINKCTL_TOKEN_FILE=str(self.token))
        self.assertEqual(server.heads[-1]["Authorization"], f"Bearer {TOKEN}")
        self.ctl("contexts", "add", "hall", "--server", url)
        self.ctl("status")
        self.assertNotIn("Authorization", server.heads[-1])
        self.ctl("contexts", "set", "hall", "--token-file", self.token)
        self.ctl("status")
        self.assertEqual(server.heads[-1]["Authorization"], f"Bearer {TOKEN}")
        file = (self.home / ".config/uplinkctl/config.toml").read_text(encoding="utf-8")
        self.assertIn(f'token_file = "{self.token}"', file)
        self.assertNotIn(TOKEN, file)
        self.assertIn(str(self.token), self.ctl("contexts", "list", "-o", "csv").stdout)
        self.ctl("contexts", "set", "hall", "--token-file", "")
        self.ctl("status")
        self.assertNotIn("Authorization", server.heads[-1])
        self.assertIn("there is no context dock", self.ctl("contexts", "set", "dock", code=2).stderr)

    def test_a_token_that_others_may_read_is_not_shown(self):
        server, url = self.http()
        self.token.chmod(0o644)
        said = self.ctl("status", "--server", url, "--token-file", self.token, code=2).stderr
        self.assertIn(f"chmod 600 {self.token}", said)
        self.assertNotIn(TOKEN, said)
        self.assertEqual(server.heads, [])

    def test_a_refused_caller_is_told_what_to_try(self):
        server, url = self.http()
        error = {"error": {"code": "X", "message": "the server's sentence"}}
        for code, headers, part in ((401, {}, "--token-file FILE"), (403, {}, "uplinkctl tokens list"),
                                    (429, {"Retry-After": "30"}, "try again in 30 s")):  # fmt: skip
            with self.subTest(code):
                server.answers["/api/v1/status"] = (code, error, headers)
                said = self.ctl("status", "--server", url, code=1).stderr
                self.assertIn("the server's sentence; ", said)
                self.assertIn(part, said)


class OwnServer(Asking):
    """uplinkctl finds a server by its configuration."""

    def token(self, file, *flags):
        text = uplinkctl("tokens", "new", "--tokens-file", file, *flags).stdout
        path = self.folder / "caller.token"
        path.write_text(text, encoding="utf-8")
        path.chmod(0o600)
        return path

    def doctor(self, config):
        user = ("--user", "root") if os.geteuid() == 0 else ()
        done = subprocess.run([BIN / "uplinkctl", "doctor", "--config", config, *user], capture_output=True, text=True,
                              timeout=DOCTOR_SECONDS, check=False)  # fmt: skip
        return done.stdout

    def test_https_is_spoken_and_its_certificate_known(self):
        server = self.server()
        tokens = self.folder / "tokens"
        token = self.token(tokens, "--role", "admin", "--fleet", "*")
        # No machine has this address (RFC 5737): this one must speak TLS.
        server.settings = (f'[http]\ntls.certificate_file = "{server.pki}/server.crt"\n'
                           f'tls.key_file = "{server.pki}/server.key"\n'
                           f'tokens_file = "{tokens}"\nplain_from = ["192.0.2.1"]\n')  # fmt: skip
        config = server.start().configuration()
        self.assertIn("alive: ", self.ctl("health", "--config", config).stdout)
        self.assertIn("server: ready: ", self.doctor(config))
        self.ctl("status", "--config", config, "--token-file", token)
        self.assertIn("--token-file FILE", self.ctl("status", "--config", config, code=1).stderr)
        url = f"https://{server.http}"
        self.ctl("status", "--server", url, "--ca-file", server.pki / "ca.crt", "--token-file", token)
        uplinkctl("pki", "operator", "--dir", server.pki, "--role", "viewer", "--fleet", "*", "--name", "ann")
        ann = ("--certificate-file", server.pki / "ann.crt", "--key-file", server.pki / "ann.key")
        self.ctl("status", "--config", config, *ann)
        self.assertIn("uplinkctl tokens list", self.ctl("config", "show", "--server", url, "--ca-file",
                                                        server.pki / "ca.crt", *ann, code=1).stderr)  # fmt: skip
        # Another certificate than the server shows is in its place now.
        other = self.folder / "other"
        uplinkctl("pki", "init", "--dir", other)
        uplinkctl("pki", "server", "--dir", other, "--host", "localhost")
        mistaken = config.with_name("mistaken.toml")
        mistaken.write_text(config.read_text(encoding="utf-8").replace(
            f'\ntls.certificate_file = "{server.pki}', f'\ntls.certificate_file = "{other}'), encoding="utf-8")  # fmt: skip
        said = self.ctl("status", "--config", mistaken, "--token-file", token, code=1).stderr
        self.assertIn("another certificate than its configuration names", said)

    def test_a_unix_socket_is_found(self):
        server = self.server()
        path = self.folder / "http.sock"
        server.http = f"unix:{path}"
        config = server.start().configuration()
        self.assertIn("alive: ", self.ctl("health", "--config", config).stdout)
        self.ctl("status", "--config", config)
        said = self.doctor(config)
        self.assertIn(f"listen.http: {path} is held by the running uplinkd (pid {server.process.pid})", said)
        self.assertIn("server: ready: ", said)


if __name__ == "__main__":
    unittest.main()
