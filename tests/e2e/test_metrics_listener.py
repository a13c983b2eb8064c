"""Probes and scrapes beyond loopback: listen.metrics."""

import contextlib
import re
import signal
import socket
import subprocess
import threading
import unittest
import urllib.error
import urllib.request

from harness import BIN, EndToEnd, Server, wait_until
from ports import free_port
from prometheus import Prometheus

WAIT_SECONDS = 30
METRICS = re.compile(r" listening .*? metrics=\"?([^ \"]+)\"?")
# Linux has all of 127.0.0.0/8; listen.http is at 127.0.0.1 alone.
ELSEWHERE = "127.0.0.2"
SHOWN = ("/livez", "/readyz", "/metrics", "/metrics/robots")
HALF_REQUESTS = 40
# One source has a quarter of the connections at most.
SOURCES = 4
FLOODERS = 32
# Each opens, asks and closes without a pause.
LEAVERS = 3
PROBES = 20


def ask(address, path, method="GET", host="uplinkd.example"):
    """The status of an answer under a name that the server does not know."""
    request = urllib.request.Request(f"http://{address}{path}", headers={"Host": host}, method=method)
    try:
        with urllib.request.urlopen(request, timeout=WAIT_SECONDS) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


class MetricsListener(EndToEnd):
    def begin(self, address):
        """A server with this listen.metrics; the port of that is `metrics_port`."""
        server = self.server()
        server.environment = {"UPLINKD_LISTEN_METRICS": address}
        server.start()
        self.metrics_port = METRICS.search(server.text()).group(1).rsplit(":", 1)[1]
        return server

    def test_probes_and_scrapes_are_shown_everywhere_and_data_nowhere_else(self):
        server = self.begin("[::]:0")
        for host in (ELSEWHERE, "[::1]"):
            address = f"{host}:{self.metrics_port}"
            for path in SHOWN:
                self.assertEqual(ask(address, path), 200, (host, path))
                self.assertEqual(ask(address, path, "POST"), 405, (host, path))
            for path in ("/api/v1/status", "/api/v1/robots", "/api/v1/faults", "/"):
                self.assertEqual(ask(address, path), 404, (host, path))
        for path in (*SHOWN, "/api/v1/status"):
            self.assertEqual(ask(server.http, path, host="localhost"), 200, path)
        self.assertEqual(ask(server.http, "/api/v1/status"), 421)

    def test_it_is_off_unless_it_is_set(self):
        server = self.server().start()
        self.assertIsNone(METRICS.search(server.text()))
        self.assertEqual(server.metric('uplinkd_http_connections_limit{listener="metrics"}'), 0)

    def scraped_through(self, target, through=None):
        server = self.begin(f"{ELSEWHERE}:0")
        fleet = self.fleet(server, "--robots", 2)
        prometheus = Prometheus(self.folder, server, target.format(self.metrics_port), through=through and
                                through.format(self.metrics_port))  # fmt: skip
        self.open_things.append(prometheus)
        prometheus.wait_for_value("sum(up)", 2)
        prometheus.wait_for_value("sum(rcan_robot_online)", 2)
        ((labels, _),) = prometheus.wait_for('uplinkd_http_connections{listener="metrics"} > 0')
        self.assertEqual(labels["instance"], target.format(self.metrics_port))
        self.assert_agrees(fleet)

    def test_a_real_prometheus_scrapes_it_on_another_address(self):
        self.scraped_through(ELSEWHERE + ":{}")

    def test_a_real_prometheus_scrapes_it_under_another_name(self):
        # The request names uplinkd.example; no resolver is asked.
        self.scraped_through("uplinkd.example:{}", through=ELSEWHERE + ":{}")

    def test_requests_that_never_end_keep_neither_listener_from_answering(self):
        server = self.begin(f"{ELSEWHERE}:0")
        address = (ELSEWHERE, int(self.metrics_port))
        with contextlib.ExitStack() as held:
            for index in range(HALF_REQUESTS):
                source = (f"127.0.0.{3 + index % SOURCES}", 0)
                end = held.enter_context(socket.create_connection(address, WAIT_SECONDS, source))
                end.sendall(b"GET /metrics HTTP/1.1\r\nHost: x\r\n")
            limit = server.metric('uplinkd_http_connections_limit{listener="metrics"}')
            wait_until(
                server.process,
                lambda: server.metric('uplinkd_http_connections_given_up_total{listener="metrics"}')
                >= HALF_REQUESTS - limit,
                WAIT_SECONDS, "the oldest gave way",
            )  # fmt: skip
            self.assertEqual(server.metric('uplinkd_http_connections{listener="metrics"}'), limit)
            for path in (*SHOWN, "/api/v1/status"):
                self.assertEqual(ask(server.http, path, host="localhost"), 200, path)
            for path in SHOWN:
                self.assertEqual(ask(f"{ELSEWHERE}:{self.metrics_port}", path), 200, path)
            self.assertEqual(server.metric('uplinkd_http_connections_given_up_total{listener="http"}'), 0)

    def test_probes_without_a_pause_from_one_source_shut_no_other_out(self):
        server = self.begin(f"{ELSEWHERE}:0")
        address = (ELSEWHERE, int(self.metrics_port))
        ended = threading.Event()

        def flood(source):
            while not ended.is_set():
                with contextlib.suppress(OSError), socket.create_connection(address, WAIT_SECONDS, source) as end:
                    while not ended.is_set():
                        end.sendall(b"GET /livez HTTP/1.1\r\nHost: x\r\n\r\n" * 20)
                        if not end.recv(1 << 16):
                            break

        threads = [threading.Thread(target=flood, args=(("127.0.0.3", 0),)) for _ in range(FLOODERS)]
        for thread in threads:
            thread.start()
        try:
            given_up = 'uplinkd_http_connections_given_up_total{listener="metrics"}'
            wait_until(server.process, lambda: server.metric(given_up) > 0, WAIT_SECONDS, "it has its share")
            for _ in range(PROBES):
                self.assertEqual(ask(f"{ELSEWHERE}:{self.metrics_port}", "/livez"), 200)
                self.assertEqual(ask(server.http, "/livez", host="localhost"), 200)
        finally:
            ended.set()
            for thread in threads:
                thread.join()

    def test_scrapes_that_are_left_at_once_from_one_source_refuse_no_other(self):
        server = self.begin(f"{ELSEWHERE}:0")
        address = (ELSEWHERE, int(self.metrics_port))
        ended = threading.Event()

        def flood():
            while not ended.is_set():
                with contextlib.suppress(OSError), socket.create_connection(
                    address, WAIT_SECONDS, ("127.0.0.3", 0)
                ) as end:
                    end.sendall(b"GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n")

        threads = [threading.Thread(target=flood) for _ in range(LEAVERS)]
        for thread in threads:
            thread.start()
        try:
            given_up = 'uplinkd_http_connections_given_up_total{listener="metrics"}'
            wait_until(server.process, lambda: server.metric(given_up) > PROBES, WAIT_SECONDS, "it has its share")
            for _ in range(PROBES):
                for path in SHOWN:
                    self.assertEqual(ask(f"{ELSEWHERE}:{self.metrics_port}", path), 200, path)
        finally:
            ended.set()
            for thread in threads:
                thread.join()
        self.assertEqual(server.metric("uplinkd_http_reads_refused_total"), 0)

    def test_a_reload_says_that_it_needs_a_restart(self):
        server = self.server()
        with_it = server.configuration().read_text(encoding="utf-8").replace(
            "[listen]", f'[listen]\nmetrics = "{ELSEWHERE}:{free_port()}"'
        )
        server.start()
        (self.folder / "uplinkd.toml").write_text(with_it, encoding="utf-8")
        server.process.send_signal(signal.SIGHUP)
        server.wait_for_line(" reloaded ")
        self.assertRegex(server.text(), r' reloaded .*needs_restart="?[^ ]*listen\.metrics')

    def refused(self, address):
        """What the server says of this listen.metrics, at which it does not start."""
        server = Server(self.folder)
        done = subprocess.run(
            [str(BIN / "uplinkd"), "--config", str(server.configuration())], capture_output=True, text=True,
            timeout=WAIT_SECONDS, check=False, env={"UPLINKD_LISTEN_METRICS": address},
        )  # fmt: skip
        self.assertNotEqual(done.returncode, 0)
        return done.stdout + done.stderr

    def test_an_address_that_cannot_be_had_is_refused_with_its_key(self):
        with socket.create_server((ELSEWHERE, 0)) as taken:
            address = f"{ELSEWHERE}:{taken.getsockname()[1]}"
            self.assertIn(f"listen.metrics: {address} cannot be bound: Address already in use", self.refused(address))
        self.assertRegex(self.refused("192.0.2.1:9090"), "listen.metrics: 192.0.2.1:9090 cannot be bound: ")
        self.assertRegex(self.refused("uplinkd.example:9090"), "(LISTEN_METRICS|listen.metrics).*must be a literal address")


if __name__ == "__main__":
    unittest.main()
