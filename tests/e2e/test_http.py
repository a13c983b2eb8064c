"""What HTTP shows to whom, and what others cannot take from probes."""

import contextlib
import json
import socket
import unittest

from harness import EndToEnd



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


if __name__ == "__main__":
    unittest.main()
