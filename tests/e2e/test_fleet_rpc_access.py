"""Who gets what on listen.fleet: the table of rights by both doors, fleets, what is taken back, and bounds."""

import contextlib
import hashlib
import json
import socket
import ssl
import subprocess

import test_access
from google.protobuf import descriptor_pb2
from harness import BIN, run, wait_until
from test_fleet_rpc import CLIENT, HEALTH, PATHS, PYTHON, SECONDS, VIEW, FleetRpc, fixed

ADMIN = "/uplink.v1.FleetAdmin/"
COMMANDS = {
    "BlockRobot": "robot/block",
    "UnblockRobot": "robot/unblock",
    "DisconnectRobot": "robot/disconnect",
    "NoteRobot": "robot/note",
    "AddRobot": "robot/add",
    "RevokeCertificate": "certificates/revoke",
    "UnrevokeCertificate": "certificates/unrevoke",
    "ListRevocations": "certificates/revocations",
    "AcknowledgeFault": "faults/acknowledge",
    "ListAudit": "audit",
    "Reload": "reload",
}
# What a call without parameters comes to where it is allowed.
ALLOWED = {"OK", "INVALID_ARGUMENT", "NOT_FOUND"}
REQUEST_BYTES_MAX = 64 * 1024
IDLE = 100
CHECKS = 200


class Rights(FleetRpc):
    def methods(self):
        """Path and path of HTTP of each method of the contract."""
        files = descriptor_pb2.FileDescriptorSet.FromString(self.files.read_bytes())
        of_http = {**{VIEW + name: path for name, path in {**PATHS, "WatchRobots": "watch"}.items()},
                   **{ADMIN + name: path for name, path in COMMANDS.items()}}  # fmt: skip
        served = {f"/{file.package}.{service.name}/{method.name}" for file in files.file
                  for service in file.service for method in service.method if service.name.startswith("Fleet")}  # fmt: skip
        self.assertEqual(served, set(of_http))
        return sorted(of_http.items())

    def test_each_method_follows_the_row_of_its_path(self):
        holders = {role + star: self.token(role, *fleets)
                   for role in test_access.ROLES for star, fleets in (("*", ()), ("", ("north",)))}  # fmt: skip
        server = self.serve(f'[http]\ntokens_file = "{self.tokens}"\n')
        methods = self.methods()
        calls = [(method, {}, "watch", 1) if method.endswith("/WatchRobots") else (method, {}) for method, _ in methods]
        for (method, _), answer in zip(methods, self.call(server, *calls)):
            self.assertEqual(answer["code"], "UNAUTHENTICATED", method)
        server.uplinkctl("pki", "robot", "--dir", server.pki, "--ruri", "rcan://example.org/acme/rover/r1", "--fleet", "north")
        pair = (server.pki / "robot.crt", server.pki / "robot.key")
        for (method, _), answer in zip(methods, self.call(server, *calls, pair=pair)):
            self.assertEqual(answer["code"], "PERMISSION_DENIED", method)
            self.assertIn("has the role robot", answer["details"])
        rights = {**test_access.RIGHTS, **test_access.COMMANDS}
        for holder, token in holders.items():
            for (method, path), answer in zip(methods, self.call(server, *calls, token=token)):
                may = rights.get(f"/api/v1/{path}", test_access.READ)
                verb = "POST" if f"/api/v1/{path}" in test_access.COMMANDS else "GET"
                by_http = test_access.ask(self.plain(server), f"/api/v1/{path}", token, verb)
                with self.subTest(holder=holder, method=method):
                    if holder in may:
                        self.assertIn(answer["code"], ALLOWED, answer)
                        self.assertIn(by_http.status, (200, 400, 404), by_http.body)
                    else:
                        self.assertEqual((answer["code"], by_http.status), ("PERMISSION_DENIED", 403))
                        # One sentence, by either door.
                        self.assertEqual(answer["details"], by_http.error()["message"])

    def test_another_fleet_is_as_one_that_is_not_there(self):
        tokens = {fleet: self.token("operator", fleet) for fleet in ("*", "north")}
        server = self.serve()
        self.report(server, 2)
        [robot, _] = server.get("/api/v1/robots")["robots"]
        self.assertEqual(server.terminate(60), 0)
        server.settings = f'[http]\ntokens_file = "{self.tokens}"\n'
        self.again(server)
        [own] = self.call(server, (VIEW + "GetRobot", {"ruri": robot["ruri"]}), token=tokens["*"])
        self.assertEqual((own["code"], own["answer"]["fleet"]), ("OK", "default"))
        other, unknown = robot["ruri"], robot["ruri"] + "-unknown"
        for method in (VIEW + "GetRobot", VIEW + "GetRobotStory", *(ADMIN + name + "Robot" for name in
                       ("Block", "Unblock", "Disconnect", "Note"))):  # fmt: skip
            hidden, missing = self.call(server, (method, {"ruri": other}), (method, {"ruri": unknown}), token=tokens["north"])
            with self.subTest(method=method):
                self.assertEqual(hidden["code"], "NOT_FOUND", hidden)
                self.assertEqual(json.dumps(hidden).replace(other, ""), json.dumps(missing).replace(unknown, ""))
        for name in ("ListRobots", "ListEvents", "ListFaults", "ListConnections"):
            hidden, missing = self.call(server, *((VIEW + name, {"fleet": fleet}) for fleet in ("default", "unknown")),
                                        token=tokens["north"])  # fmt: skip
            self.assertEqual(hidden["code"], "OK", hidden)
            self.assertEqual(fixed(hidden), fixed(missing), name)


