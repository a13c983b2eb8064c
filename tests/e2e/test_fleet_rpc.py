"""FleetView by gRPC on listen.fleet: who may ask what, and that it says what HTTP says."""

import base64
import contextlib
import hashlib
import json
import pathlib
import re
import ssl
import subprocess
import urllib.parse

import test_access
from google.protobuf import descriptor_pb2
from harness import SOURCE, wait_until

PYTHON = "/usr/bin/python3"
CLIENT = pathlib.Path(__file__).with_name("fleet_rpc_client.py")
SECONDS = 60
VIEW = "/uplink.v1.FleetView/"
HEALTH = "/grpc.health.v1.Health/"
# By method: the path of HTTP that answers the same.
PATHS = {
    "ListRobots": "robots",
    "GetRobot": "robot",
    "ListFaults": "faults",
    "ListEvents": "events",
    "ListMessages": "messages",
    "ListMissions": "missions",
    "ListMissionReports": "mission-reports",
    "ListOperatorRequests": "operator-requests",
    "ListShapes": "shapes",
    "ListObjects": "objects",
    "ListConnections": "connections",
    "GetRobotStory": "robot/story",
    "ListPresenceChanges": "presence",
    "ListQuarantine": "quarantine",
    "ListGaps": "gaps",
    "ListScopeUpdates": "scope-updates",
    "ListFleets": "fleets",
    "ListTop": "top",
    "ListCandidates": "candidates",
    "GetStatus": "status",
    "GetConfig": "config",
}
# What differs from one question to the next.
MOVING = {"now", "perSecond", "presenceSince", "heldByAt"}


def fixed(value):
    if isinstance(value, dict):
        return {key: fixed(each) for key, each in value.items() if key not in MOVING}
    if isinstance(value, float):
        return float(f"{value:.15g}")  # as many digits as gRPC promises (message_wire.h)
    return [fixed(each) for each in value] if isinstance(value, list) else value


