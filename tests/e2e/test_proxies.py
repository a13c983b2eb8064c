"""The proxies of deploy/proxy before a server: what they let in, and that answers come through as they are."""

import base64
import contextlib
import crypt
import gzip
import http.client
import json
import re
import shutil
import socket
import ssl
import subprocess
import unittest

from harness import SOURCE, EndToEnd, wait_until
from openapi import FILE
from ports import free_port

FOLDER = SOURCE / "deploy" / "proxy"
HOST = "fleet.example.org"
PASSWORD = "open-sesame"
RURI = "rcan%3A%2F%2Fnowhere%2Fhere"
WAIT_SECONDS = 60
TIMES_OF_A_CONNECTION = 3


def replaced(text, **words):
    """Each word of the file by this test's own; each must be there."""
    for name, (old, new) in words.items():
        assert old in text, f"{name}: no {old}"
        text = text.replace(old, new)
    return text


class Proxy(EndToEnd):
    """What is asked of each; a proxy's class says how it is started."""

    program = None
    file = None

    def setUp(self):
        super().setUp()
        self.assertIsNotNone(shutil.which(self.program), f"no {self.program}: run ./dev setup")
        self.port = free_port()
        self.certificate = self.folder / "fleet.crt"
        self.key = self.folder / "fleet.key"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
                        "-days", "1", "-subj", f"/CN={HOST}", "-addext", f"subjectAltName=DNS:{HOST}",
                        "-keyout", self.key, "-out", self.certificate], check=True, capture_output=True)  # fmt: skip
        self.tls = ssl.create_default_context(cafile=self.certificate)

    def start(self):
        server = self.server(f'[http]\nhosts = ["{HOST}"]').start()
        text = replaced((FOLDER / self.file).read_text(encoding="utf-8"), server=("127.0.0.1:7480", server.http))
        log = self.open_log()
        proxy = subprocess.Popen(self.command(text), cwd=self.folder, stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(self.stop, proxy)
        try:
            wait_until(proxy, self.listens, WAIT_SECONDS, f"{self.program} listens")
        except AssertionError as error:
            raise AssertionError(f"{error}\n{(self.folder / 'proxy.log').read_text(encoding='utf-8')}") from None
        return server

    def open_log(self):
        log = (self.folder / "proxy.log").open("wb")
        self.addCleanup(log.close)
        return log

    def stop(self, proxy):
        proxy.terminate()
        try:
            proxy.wait(WAIT_SECONDS)
        except subprocess.TimeoutExpired:
            proxy.kill()
            proxy.wait(WAIT_SECONDS)

    def listens(self):
        with contextlib.suppress(OSError), self.connection() as connection:
            connection.connect()
            return True
        return False

    @contextlib.contextmanager
    def connection(self):
        tls = self.tls

        class ByName(http.client.HTTPSConnection):
            """To this machine, under the name of the certificate."""

            def connect(self):
                self.sock = tls.wrap_socket(socket.create_connection(("127.0.0.1", self.port), 60), server_hostname=HOST)

        connection = ByName(HOST, self.port)
        try:
            yield connection
        finally:
            connection.close()

    def ask(self, connection, path, method="GET", password=PASSWORD, **headers):
        headers = {name.replace("_", "-"): value for name, value in headers.items()}
        if password:
            headers["Authorization"] = "Basic " + base64.b64encode(f"operator:{password}".encode()).decode()
        connection.request(method, path, headers={"Host": HOST, **headers})
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()

    def assert_answers_come_through(self):
        server = self.start()
        with self.connection() as connection:
            for _ in range(TIMES_OF_A_CONNECTION):
                status, _, body = self.ask(connection, "/uplink/api/v1/status")
                self.assertEqual(status, 200, body)
                self.assertIn("version", json.loads(body))
            status, _, body = self.ask(connection, f"/uplink/api/v1/robot?ruri={RURI}")
            self.assertEqual((status, json.loads(body)["error"]["code"]), (404, "NOT_FOUND"))
            self.assertIn("rcan://nowhere/here", body.decode())
            status, headers, body = self.ask(connection, "/uplink/api/v1/openapi.yaml", Accept_Encoding="gzip")
            self.assertEqual((status, headers["Content-Encoding"]), (200, "gzip"))
            self.assertEqual(gzip.decompress(body), FILE.read_bytes())
            tag = headers["ETag"]
            status, headers, body = self.ask(connection, "/uplink/api/v1/openapi.yaml", If_None_Match=tag)
            self.assertEqual((status, headers["ETag"], body), (304, tag, b""))
            status, headers, body = self.ask(connection, "/uplink/api/v1/robots", Accept="application/x-ndjson")
            self.assertEqual((status, headers["Content-Type"], body), (200, "application/x-ndjson", b""))
            status, _, body = self.ask(connection, "/uplink/api/v1/robots", "HEAD")
            self.assertEqual((status, body), (200, b""))
        # The password went no further.
        self.assertNotIn(PASSWORD, server.text())

    def assert_strangers_stay_outside(self):
        server = self.start()
        for password in (None, "wrong"):
            with self.connection() as connection:
                status, headers, _ = self.ask(connection, "/uplink/api/v1/status", password=password)
                self.assertEqual(status, 401)
                self.assertIn("WWW-Authenticate", headers)
        for path in ("/", "/api/v1/status", "/uplinks/api/v1/status"):
            with self.connection() as connection:
                self.assertEqual(self.ask(connection, path)[0], 404, path)
        # A page of another site, and one of this.
        for origin, status in (("https://elsewhere.example", 403), (f"https://{HOST}", 200)):
            with self.connection() as connection:
                self.assertEqual(self.ask(connection, "/uplink/api/v1/status", Origin=origin)[0], status)
        asked = re.findall(r'route="status",code="(\dxx)"\} ([1-9]\d*)', server_text(server, "/metrics"))
        self.assertEqual(asked, [("2xx", "1"), ("4xx", "1")])


def server_text(server, path):
    connection = http.client.HTTPConnection(server.http, timeout=60)
    try:
        connection.request("GET", path)
        return connection.getresponse().read().decode()
    finally:
        connection.close()


class Nginx(Proxy):
    program, file = "nginx", "nginx.conf"

    def test_answers_come_through_as_they_are(self):
        self.assert_answers_come_through()

    def test_strangers_and_other_paths_stay_outside(self):
        self.assert_strangers_stay_outside()

    def command(self, text):
        passwords = self.folder / "passwords"
        passwords.write_text(f"operator:{crypt.crypt(PASSWORD, crypt.METHOD_SHA256)}\n", encoding="utf-8")
        passwords.chmod(0o644)
        text = replaced(
            text,
            port=("listen 443 ssl", f"listen 127.0.0.1:{self.port} ssl"),
            certificate=("/etc/ssl/fleet.example.org.crt", str(self.certificate)),
            key=("/etc/ssl/private/fleet.example.org.key", str(self.key)),
            passwords=("/etc/nginx/uplinkd.passwords", str(passwords)),
        )
        (self.folder / "site.conf").write_text(text, encoding="utf-8")
        temporary = "\n".join(f"{kind}_temp_path {self.folder}/{kind};"
                              for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))  # fmt: skip
        (self.folder / "nginx.conf").write_text(
            f"daemon off; master_process off; pid {self.folder}/nginx.pid; error_log stderr;\nevents {{}}\n"
            f"http {{\naccess_log off;\n{temporary}\ninclude {self.folder}/site.conf;\n}}\n",
            encoding="utf-8",
        )
        return ["nginx", "-p", str(self.folder), "-e", "stderr", "-c", str(self.folder / "nginx.conf")]