class TakenBack(FleetRpc):
    def test_a_revoked_token_opens_nothing_and_ends_its_watch(self):
        token = self.token("viewer")
        server = self.serve(f'[http]\ntokens_file = "{self.tokens}"\n')
        watch = self.follow(server, VIEW + "WatchRobots", {}, token=token)
        self.assertEqual(next(watch), {"snapshotEnd": {}})
        (line,) = self.tokens.read_text().splitlines()
        run(BIN / "uplinkctl", "tokens", "revoke", "--tokens-file", self.tokens, json.loads(line)["id"])
        self.assertEqual(next(watch)["end"]["code"], "UNAUTHENTICATED")
        [answer] = self.call(server, (VIEW + "ListRobots", {}), token=token)
        self.assertEqual(answer["code"], "UNAUTHENTICATED")

    def test_a_revoked_certificate_opens_nothing_and_ends_its_watch(self):
        server = self.serve()
        admin, viewer = (self.certificate(server, role) for role in ("admin", "viewer"))
        watch = self.follow(server, VIEW + "WatchRobots", {}, pair=viewer)
        self.assertEqual(next(watch), {"snapshotEnd": {}})
        [revoked] = self.call(server, (ADMIN + "RevokeCertificate", {"sha256": self.digest(viewer[0])}),
                              pair=admin)  # fmt: skip
        self.assertEqual(revoked["code"], "OK", revoked)
        self.assertIn(next(watch)["end"]["code"], ("UNAUTHENTICATED", "UNAVAILABLE"))
        [answer] = self.call(server, (VIEW + "ListRobots", {}), pair=viewer)
        self.assertIn(answer["code"], ("UNAUTHENTICATED", "UNAVAILABLE"))
        [answer] = self.call(server, (VIEW + "ListRobots", {}), pair=admin)
        self.assertEqual(answer["code"], "OK")

    def digest(self, certificate):
        der = ssl.PEM_cert_to_DER_cert(certificate.read_text())
        return hashlib.sha256(der).hexdigest()


