"""What HTTP shows to whom, and what others cannot take from probes."""

import contextlib
import json
import socket
import unittest

from harness import EndToEnd

CONNECTIONS = 16


def connect(server):
    host, port = server.http.rsplit(":", 1)
    return socket.create_connection((host, int(port)), timeout=10)


def ask(server, target, host="localhost", connection=None):
    """Status and body of one answer, on a connection of its own."""
    with contextlib.closing(connection or connect(server)) as end:
        end.sendall(f"GET {target} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
        answer = b""
        while part := end.recv(1 << 16):
            answer += part
    head, _, body = answer.partition(b"\r\n\r\n")
    return int(head.split()[1]), body.decode()


class Names(EndToEnd):
    def test_data_are_shown_under_known_names_alone(self):
        server = self.server('[http]\nhosts = ["uplink.example.org"]').start()
        for target in ("/api/v1/status", "/api/v1/robots", "/"):
            status, body = ask(server, target, "rebound.example")
            self.assertEqual(status, 421, target)
            self.assertIn("http.hosts", json.loads(body)["error"]["message"])
        for host in ("localhost", server.http, "uplink.example.org:443"):
            self.assertEqual(ask(server, "/api/v1/status", host)[0], 200, host)
        for target in ("/livez", "/readyz", "/metrics", "/metrics/robots"):
            self.assertEqual(ask(server, target, "uplinkd.monitoring.svc")[0], 200, target)


class Connections(EndToEnd):
    def test_idle_clients_shut_no_probe_out(self):
        server = self.server(f"[http]\nconnections_max = {CONNECTIONS}").start()
        with contextlib.ExitStack() as held:
            idle = [held.enter_context(contextlib.closing(connect(server))) for _ in range(CONNECTIONS)]
            for end in idle:
                end.sendall(b"GET /api/v1/rob")  # and no more of it
            for target in ("/livez", "/readyz", "/metrics") * 3:
                self.assertEqual(ask(server, target)[0], 200, target)
            self.assertGreater(server.metric("uplinkd_http_connections_given_up_total"), 0)
            self.assertEqual(server.metric("uplinkd_http_connections_refused_total"), 0)

    def test_clients_that_are_served_shut_no_probe_out(self):
        server = self.server(f"[http]\nconnections_max = {CONNECTIONS}").start()
        with contextlib.ExitStack() as held:
            for _ in range(CONNECTIONS - 4):
                end = held.enter_context(contextlib.closing(connect(server)))
                end.sendall(b"GET /api/v1/status HTTP/1.1\r\nHost: localhost\r\n\r\n")
                self.assertIn(b" 200 ", end.recv(1 << 16))
            status, body = ask(server, "/api/v1/status")
            self.assertEqual((status, json.loads(body)["error"]["code"]), (503, "UNAVAILABLE"))
            self.assertEqual(ask(server, "/readyz")[0], 200)


if __name__ == "__main__":
    unittest.main()