class FleetRpc(test_access.Access):
    def setUp(self):
        super().setUp()
        self.files = pathlib.Path(self.folder) / "contract.bin"
        names = ["uplink/v1/fleet.proto", "uplink/v1/admin.proto", "grpc/health/v1/health.proto"]
        names += [f"grpc/reflection/{version}/reflection.proto" for version in ("v1", "v1alpha")]
        subprocess.run(["protoc", f"--proto_path={SOURCE / 'proto'}", "--include_imports",
                        f"--descriptor_set_out={self.files}", *names], check=True)  # fmt: skip

    def serve(self, settings=""):
        server = self.server(settings)
        server.environment = {"UPLINKD_LISTEN_FLEET": "127.0.0.1:0"}
        return self.again(server)

    def again(self, server):
        server.start()
        port = re.findall(r" listening .*? fleet=\"?[^ \"]*:(\d+)", server.text())[-1]
        server.fleet = f"127.0.0.1:{port}"
        return server

    def report(self, server, robots):
        """So many robots report, and leave."""
        fleet = self.fleet(server, "--robots", robots)
        server.wait_for_status(lambda status: int(status["messages"]["counts"].get("stored", 0)) > 5, SECONDS, "messages")
        self.assert_agrees(fleet)

    def task(self, server, pair, token):
        certificate, key = pair or (None, None)
        return {"target": server.fleet, "ca": str(server.pki / "ca.crt"), "certificate": certificate and str(certificate),
                "key": key and str(key), "token": token, "files": str(self.files)}  # fmt: skip

    def call(self, server, *calls, pair=None, token=None):
        task = self.task(server, pair, token)
        task["calls"] = [(*call, "unary", 0)[:4] if len(call) == 2 else call for call in calls]
        done = subprocess.run([PYTHON, str(CLIENT)], input=json.dumps(task), capture_output=True, text=True,
                              timeout=SECONDS, check=False)  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def follow(self, server, method, request, pair=None, token=None):
        """The answers of a stream as they come, and its end."""
        client = subprocess.Popen([PYTHON, str(CLIENT)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.addCleanup(client.stdout.close)
        self.addCleanup(client.wait)
        self.addCleanup(client.kill)
        with client.stdin as sent:
            json.dump({**self.task(server, pair, token), "follow": [method, request]}, sent)
        return (json.loads(line) for line in client.stdout)


class View(FleetRpc):
    def test_each_method_says_what_http_says(self):
        server = self.serve()
        self.report(server, 2)
        admin = self.certificate(server, "admin")
        robots = server.get("/api/v1/robots")["robots"]
        ruri = robots[0]["ruri"]
        requests = {name: {} for name in PATHS}
        requests["GetRobot"] = requests["GetRobotStory"] = {"ruri": ruri}
        requests["ListEvents"] = {"ruri": [ruri, robots[1]["ruri"]], "pageSize": 3, "orderBy": "oldest"}
        requests["ListRobots"] = {"parts": ["motion", "settings", "agentInfo"], "faulted": False, "presence": "offline"}
        seen = self.call(server, *((VIEW + name, request) for name, request in requests.items()), pair=admin)
        rows = 0
        for (name, request), answer in zip(requests.items(), seen):
            query = {key: ",".join(value) if key == "parts" else str(value).lower() if isinstance(value, bool) else value
                     for key, value in request.items()}  # fmt: skip
            expected = server.get(f"/api/v1/{PATHS[name]}?{urllib.parse.urlencode(query, doseq=True)}")
            with self.subTest(method=name):
                self.assertEqual(answer["code"], "OK", answer)
                if name == "ListQuarantine":
                    for row in answer["answer"]["quarantined"]:
                        base64.b64decode(row["payload"])
                shown = fixed(answer["answer"])
                self.assertEqual(shown, {**shown, **fixed(expected)})
                rows += sum(len(value) for value in shown.values() if isinstance(value, list))
        self.assertGreater(rows, 20)
        self.assertEqual(server.terminate(60), 0)

    def test_a_watch_begins_with_what_is_there(self):
        server = self.serve()
        self.report(server, 3)
        viewer = self.certificate(server, "viewer")
        [seen] = self.call(server, (VIEW + "WatchRobots", {}, "watch", 4), pair=viewer)
        expected = [robot["ruri"] for robot in server.get("/api/v1/robots")["robots"]]
        self.assertEqual(sorted(each["robot"]["ruri"] for each in seen["answers"][:-1]), expected)
        self.assertEqual(seen["answers"][-1], {"snapshotEnd": {"robots": "3"}})
        self.assertEqual(server.terminate(60), 0)

    def test_mistakes_are_told_as_http_tells_them(self):
        server = self.serve()
        viewer = self.certificate(server, "viewer")
        seen = self.call(
            server,
            (VIEW + "GetRobot", {"ruri": "rcan://none/a/b"}),
            (VIEW + "GetRobot", {}),
            (VIEW + "ListRobots", {"presence": "here"}),
            (VIEW + "ListEvents", {"pageSize": -1}),
            (VIEW + "ListEvents", {"pageToken": "x"}),
            pair=viewer,
        )
        codes = ["NOT_FOUND", "INVALID_ARGUMENT", "INVALID_ARGUMENT", "INVALID_ARGUMENT", "INVALID_ARGUMENT"]
        self.assertEqual([each["code"] for each in seen], codes, seen)
        for field, answer in zip(("ruri", "presence", "pageSize", "pageToken"), seen[1:]):
            self.assertTrue(answer["details"].startswith(field), answer)


class Callers(FleetRpc):
    def test_callers_show_a_certificate_or_a_token_whatever_http_asks_for(self):
        server = self.serve()
        question = (VIEW + "ListRobots", {})
        [nothing] = self.call(server, question)
        self.assertEqual(nothing["code"], "UNAUTHENTICATED")
        [foreign] = self.call(server, question, token="uplinkd_" + "A" * 43)
        self.assertEqual(foreign["code"], "UNAUTHENTICATED")
        server.uplinkctl("pki", "robot", "--dir", server.pki, "--ruri", "rcan://example.org/acme/rover/r1", "--fleet", "acme")
        [robot] = self.call(server, question, pair=(server.pki / "robot.crt", server.pki / "robot.key"))
        self.assertEqual(robot["code"], "PERMISSION_DENIED")
        self.assertIn("has the role robot", robot["details"])
        [viewer, config] = self.call(server, question, (VIEW + "GetConfig", {}), pair=self.certificate(server, "viewer"))
        self.assertEqual((viewer["code"], config["code"]), ("OK", "PERMISSION_DENIED"))
        self.assertEqual(server.terminate(60), 0)

    def test_a_token_opens_what_its_role_and_fleets_open(self):
        server = self.serve(f'[http]\ntokens_file = "{self.tokens}"\n')
        tokens = {role: self.token(role, "north") for role in test_access.ROLES}
        everything = self.token("admin")
        test_access.wait_until(
            server.process, lambda: self.call(server, (VIEW + "GetConfig", {}), token=everything)[0]["code"] == "OK",
            test_access.WAIT_SECONDS, "the tokens count",
        )  # fmt: skip
        for role, token in tokens.items():
            for name, path in PATHS.items():
                [answer] = self.call(server, (VIEW + name, {}), token=token) if name in ("ListRobots", "GetStatus") else [None]
                if answer is None:
                    continue
                may = role in test_access.RIGHTS.get(f"/api/v1/{path}", test_access.READ)
                with self.subTest(role=role, method=name):
                    self.assertEqual(answer["code"], "OK" if may else "PERMISSION_DENIED", answer)
        for token in tokens.values():
            self.assertNotIn(token, server.text())

    def test_a_source_that_fails_too_often_waits(self):
        server = self.serve(f'[http]\ntokens_file = "{self.tokens}"\n')
        wrong = [(VIEW + "ListRobots", {})] * (test_access.FAILURES_MAX + 1)
        codes = [each["code"] for each in self.call(server, *wrong, token="uplinkd_" + "A" * 43)]
        self.assertEqual(codes, ["UNAUTHENTICATED"] * test_access.FAILURES_MAX + ["RESOURCE_EXHAUSTED"])


class Tools(FleetRpc):
    def test_health_is_open_to_anyone(self):
        server = self.serve()
        check, view, unknown, watch = self.call(
            server, (HEALTH + "Check", {}), (HEALTH + "Check", {"service": "uplink.v1.FleetView"}),
            (HEALTH + "Check", {"service": "nothing"}), (HEALTH + "Watch", {}, "watch", 1),
        )  # fmt: skip
        self.assertEqual((check["answer"], view["answer"]), ({"status": "SERVING"}, {"status": "SERVING"}))
        self.assertEqual(unknown["code"], "NOT_FOUND")
        self.assertEqual(watch["answers"], [{"status": "SERVING"}])

    def test_tools_learn_what_is_served(self):
        server = self.serve()
        questions = [{"listServices": ""}, {"fileContainingSymbol": "uplink.v1.FleetView"}, {"fileContainingSymbol": "x.Y"}]
        viewer = self.certificate(server, "viewer")
        for version in ("v1", "v1alpha"):
            path = f"/grpc.reflection.{version}.ServerReflection/ServerReflectionInfo"
            [seen] = self.call(server, (path, questions, "talk", len(questions) + 1), pair=viewer)
            services, files, unknown = seen["answers"]
            names = {each["name"] for each in services["listServicesResponse"]["service"]}
            self.assertLessEqual({"uplink.v1.FleetView", "grpc.health.v1.Health"}, names)
            [talk] = self.call(server, (path, [{"fileContainingSymbol": "uplink.v1.FleetAdmin.BlockRobot"},
                                               {"fileByFilename": "uplink/v1/admin.proto"}], "talk", 3), pair=viewer)  # fmt: skip
            by_symbol, by_name = talk["answers"]
            self.assertEqual(by_symbol["fileDescriptorResponse"], by_name["fileDescriptorResponse"])
            first, *others = (
                descriptor_pb2.FileDescriptorProto.FromString(base64.b64decode(each))
                for each in files["fileDescriptorResponse"]["fileDescriptorProto"]
            )
            self.assertEqual(first.name, "uplink/v1/fleet.proto")
            self.assertEqual(set(first.dependency), {each.name for each in others})
            self.assertEqual(unknown["errorResponse"]["errorCode"], 5)


class Revoked(FleetRpc):
    def test_a_revoked_certificate_opens_nothing_by_either_door(self):
        server = self.server()
        server.settings = f'[http]\ntls.certificate_file = "{server.pki}/server.crt"\ntls.key_file = "{server.pki}/server.key"\n'
        server.environment = {"UPLINKD_LISTEN_FLEET": "127.0.0.1:0"}
        self.again(server)
        viewer, admin = self.certificate(server, "viewer"), self.certificate(server, "admin")
        held, operator = self.https(server, viewer), self.https(server, admin)
        with contextlib.closing(held), contextlib.closing(operator):

            def status(connection, method="GET", path="/api/v1/robots", body=None):
                connection.request(method, path, body, {"Content-Type": "application/json"} if body else {})
                answer = connection.getresponse()
                answer.read()
                return answer.status

            self.assertEqual(status(held), 200)
            self.assertEqual(self.call(server, (VIEW + "ListRobots", {}), pair=viewer)[0]["code"], "OK")
            der = ssl.PEM_cert_to_DER_cert(viewer[0].read_text())
            body = json.dumps({"sha256": hashlib.sha256(der).hexdigest(), "reason": "lost"})
            self.assertEqual(status(operator, "POST", "/api/v1/certificates/revoke", body), 200)
            wait_until(server.process, lambda: status(held) == 401, SECONDS, "the revocation counts")
        [refused] = self.call(server, (VIEW + "ListRobots", {}), pair=viewer)
        self.assertEqual((refused["code"], refused["details"]), ("UNAUTHENTICATED", "certificate revoked"))
        self.assertEqual(self.call(server, (VIEW + "ListRobots", {}), pair=admin)[0]["code"], "OK")
