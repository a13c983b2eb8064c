"""A certificate that is revoked at one server ends its stream at each, whatever the ways to the store
do. How long that took is printed and not judged: a busy machine takes its time."""

import contextlib
import hashlib
import http.client
import json
import pathlib
import ssl
import subprocess
import threading
import time
import urllib.request

from harness import SOURCE, EndToEnd, uplinkctl, wait_until
from tcp_proxy import TcpProxy
from two_servers import A, B, TwoServers

PYTHON = "/usr/bin/python3"
CLIENT = pathlib.Path(__file__).with_name("revoked_robots.py")
REVOCATIONS = 100
FEW = 10
SECONDS = 60


class DeafWay(TcpProxy):
    """A way to the store by which no server hears of changes, and that can lose its connections."""

    def __init__(self, *targets):
        self.unheard = 0
        self.lost = set()
        super().__init__(*targets)

    def lose(self):
        """Those that stand pass nothing any more, and no end of them is told; new ones are not concerned."""
        with self.lock:
            self.lost.update(self.connections)

    def _take(self, ends, source, data):
        if ends in self.lost:
            return b""
        if source is ends[0] and b"LISTEN uplinkd_access" in data:
            self.unheard += 1
            return b""
        return data


class LockedWay(DeafWay):
    """A way to the store that can lose a connection once that has locked what changes go by."""

    def __init__(self, *targets):
        self.armed = False
        self.locked = threading.Event()
        super().__init__(*targets)

    def _take(self, ends, source, data):
        if self.armed and source is ends[0] and b"access_version" in data and b"FOR UPDATE" in data:
            self.armed = False
            # The question passes, and no answer to it.
            self.lost.add(ends)
            self.locked.set()
            return data
        return super()._take(ends, source, data)


class Robots:
    """Robots of an authority, each with a certificate of its own, in one process."""

    def __init__(self, test, pki):
        self.pki = pki
        modules = test.folder / "modules"
        modules.mkdir()
        subprocess.run(
            ["protoc", f"--proto_path={SOURCE / 'proto'}", f"--python_out={modules}", "uplink/v1/relay.proto"],
            check=True, timeout=SECONDS,
        )  # fmt: skip
        self.ends = test.folder / "ends.jsonl"
        with self.ends.open("wb") as ends:
            self.process = subprocess.Popen(
                [PYTHON, CLIENT, pki / "ca.crt"], stdin=subprocess.PIPE, stdout=ends,
                env={"PYTHONPATH": str(modules), "PATH": "/usr/bin"},
            )  # fmt: skip
        self.certificates = {}
        self.asked = {}
        test.open_things.append(self)

    def add(self, count, relay):
        for _ in range(count):
            name = f"r{len(self.certificates)}"
            ruri = f"rcan://example.org/acme/rover/{name}"
            uplinkctl("pki", "robot", "--dir", self.pki, "--ruri", ruri, "--fleet", "acme", "--name", name)
            target = f"localhost:{relay.rsplit(':', 1)[1]}"
            line = f"{target} {ruri} {self.pki / name}.crt {self.pki / name}.key\n"
            self.process.stdin.write(line.encode())
            self.certificates[ruri] = self.pki / f"{name}.crt"
        self.process.stdin.flush()

    def revoke_all_at(self, server):
        for ruri, certificate in self.certificates.items():
            der = ssl.PEM_cert_to_DER_cert(certificate.read_text(encoding="ascii"))
            body = {"sha256": hashlib.sha256(der).hexdigest(), "reason": "stolen"}
            request = urllib.request.Request(f"http://{server.http}/api/v1/certificates/revoke",
                                             json.dumps(body).encode(), {"Content-Type": "application/json"})  # fmt: skip
            self.asked[ruri] = time.monotonic()
            with urllib.request.urlopen(request, timeout=SECONDS) as answer:
                assert answer.status == 200, answer.status

    def all_ends(self):
        text = self.ends.read_text(encoding="utf-8")
        ends = [json.loads(line) for line in text.splitlines(keepends=True) if line.endswith("\n")]
        return ends if len(ends) == len(self.certificates) else None

    def assert_all_end(self, test, what):
        """Each by its revocation."""
        ends = wait_until(self.process, self.all_ends, SECONDS, "each stream ends")
        ways = {(end["code"], end["details"]) for end in ends}
        test.assertEqual(ways, {("UNAUTHENTICATED", "certificate revoked")})
        test.assertEqual({end["ruri"] for end in ends}, set(self.certificates))
        took = sorted(1000 * (end["at"] - self.asked[end["ruri"]]) for end in ends)
        print(f"{what}: {len(took)} revocations, ms: median {took[len(took) // 2]:.0f}, slowest {took[-1]:.0f}")

    def close(self):
        self.process.stdin.close()
        self.process.kill()
        self.process.wait(SECONDS)


class WithRobots(TwoServers):
    way_to_store = DeafWay
    # Longer than a test waits: what waits for an answer of the store so long fails it.
    settings = 'timeout = "4m"\n'

    def setUp(self):
        super().setUp()
        for server in self.servers:
            server.start()
        self.robots = Robots(self, self.servers[A].pki)

    def add(self, count, *places):
        for place in places:
            self.robots.add(count // len(places), self.servers[place].relay)
        for place in places:
            self.wait_for(lambda at=place: self.streams(at) == count // len(places), "all stream", place, SECONDS)


class OnPostgres(WithRobots):
    def test_each_revocation_ends_its_stream_at_both_with_listen_cut(self):
        self.add(REVOCATIONS, A, B)
        self.robots.revoke_all_at(self.servers[A])
        self.robots.assert_all_end(self, "PostgreSQL, LISTEN cut")
        self.assertTrue(all(way.unheard for way in self.stores), "no way has kept a LISTEN from the store")

    def test_a_server_whose_connections_were_lost_without_a_word_ends_them_too(self):
        self.add(FEW, B)
        self.stores[B].lose()
        self.robots.revoke_all_at(self.servers[A])
        self.robots.assert_all_end(self, "PostgreSQL, connections lost")


class LostInTheMiddle(WithRobots):
    way_to_store = LockedWay

    def test_a_server_that_is_lost_in_the_middle_of_a_change_delays_none_of_others(self):
        self.add(FEW, B)
        self.stores[A].armed = True
        # Its answer comes once A gives up, which takes longer than the test.
        threading.Thread(target=self.note, args=(self.servers[A],), daemon=True).start()
        self.assertTrue(self.stores[A].locked.wait(SECONDS), "A has not begun to change anything")
        self.robots.revoke_all_at(self.servers[B])
        self.robots.assert_all_end(self, "PostgreSQL, a change lost in the middle")

    @staticmethod
    def note(server):
        request = urllib.request.Request(
            f"http://{server.http}/api/v1/robot/note?ruri=rcan://example.org/acme/rover/noted",
            json.dumps({"note": "x"}).encode(), {"Content-Type": "application/json"})  # fmt: skip
        with contextlib.suppress(OSError, http.client.HTTPException), urllib.request.urlopen(request, timeout=SECONDS):
            pass


class OnSqlite(EndToEnd):
    def test_each_revocation_ends_its_stream(self):
        server = self.server().start()
        robots = Robots(self, server.pki)
        robots.add(FEW, server.relay)
        wait_until(server.process, lambda: server.metric("uplinkd_streams") == FEW, SECONDS, "all stream")
        robots.revoke_all_at(server)
        robots.assert_all_end(self, "SQLite")
