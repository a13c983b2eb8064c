"""The life of a real uplinkd: crashes, restarts, drain."""

import random
import socket
import ssl
import threading
import unittest

from harness import EndToEnd, uplinkctl

KILLS = 20
ROUND_SECONDS = 30
DRAIN_SECONDS = 10


class Crash(EndToEnd):
    def test_kill_under_load_loses_nothing_acked_and_doubles_nothing(self):
        choose = random.Random(3)
        server = self.server().start()
        fleet = self.fleet(
            server, "--robots", 8, "--rate", 10, "--faults", 20, "--malformed-share", 0.05, "--seed", 3
        )
        for kill in range(KILLS):
            # The counters start from zero in each process: so many commits, then the end.
            stored = choose.randint(1, 150)
            server.wait_for_status(
                lambda status: int(status["uplinks"]["stored"]) >= stored,
                ROUND_SECONDS,
                f"{stored} stored after kill {kill}",
            )
            server.kill()
            server.start()
        server.wait_for_status(lambda status: int(status["streams"]) == 8, ROUND_SECONDS, "all are back")
        report = self.assert_agrees(fleet)
        self.assertTrue(report["run"]["serverRestarted"])
        self.assertGreater(report["run"]["resent"], 0)
        self.assertGreater(report["run"]["ackedDurable"], KILLS)
        self.assertGreaterEqual(report["run"]["welcomes"], 8 + KILLS)
        self.assertEqual(server.terminate(DRAIN_SECONDS + 10), 0)


def settling(server):
    """The robots that have something settled, so that they were welcomed."""
    robots = (server.get("/api/v1/robots") or {"robots": []})["robots"]
    return [robot for robot in robots if int(robot["settledSeq"]) > 0]


class Drain(EndToEnd):
    def test_a_drain_finishes_acks_and_the_fleet_comes_back(self):
        server = self.server(f'[drain]\ntimeout = "{DRAIN_SECONDS}s"').start()
        fleet = self.fleet(server, "--robots", 8, "--faults", 20, "--malformed-share", 0.02)
        # A stream that was not welcomed yet gets no Drain.
        server.wait_for_status(
            lambda status: int(status["uplinks"]["stored"]) >= 20 and len(settling(server)) == 8,
            ROUND_SECONDS, "the whole fleet is at work",
        )  # fmt: skip
        self.assertEqual(server.terminate(DRAIN_SECONDS + 5), 0, server.text())
        self.assertNotIn("stopped_unsettled", server.text())
        server.start()
        server.wait_for_status(lambda status: int(status["streams"]) == 8, ROUND_SECONDS, "all are back")
        report = self.assert_agrees(fleet)
        self.assertGreaterEqual(report["run"]["drains"], 8)
        self.assertGreaterEqual(report["run"]["ends"]["UNAVAILABLE"], 8)


class Tickets(EndToEnd):
    """TLS 1.3 session tickets: OpenSSL sends two a handshake unless it is told not to."""

    def context(self, server, purpose):
        context = ssl.SSLContext(purpose)
        context.load_verify_locations(server.pki / "ca.crt")
        context.verify_mode = ssl.CERT_REQUIRED
        context.minimum_version = ssl.TLSVersion.TLSv1_3
        context.set_alpn_protocols(["h2"])
        return context

    def has_ticket(self, server, address):
        context = self.context(server, ssl.PROTOCOL_TLS_CLIENT)
        context.load_cert_chain(server.pki / "robot.crt", server.pki / "robot.key")
        with socket.create_connection(address, timeout=ROUND_SECONDS) as plain:
            with context.wrap_socket(plain, server_hostname="localhost") as link:
                # Tickets come before what the server says first.
                self.assertTrue(link.recv(1))
                return link.session.has_ticket

    def robot(self, server):
        uplinkctl("pki", "robot", "--dir", server.pki, "--ruri", "rcan://local/acme/arm/1")

    def test_the_relay_sends_none(self):
        server = self.server().start()
        self.robot(server)
        host, port = server.relay.rsplit(":", 1)
        self.assertFalse(self.has_ticket(server, (host, int(port))))

    def test_a_server_that_is_not_told_sends_some(self):
        server = self.server()
        self.robot(server)
        context = self.context(server, ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(server.pki / "server.crt", server.pki / "server.key")
        with socket.create_server(("127.0.0.1", 0)) as listener:
            def serve():
                with context.wrap_socket(listener.accept()[0], server_side=True) as link:
                    link.send(b"x")
                    link.recv(1)

            thread = threading.Thread(target=serve)
            thread.start()
            self.assertTrue(self.has_ticket(server, listener.getsockname()))
            thread.join(ROUND_SECONDS)


if __name__ == "__main__":
    unittest.main()
