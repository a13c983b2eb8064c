"""All descriptors of a server used by connections that show no certificate."""

import json
import os
import pathlib
import resource
import socket
import sqlite3
import subprocess
import time
import unittest

from harness import SOURCE, EndToEnd, uplinkctl, wait_until

PYTHON = "/usr/bin/python3"
CLIENT = pathlib.Path(__file__).with_name("relay_client.py")
RURI = "rcan://example.org/acme/rover/new"
ALLOWED = 512
CROWD = 800
# Of the allowed ones, fewer than the door would give to connections without a certificate.
SPARE = 40
ATTACKER = "127.0.0.66"
# Longer than a handshake may take.
HELD_SECONDS = 22
GETS_IN_SECONDS = 10
ROUND_SECONDS = 60


class Crowd:
    """Connections that say nothing; those that the server ends are made anew."""

    def __init__(self, relay):
        host, port = relay.rsplit(":", 1)
        self.address = (host, int(port))
        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, 4 * CROWD)), hard))
        self.members = [self.connect() for _ in range(CROWD)]

    def connect(self):
        member = socket.create_connection(self.address, timeout=5, source_address=(ATTACKER, 0))
        member.setblocking(False)
        return member

    def renew(self):
        for index, member in enumerate(self.members):
            try:
                ended = member.recv(4096) == b""
            except BlockingIOError:
                ended = False
            except OSError:
                ended = True
            if ended:
                member.close()
                self.members[index] = self.connect()

    def close(self):
        for member in self.members:
            member.close()


class Descriptors(EndToEnd):
    def setUp(self):
        super().setUp()
        self.running = self.server()
        self.running.wrapper = ["prlimit", f"--nofile={ALLOWED}:{ALLOWED}"]
        self.running.start()
        self.modules = self.folder / "modules"
        self.modules.mkdir()
        subprocess.run(
            ["protoc", f"--proto_path={SOURCE / 'proto'}", f"--python_out={self.modules}", "uplink/v1/relay.proto"],
            check=True, timeout=ROUND_SECONDS,
        )  # fmt: skip
        uplinkctl("pki", "robot", "--dir", self.running.pki, "--ruri", RURI, "--fleet", "acme")

    def in_use(self):
        return len(os.listdir(f"/proc/{self.running.process.pid}/fd"))

    def allow(self, descriptors):
        """Changes the soft limit of the running server."""
        pid = self.running.process.pid
        subprocess.run(["prlimit", "--pid", str(pid), f"--nofile={descriptors}:"], check=True)

    def stored(self):
        """Messages of the victim that are committed, by the store itself: HTTP may have no descriptor left."""
        with sqlite3.connect(f"file:{self.folder}/uplinkd.db?mode=ro", uri=True, timeout=30) as store:
            return store.execute("SELECT coalesce(max(cursor_seq), 0) FROM sessions").fetchone()[0]

    def wait_for_more(self, than):
        return wait_until(
            self.running.process, lambda: self.stored() > than and self.stored(), ROUND_SECONDS, "the victim streams on"
        )

    def new_robot(self):
        """Streams a thousand messages; how long that took."""
        began = time.monotonic()
        files = [str(self.running.pki / file) for file in ("ca.crt", "robot.crt", "robot.key")]
        done = subprocess.run(
            [PYTHON, str(CLIENT), "stream", self.running.relay, *files],
            env={**os.environ, "PYTHONPATH": str(self.modules)},
            capture_output=True, text=True, timeout=ROUND_SECONDS, check=False,
        )  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr + self.running.text())
        self.assertEqual(json.loads(done.stdout)["code"], "OK")
        return time.monotonic() - began

    def hold(self, crowd, look):
        """Keeps the crowd up for longer than a handshake may take, while the victim streams on."""
        until = time.monotonic() + HELD_SECONDS
        stored = self.stored()

        def over():
            crowd.renew()
            look()
            return time.monotonic() > until

        wait_until(self.running.process, over, ROUND_SECONDS, "the crowd is kept up", every=0.2)
        self.wait_for_more(stored)

    def victim(self):
        fleet = self.fleet(self.running, "--robots", 1, "--faults", 20)
        self.wait_for_more(0)
        return fleet

    def test_a_crowd_takes_no_descriptor_of_those_with_a_certificate(self):
        fleet = self.victim()
        crowd = Crowd(self.running.relay)
        self.open_things.append(crowd)
        most = []
        self.hold(crowd, lambda: most.append(self.in_use()))
        self.assertLess(max(most), ALLOWED * 3 // 4, "the crowd has its quarter, and no more")
        crowd.close()
        self.assert_agrees(fleet)
        self.assertLess(self.new_robot(), GETS_IN_SECONDS)
        self.running.wait_for_line(ATTACKER)

    def test_where_all_are_used_it_accepts_again_without_a_restart(self):
        fleet = self.victim()
        # Something else than the door takes what it counted on.
        limit = self.in_use() + SPARE
        self.allow(limit)
        crowd = Crowd(self.running.relay)
        self.open_things.append(crowd)
        wait_until(self.running.process, lambda: self.in_use() >= limit, ROUND_SECONDS, "all are used")
        self.hold(crowd, lambda: None)
        crowd.close()
        self.assert_agrees(fleet)
        self.assertLess(self.new_robot(), GETS_IN_SECONDS)


if __name__ == "__main__":
    unittest.main()