class Haproxy(Proxy):
    program, file = "haproxy", "haproxy.cfg"

    def test_answers_come_through_as_they_are(self):
        self.assert_answers_come_through()

    def test_strangers_and_other_paths_stay_outside(self):
        self.assert_strangers_stay_outside()

    def command(self, text):
        both = self.folder / "both.pem"
        both.write_bytes(self.certificate.read_bytes() + self.key.read_bytes())
        text = replaced(
            text,
            port=("bind :443", f"bind 127.0.0.1:{self.port}"),
            certificate=("/etc/haproxy/fleet.example.org.pem", str(both)),
            password=("$5$uplinkd$HASH", crypt.crypt(PASSWORD, crypt.METHOD_SHA256)),
        )
        file = self.folder / "haproxy.cfg"
        file.write_text(text, encoding="utf-8")
        return ["haproxy", "-db", "-f", str(file)]


class Caddy(Proxy):
    program, file = "caddy", "Caddyfile"

    def test_answers_come_through_as_they_are(self):
        self.assert_answers_come_through()

    def test_strangers_and_other_paths_stay_outside(self):
        self.assert_strangers_stay_outside()

    def command(self, text):
        text = replaced(
            text,
            site=(f"\n{HOST} {{", f"\nhttps://{HOST}:{self.port} {{\n\ttls {self.certificate} {self.key}"),
            password=("HASH", crypt.crypt(PASSWORD, crypt.mksalt(crypt.METHOD_BLOWFISH, rounds=2**4))),
        )
        file = self.folder / "Caddyfile"
        file.write_text("{\n\tadmin off\n\tauto_https disable_redirects\n}\n" + text, encoding="utf-8")
        return ["env", f"HOME={self.folder}", "caddy", "run", "--config", str(file), "--adapter", "caddyfile"]


if __name__ == "__main__":
    unittest.main()
