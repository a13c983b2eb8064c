"""What a server answers before it has a store."""

import json
import re
import signal
import subprocess
import unittest
import urllib.error
import urllib.request

from harness import LISTENING, Cluster, EndToEnd, Server, wait_until
from tcp_proxy import Cut, TcpProxy

PROBES_ANSWERED = re.compile(r' probes_answered http="?([^ "\s]+)"?')
WAIT_SECONDS = 30


class Starting(EndToEnd):
    def setUp(self):
        super().setUp()
        self.cluster = Cluster(self.folder).create()
        self.open_things.append(self.cluster)
        self.password = self.folder / "store.password"
        self.password.write_text("uplinkd\n", encoding="utf-8")
        # It takes connections, and answers none.
        self.proxy = TcpProxy(f"127.0.0.1:{self.cluster.place['port']}")
        self.open_things.append(self.proxy)
        self.proxy.cut(Cut.BLACK_HOLE)

    def begin(self):
        """A server that waits for its store."""
        url = f"postgresql://uplinkd@{self.proxy.address}/uplinkd?sslmode=disable"
        server = Server(self.folder, f'password_file = "{self.password}"\ntimeout = "60s"', url)
        self.open_things.append(server)
        server.log = self.folder / "uplinkd.log"
        with server.log.open("wb") as log:
            server.process = subprocess.Popen(
                [str(server.program), "--config", str(server.configuration())],
                stdout=log, stderr=subprocess.STDOUT,
            )  # fmt: skip
        found = wait_until(
            server.process, lambda: PROBES_ANSWERED.search(server.text()), WAIT_SECONDS, "HTTP listens"
        )
        server.http = found.group(1)
        return server

    def ask(self, server, path):
        """Status and body of an answer."""
        try:
            with urllib.request.urlopen(f"http://{server.http}{path}", timeout=10) as answer:
                return answer.status, json.load(answer)
        except urllib.error.HTTPError as error:
            return error.code, json.load(error)

    def assert_starting(self, server):
        self.assertEqual(self.ask(server, "/livez")[0], 200)
        self.assertEqual(self.ask(server, "/readyz"), (503, {"refuses": ["starting"]}))
        self.assertIsNone(LISTENING.search(server.text()))

    def test_probes_are_answered_while_the_database_is_silent(self):
        self.cluster.migrate()
        server = self.begin()
        opening = re.compile(rf' store_opening store="?{re.escape(self.proxy.address)}/uplinkd"?\n')
        wait_until(server.process, lambda: opening.search(server.text()), WAIT_SECONDS, "the store is named")
        self.assert_starting(server)
        for path in ("/api/v1/status", "/api/v1/robots", "/metrics", "/nowhere"):
            status, body = self.ask(server, path)
            self.assertEqual((status, body["error"]["code"]), (503, "UNAVAILABLE"), path)
        self.assert_starting(server)
        self.proxy.mend()
        wait_until(
            server.process, lambda: self.ask(server, "/readyz")[0] == 200, WAIT_SECONDS, "the server is ready"
        )
        self.assertEqual(self.ask(server, "/api/v1/status")[0], 200)
        self.assertEqual(server.terminate(WAIT_SECONDS), 0)
        self.assertIn(" stopped\n", server.text())

    def test_a_signal_during_the_start_ends_it(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            with self.subTest(number.name):
                server = self.begin()
                self.assert_starting(server)
                # A reload of what was just read is nothing.
                server.process.send_signal(signal.SIGHUP)
                self.assert_starting(server)
                server.process.send_signal(number)
                self.assertEqual(server.process.wait(WAIT_SECONDS), 0)
                self.assertIn(f"stopped_while_starting signal={number.value}", server.text())

    def test_a_start_that_fails_ends_the_process(self):
        server = self.begin()  # on a database without a schema
        self.assert_starting(server)
        self.proxy.mend()
        self.assertEqual(server.process.wait(WAIT_SECONDS), 1)
        self.assertIn("start_failed", server.text())
        self.assertIn("uplinkctl store migrate", server.text())

    def test_a_schema_of_an_earlier_build_that_is_found_later_ends_the_server(self):
        self.cluster.migrate()
        self.cluster.sql("ALTER TABLE uplinkd.schema_migrations DROP COLUMN oldest")
        self.proxy.mend()
        self.proxy.cut(Cut.REFUSE)
        server = self.begin()
        wait_until(
            server.process, lambda: LISTENING.search(server.text()), WAIT_SECONDS, "it starts without a store"
        )
        self.proxy.mend()
        self.assertEqual(server.process.wait(WAIT_SECONDS), 1, server.text()[-2000:])
        for line in ("store_outdated_program", "made by an earlier build", " draining ", " stopped"):
            self.assertIn(line, server.text())


if __name__ == "__main__":
    unittest.main()