class Bounds(FleetRpc):
    def test_a_request_that_is_too_large_is_refused(self):
        server = self.serve()
        viewer = self.certificate(server, "viewer")
        large, small = self.call(server, (VIEW + "GetRobot", {"ruri": "r" * (REQUEST_BYTES_MAX + 1)}),
                                 (VIEW + "ListRobots", {}), pair=viewer)  # fmt: skip
        self.assertEqual(large["code"], "RESOURCE_EXHAUSTED", large)
        self.assertEqual(small["code"], "OK")

    def test_strangers_that_say_nothing_keep_no_operator_out(self):
        server = self.serve()
        viewer = self.certificate(server, "viewer")
        context = ssl.create_default_context(cafile=server.pki / "ca.crt")
        context.check_hostname = False
        context.set_alpn_protocols(["h2"])
        host, port = server.fleet.rsplit(":", 1)
        held = []
        for at in range(IDLE):
            end = socket.create_connection((host, int(port)), SECONDS)
            self.addCleanup(end.close)
            # Every other one ends its handshake.
            held.append(context.wrap_socket(end) if at % 2 else end)
            self.addCleanup(held[-1].close)
        [answer] = self.call(server, (VIEW + "ListRobots", {}), pair=viewer)
        self.assertEqual(answer["code"], "OK", answer)
        for end in held[1::2]:
            end.settimeout(SECONDS)
            while end.recv(4096):
                pass
        self.assertEqual(server.terminate(60), 0)


    def test_strangers_whose_checks_never_come_whole_keep_no_operator_out(self):
        server = self.serve()
        viewer = self.certificate(server, "viewer")
        # More than the server answers at a time.
        with self.held_checks(server, CHECKS):
            for _ in range(2):
                [answer] = self.call(server, (VIEW + "ListRobots", {}), pair=viewer)
                self.assertEqual(answer["code"], "OK", answer)

    @contextlib.contextmanager
    def held_checks(self, server, count):
        """So many Health/Check calls of a stranger whose requests never come."""
        task = self.task(server, None, None)
        client = subprocess.Popen([PYTHON, str(CLIENT)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        try:
            with client.stdin as sent:
                json.dump({**task, "hold": [HEALTH + "Check", count]}, sent)
            self.assertEqual(client.stdout.readline(), "held\n")
            yield
        finally:
            client.kill()
            client.wait()
            client.stdout.close()


class Watch(FleetRpc):
    def until(self, watch, condition):
        for change in watch:
            self.assertNotIn("end", change)
            if condition(change):
                return change
        raise AssertionError("the watch ended")

    def test_robots_come_change_are_blocked_and_match_no_more(self):
        server = self.serve('[presence]\ntimeout = "3s"')
        operator = self.certificate(server, "operator")
        fleet = self.fleet(server, "--robots", 2)
        server.wait_for_status(lambda status: status["robots"].get("online") == "2", SECONDS, "robots are here")
        watch = self.follow(server, VIEW + "WatchRobots", {"filter": {"presence": "online"}}, pair=operator)
        snapshot = [next(watch) for _ in range(3)]
        self.assertEqual(snapshot[2], {"snapshotEnd": {"robots": "2"}})
        ruri = snapshot[0]["robot"]["ruri"]

        def of(change):
            return change.get("robot", {}) if change.get("robot", {}).get("ruri") == ruri else None

        self.until(watch, of)
        [answer] = self.call(server, (ADMIN + "BlockRobot", {"ruri": ruri, "reason": "a test"}), pair=operator)
        self.assertEqual(answer["code"], "OK", answer)
        self.assertEqual(self.until(watch, lambda change: "removed" in change), {"removed": ruri})
        [answer] = self.call(server, (ADMIN + "UnblockRobot", {"ruri": ruri}), pair=operator)
        self.assertEqual(answer["code"], "OK", answer)
        self.until(watch, of)
        fleet.close()
        left = {self.until(watch, lambda change: "removed" in change)["removed"] for _ in range(2)}
        self.assertEqual(left, {each["robot"]["ruri"] for each in snapshot[:2]})
        wait_until(server.process, lambda: server.metric("uplinkd_watches") == 1, SECONDS, "it watches on")
