"""What HTTP shows to whom, and what others cannot take from probes."""

import contextlib
import email.utils
import http.client
import json
import socket
import sqlite3
import subprocess
import time
import unittest
import urllib.request

from harness import Cluster, EndToEnd, Server, run, wait_until

WAIT_SECONDS = 30


def connect(server):
    host, port = server.http.rsplit(":", 1)
    return socket.create_connection((host, int(port)), timeout=10)


def ask(server, target, host="localhost", headers=""):
    """Status and body of one answer, on a connection of its own."""
    with contextlib.closing(connect(server)) as end:
        end.sendall(f"GET {target} HTTP/1.1\r\nHost: {host}\r\n{headers}Connection: close\r\n\r\n".encode())
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


class Clients(EndToEnd):
    """What clients of other makes send."""

    def setUp(self):
        super().setUp()
        self.running = self.server().start()

    def curl(self, *arguments):
        return run("curl", "-sS", "--noproxy", "", "--max-time", str(WAIT_SECONDS), *arguments).stdout

    def test_curl_waits_with_a_body_and_is_told_to_go_on(self):
        url = f"http://{self.running.http}/livez"
        said = self.curl("-i", "-X", "GET", "-H", "Expect: 100-continue", "--expect100-timeout", "20", "-d", "abc", url)
        self.assertEqual([line.split()[1] for line in said.splitlines() if line.startswith("HTTP/")], ["100", "200"])

    def test_curl_asks_as_of_a_proxy(self):
        said = self.curl("-i", "-x", f"http://{self.running.http}", "http://localhost/api/v1/status")
        self.assertIn("startedAt", said)
        said = self.curl("-i", "-x", f"http://{self.running.http}", "http://rebound.example/api/v1/status")
        self.assertIn(" 421 ", said.splitlines()[0])

    def test_curl_sends_chunks_and_is_refused(self):
        said = self.curl(
            "-i", "-X", "GET", "-H", "Transfer-Encoding: chunked", "-d", "abc", f"http://{self.running.http}/livez"
        )
        self.assertIn(" 400 ", said.splitlines()[0])
        self.assertIn("Transfer-Encoding is not taken", said)

    def test_answers_have_the_time_and_say_how_long_their_connection_is_kept(self):
        with urllib.request.urlopen(f"http://{self.running.http}/livez", timeout=WAIT_SECONDS) as answer:
            date = email.utils.parsedate_to_datetime(answer.headers["Date"])
        self.assertLess(abs(time.time() - date.timestamp()), WAIT_SECONDS)
        connection = http.client.HTTPConnection(self.running.http, timeout=WAIT_SECONDS)
        connection.request("GET", "/livez")
        self.assertEqual(connection.getresponse().headers["Keep-Alive"], "timeout=75")
        connection.close()


class Memory(EndToEnd):
    SHAPES = 1000
    # As a robot that says 2,000 times the position 0, 0: this is what it made of 160 bytes.
    POSITIONS = 2000
    GROWTH_MAX = 200 << 20

    def kibibytes(self, server, field):
        with open(f"/proc/{server.process.pid}/status", encoding="ascii") as status:
            return next(int(line.split()[1]) for line in status if line.startswith(field + ":"))

    def test_a_list_of_a_thousand_shapes_takes_little_memory(self):
        server = self.server().start()
        geometry = '{"type":"LineString","coordinates":[' + ",".join(["[0E0,0E0]"] * self.POSITIONS) + "]}"
        rest = (0, "", 0, "", 0, 0, 0.0, 0.0, 0, geometry)
        rows = [("rcan://a", str(i), "f", 0, i, i, *rest) for i in range(self.SHAPES)]
        with contextlib.closing(sqlite3.connect(self.folder / "uplinkd.db", timeout=WAIT_SECONDS)) as store:
            with store:
                store.executemany(f"INSERT INTO shapes VALUES ({','.join('?' * 16)})", rows)
        before = self.kibibytes(server, "VmRSS")
        seen, pages, token = set(), 0, ""
        while pages == 0 or token:
            status, body = ask(server, f"/api/v1/shapes?pageSize={self.SHAPES}&pageToken={token}")
            self.assertEqual(status, 200, body[:200])
            page = json.loads(body)
            for shape in page["shapes"]:
                self.assertEqual(len(shape["geometry"]["coordinates"]), self.POSITIONS)
                seen.add(shape["id"])
            token, pages = page["nextPageToken"], pages + 1
        self.assertEqual(len(seen), self.SHAPES)
        self.assertEqual(pages, 2, "a page ends at 16 MiB of texts")
        peak = self.kibibytes(server, "VmHWM") - before
        print(f"a list of shapes: memory grew by {peak / 1024:.0f} MiB")
        self.assertLess(peak << 10, self.GROWTH_MAX)


class SlowReads(EndToEnd):
    """A lock on a table that one list reads, and nothing else."""

    LOCK = "BEGIN; LOCK TABLE uplinkd.events IN ACCESS EXCLUSIVE MODE; SELECT pg_sleep(60); COMMIT;"

    def setUp(self):
        super().setUp()
        self.cluster = Cluster(self.folder).create().migrate()
        self.open_things.append(self.cluster)
        server = Server(self.folder, 'timeout = "2s"', self.cluster.url("uplinkd"))
        self.open_things.append(server)
        self.server_ = server.start()

    def locked(self):
        held = "relation = 'uplinkd.events'::regclass AND mode = 'AccessExclusiveLock' AND granted"
        return self.cluster.sql(f"SELECT count(*) FROM pg_locks WHERE {held}") != "0"

    def test_a_read_at_its_limit_is_504_and_nobody_waits_behind_it(self):
        server = self.server_
        holder = subprocess.Popen(
            ["psql", "-X", "-q", "-c", self.LOCK, self.cluster.url("postgres")], stdout=subprocess.DEVNULL
        )
        try:
            wait_until(server.process, self.locked, WAIT_SECONDS, "the table is locked")
            slow = connect(server)
            slow.sendall(
                b"GET /api/v1/events HTTP/1.1\r\n"
                b"Host: localhost\r\nConnection: close\r\n\r\n"
            )
            for target in ("/api/v1/status", "/api/v1/robots", "/api/v1/faults", "/api/v1/gaps"):
                self.assertEqual(ask(server, target)[0], 200, target)
            slow.setblocking(False)
            with self.assertRaises(BlockingIOError, msg="the slow read is answered already"):
                slow.recv(1)
            slow.settimeout(WAIT_SECONDS)
            answer = b""
            while part := slow.recv(1 << 16):
                answer += part
            slow.close()
            self.assertIn(b" 504 ", answer.split(b"\r\n")[0])
            self.assertIn(b"store.timeout", answer)
            self.assertNotIn(self.cluster.place["folder"].encode(), answer)
            self.assertNotIn(b"57014", answer)
            server.wait_for_line("http_answer_failed")
        finally:
            holder.kill()
            holder.wait(WAIT_SECONDS)


if __name__ == "__main__":
    unittest.main()
