"""docs/reference/openapi.yaml against a running server: neither says more than the other."""

import concurrent.futures
import copy
import fcntl
import json
import re
import unittest

from harness import SOURCE, wait_until
from openapi import Document, jsonschema, names_one, request, target
from openapi_server import LISTS, WAIT_SECONDS, Served

NOWHERE = "rcan://never/seen"
ROUTE = re.compile(r'^uplinkd_http_requests_total\{route="([a-z_]+)",code="([2-5]xx)"\} (\d+)$', re.MULTILINE)
VECTORS = SOURCE / "tests" / "conformance" / "vectors"

# Bytes of the -shm file that stand for SQLite's locks (its file format: the WAL-index).
WAL_LOCK_FIRST, WAL_LOCKS = 120, 8

# What a parameter's schema refuses; for texts anything is good but for the token.
WRONG = {"integer": ["0x1", "-1", "1.5"], "boolean": ["1", "TRUE"], "array": ["wheels", "motion;status"],
         "date-time": ["x", "1777636800000", "2026-05-01"]}
# One that is taken, for those whose schema does not name any.
GOOD = {"ruri": "rcan://a", "fleet": "default", "missionId": "m", "runId": "r", "parts": "health,settings",
        "id": "5b1f0c2e-7d0b-4a6f-9d57-0c6a2f1f3b11", "kind": "estopEngaged", "faultId": "f", "source": "arm",
        "q": "a", "bbox": "-1,-2,3,4.5", "software": "1", "offlineBefore": "2026-05-01T12:00:00Z",
        "certificateExpiresBefore": "2026-05-01T12:00:00Z", "batteryBelow": "20.5", "label": "site=hall2",
        "who": "local", "action": "reload", "target": "rcan://a",
        "from": "2026-05-01T12:00:00Z", "to": "2026-05-01T14:00:00+02:00"}  # fmt: skip
# Bodies of the vectors that answers show as they are.
BODIES = {
    "motionTelemetry": "MotionTelemetry", "statusTelemetry": "StatusTelemetry",
    "systemHealth": "SystemHealth", "usageTelemetry": "UsageTelemetry",
    "consumableStatus": "ConsumableStatus", "spatialDirectiveStatus": "SpatialDirectiveStatus",
    "agentInfo": "AgentInfo", "uiCapabilities": "UiCapabilities", "missionRunStatus": "MissionRunStatus",
}  # fmt: skip

# Their `detail` is whatever the sender said.
DETAIL_IN_OWN_FORM = ("messages", "scope_updates")


# The fixed fields of OpenAPI 3.1.0's objects (4.8) that the file has.
FIELDS = {
    "OpenAPI": "openapi info servers security paths components tags",
    "Info": "title version summary description license",
    "License": "name identifier",
    "Server": "url description",
    "Tag": "name description externalDocs",
    "Path Item": "get post",
    "Operation": "operationId tags summary description parameters requestBody responses",
    "Request Body": "content",
    "Parameter": "name in description required schema explode",
    "Response": "description headers content",
    "Header": "description schema",
    "Media Type": "schema",
    "Components": "headers parameters responses schemas securitySchemes",
    "Schema": "$ref title type enum const description pattern format default minimum maximum exclusiveMaximum minLength maxLength"
              " minItems maxItems items prefixItems properties required additionalProperties propertyNames"
              " dependentRequired contentEncoding anyOf oneOf discriminator",
}  # fmt: skip


class Offline(unittest.TestCase):
    """What the file says, without a server."""

    def setUp(self):
        self.document = Document()

    def objects(self):
        """Kind, place and value of every object of OpenAPI's own."""
        root, components = self.document.root, self.document.root["components"]
        yield from (("OpenAPI", "", root), ("Info", "info", root["info"]), ("Components", "components", components))
        yield "License", "info/license", root["info"]["license"]
        yield from (("Server", "servers", each) for each in root["servers"])
        yield from (("Tag", "tags", each) for each in root["tags"])
        for path, item in root["paths"].items():
            yield "Path Item", path, item
            yield from (("Operation", path, operation) for operation in item.values())
            for operation in item.values():
                if "requestBody" in operation:
                    yield "Request Body", path, operation["requestBody"]
                    yield from (("Media Type", path, each) for each in operation["requestBody"]["content"].values())
        yield from (("Parameter", name, each) for name, each in components["parameters"].items())
        responses = [(name, each) for name, each in components["responses"].items()]
        for path, item in root["paths"].items():
            for operation in item.values():
                responses += [(path, each) for each in operation["responses"].values() if "$ref" not in each]
        for name, each in responses:
            yield "Response", name, each
            yield from (("Media Type", name, media) for media in each.get("content", {}).values())
            yield from (("Header", name, header) for header in each.get("headers", {}).values() if "$ref" not in header)
        yield from (("Header", name, header) for name, header in components["headers"].items())
        yield from (("Schema", where, schema) for where, schema in self.document.schemas())

    def test_no_object_has_a_field_that_openapi_does_not_know(self):
        for kind, where, value in self.objects():
            self.assertEqual(set(value) - set(FIELDS[kind].split()), set(), f"{kind} {where}")

    def test_every_schema_is_a_json_schema(self):
        for where, schema in self.document.schemas():
            with self.subTest(where):
                jsonschema.Draft202012Validator.check_schema(schema)
                self.assertTrue({"$ref", "type", "anyOf", "oneOf"} & set(schema), "of no type")

    def test_every_union_and_its_objects_have_names(self):
        # Generated clients make a class of each, and call it by its name.
        for where, schema in self.document.schemas():
            for each in schema.get("anyOf", []) + schema.get("oneOf", []):
                with self.subTest(where, member=each):
                    self.assertEqual(where.count("/"), 1, "a union that is no schema of its own")
                    self.assertTrue("$ref" in each or "title" in each or list(each) == ["type"], "without a name")

    def test_the_words_of_readiness_are_the_programs(self):
        program = (SOURCE / "server/health/readiness.cc").read_text(encoding="utf-8")
        for schema, row in (("Degraded", r'\{"(\w+)",'), ("Refusal", r'refuses\.emplace_back\("(\w+)"\)')):
            words = re.findall(row, program)
            self.assertTrue(words)
            self.assertEqual(self.document.root["components"]["schemas"][schema]["enum"], words)

    def test_the_words_of_holding_back_are_the_programs(self):
        program = (SOURCE / "server/robot/held_back.cc").read_text(encoding="utf-8")
        words = re.findall(r'case HeldBack::\w+:\s+return "(\w*)"', program)
        self.assertEqual(self.document.root["components"]["schemas"]["HeldBack"]["enum"], words)

    def test_nothing_is_described_that_no_path_uses(self):
        used, more = set(), json.dumps(self.document.root["paths"])
        while more:
            new = set(re.findall(r"#/components/[A-Za-z0-9/]+", more)) - used
            used |= new
            more = "".join(json.dumps(self.document.look_up({"$ref": one})) for one in new)
        described = {
            f"#/components/{kind}/{name}"
            for kind, members in self.document.root["components"].items()
            if kind != "securitySchemes"
            for name in members
        }
        self.assertEqual(described - used, set())

    def test_the_vectors_are_what_the_schemas_say(self):
        seen = set()
        for path in sorted(VECTORS.glob("*.json")):
            [(variant, body)] = json.loads(path.read_text(encoding="utf-8")).items()
            if variant not in BODIES:
                continue
            seen.add(variant)
            with self.subTest(path.stem):
                self.assertEqual(self.document.named(BODIES[variant], body), [])
                self.assertNotEqual(self.document.named(BODIES[variant], {**body, "more": 1}), [])
        self.assertEqual(seen, set(BODIES))

    def test_every_member_of_the_vectors_is_described_one_by_one(self):
        for variant, name in BODIES.items():
            body = json.loads((VECTORS / f"{variant}.json").read_text(encoding="utf-8"))[variant]
            schema = self.document.root["components"]["schemas"][name]
            self.assertEqual(set(body), set(schema["properties"]), variant)


class Answers(Served):
    def test_every_answer_is_as_documented(self):
        server, _ = self.play()
        ruris = self.ruris(server)
        for path in self.operations:
            for ruri in ruris if names_one(path) else ruris[:1]:
                with self.subTest(path, ruri=ruri):
                    self.assertEqual(self.assert_documented(server, path, ruri).status, 200)
        parts = {"parts": "motion,status,extras,health,usage,consumables,directives,agentInfo,settings,uiCapabilities,"
                          "rcanState,cyberwave,uncrew"}
        for path, parameters in (
            ("/api/v1/robots", parts), ("/api/v1/faults", {"active": "true"}),
            ("/api/v1/shapes", {"includeExpired": "true"}), ("/api/v1/objects", {"includeExpired": "true"}),
        ):  # fmt: skip
            with self.subTest(path, parameters=parameters):
                answer = self.assert_documented(server, path, ruris[0], {**parameters, "pageSize": "1000"})
                self.assertEqual(answer.status, 200)
                self.assertTrue(answer.json()[LISTS[self.operations[path]["operationId"]]])
        self.assert_a_member_more_is_found(server, ruris[0])

    def assert_a_member_more_is_found(self, server, ruri):
        """The comparison itself: no object of an answer may hold a member that is not documented."""
        for path, operation in self.operations.items():
            answer = request(server, target(path, ruri))
            if answer.content_type != "application/json":
                continue
            response = self.document.response(operation, 200)
            own_form = {"detail"} if operation["operationId"] in DETAIL_IN_OWN_FORM else set()
            for changed in with_one_member_more(answer.json(), own_form):
                answer.body = json.dumps(changed)
                self.assertNotEqual(self.document.answer_problems(response, answer), [], answer.body)

    def test_every_page_of_a_walk_is_as_documented(self):
        # Nothing goes on, so that the walk and the whole page see the same.
        server, fleet = self.play('[presence]\ntimeout = "1h"')
        fleet.finish()
        ruri = self.ruri(server)
        for path, operation in self.operations.items():
            if operation["operationId"] not in LISTS:
                continue
            with self.subTest(path):
                name = LISTS[operation["operationId"]]
                more = {"includeExpired": "true"} if name in ("shapes", "objects") else {}
                whole = request(server, target(path, ruri, {"pageSize": "1000", **more})).json()[name]
                walked, token = [], ""
                while len(walked) < 20:
                    parameters = {"pageSize": "3", "pageToken": token, **more}
                    page = self.assert_documented(server, path, ruri, parameters).json()
                    walked += page[name]
                    token = page["nextPageToken"]
                    if not token:
                        break
                self.assertEqual(walked, whole[: len(walked)])
                self.assertEqual(token == "", len(walked) == len(whole))


class Paths(Served):
    def served(self, server):
        """Route to the number of its answers, by class."""
        counts = {}
        for route, code, count in ROUTE.findall(request(server, "/metrics").body):
            counts.setdefault(route, {})[code] = int(count)
        return counts

    def test_what_is_served_is_documented_and_the_other_way_round(self):
        server = self.server().start()
        both = [*self.operations.values(), *self.document.commands().values()]
        documented = {operation["operationId"] for operation in both}
        self.assertEqual(len(documented), len(both))
        self.assertEqual(documented | {"other"}, set(self.served(server)))
        for path, operation in self.operations.items():
            with self.subTest(path):
                before = sum(self.served(server)[operation["operationId"]].values())
                self.assertNotEqual(request(server, target(path, NOWHERE)).status, 405)
                after = sum(self.served(server)[operation["operationId"]].values())
                # The scrape itself counts for /metrics.
                self.assertEqual(after - before, 2 if path == "/metrics" else 1)

    def test_other_methods_and_other_paths(self):
        server = self.server().start()
        for path in self.operations:
            for method in ("POST", "PUT", "DELETE", "OPTIONS"):
                with self.subTest(path, method=method):
                    answer = self.assert_documented(server, path, NOWHERE, method=method)
                    self.assert_error(answer, 405, "UNIMPLEMENTED")
                    self.assertEqual(answer.allow, "GET, HEAD")
            head = request(server, target(path, NOWHERE), "HEAD")
            get = request(server, target(path, NOWHERE))
            self.assertEqual((head.status, head.content_type, head.body), (get.status, get.content_type, ""))
        for path, operation in self.document.commands().items():
            for method in ("GET", "PUT", "DELETE", "OPTIONS"):
                with self.subTest(path, method=method):
                    answer = request(server, path, method)
                    self.assert_error(answer, 405, "UNIMPLEMENTED")
                    self.assertEqual(answer.allow, "POST")
                    described = self.document.response(operation, 405)
                    self.assertEqual(self.document.answer_problems(described, answer), [])
        for path in ("/", "/api/v1", "/api/v1/nothing", "/api/v1/robots/a/b", "/api/v1/status/"):
            with self.subTest(path):
                self.assert_error(request(server, path), 404, "NOT_FOUND")

    def test_who_is_shown_nothing(self):
        covered = "[http]\nhosts_cover_metrics = true"
        for settings, shown_to_all in (("", {"probes"}), (covered, {"livez", "readyz"})):
            server = self.server(settings).start()
            for path, operation in self.operations.items():
                with self.subTest(path, settings=settings):
                    names = {operation["operationId"], *operation["tags"]}
                    foreign = self.assert_documented(server, path, NOWHERE, headers={"Sec-Fetch-Site": "cross-site"})
                    self.assertEqual(foreign.status == 403, "probes" not in names)
                    self.assertEqual("403" in operation["responses"], not names & {"livez", "readyz"})
                    other = self.assert_documented(server, path, NOWHERE, headers={"Host": "elsewhere.example"})
                    self.assertEqual(other.status == 421, not names & shown_to_all)
                    if settings:
                        self.assertEqual("421" in operation["responses"], other.status == 421)
            self.assertEqual(server.terminate(60), 0)

    def test_a_robot_that_was_never_seen(self):
        server = self.server().start()
        for path, operation in self.operations.items():
            with self.subTest(path):
                answer = self.assert_documented(server, path, NOWHERE, {})
                self.assertEqual(answer.status, 404 if names_one(path) else 200)
                self.assertEqual("404" in operation["responses"], names_one(path))

    def test_a_server_that_is_full_is_ready_and_says_so(self):
        server = self.server("[limits]\nrobots_max = 1").start()
        self.fleet(server, "--robots", 1)
        wait_until(
            server.process,
            lambda: "robots_max" in request(server, "/readyz").json().get("degraded", []),
            WAIT_SECONDS,
            "it is full",
        )
        answer = self.assert_documented(server, "/readyz", NOWHERE)
        self.assertEqual(answer.status, 200)


class Parameters(Served):
    def test_each_is_taken_and_nothing_else_is(self):
        server, _ = self.play()
        ruri = self.ruri(server)
        for path, operation in self.operations.items():
            parameters = self.document.parameters(operation, "query")
            for name, schema in parameters.items():
                with self.subTest(path, parameter=name):
                    for value in [ruri] if names_one(path) and name == "ruri" else good_values(name, schema):
                        answer = self.assert_documented(server, path, ruri, {name: value})
                        self.assertEqual(answer.status, 200, value)
                    for value in wrong_values(name, schema):
                        answer = self.assert_documented(server, path, ruri, {name: value})
                        self.assert_error(answer, 400, "INVALID_ARGUMENT", name)
            for name in sorted(self.every_parameter() - set(parameters)):
                with self.subTest(path, foreign=name):
                    answer = self.assert_documented(server, path, ruri, {name: GOOD.get(name, "1")})
                    self.assert_error(answer, 400, "INVALID_ARGUMENT", name)

    def every_parameter(self):
        names = {"nonsense", "pagesize"}
        for operation in self.operations.values():
            names |= set(self.document.parameters(operation, "query"))
        return names

    def test_a_token_of_another_list_is_refused(self):
        server, _ = self.play()
        tokens = {}
        for path, operation in self.operations.items():
            if operation["operationId"] in LISTS:
                pages = (request(server, target(path, ruri, {"pageSize": "1"})) for ruri in self.ruris(server))
                tokens[path] = max(page.json()["nextPageToken"] for page in pages)
        self.assertGreater(sum(map(bool, tokens.values())), len(tokens) / 2, tokens)
        ruri = self.ruri(server)
        for path in tokens:
            for origin, token in tokens.items():
                if token and origin != path:
                    with self.subTest(path, origin=origin):
                        answer = self.assert_documented(server, path, ruri, {"pageToken": token})
                        self.assert_error(answer, 400, "INVALID_ARGUMENT", "pageToken")


class Failing(Served):
    def test_what_needs_the_store_is_503_while_it_is_away(self):
        server, fleet = self.play()
        fleet.finish()
        ruri = self.ruri(server)
        with (self.folder / "uplinkd.db-shm").open("r+b") as shared:
            wait_until(server.process, lambda: locked(shared), WAIT_SECONDS, "the store is taken away")
            # Each takes as long as SQLite tries.
            asked = (("/api/v1/shapes", {}), ("/api/v1/robots", {"parts": "agentInfo"}), ("/api/v1/robots/{ruri}", {}))
            with concurrent.futures.ThreadPoolExecutor() as threads:
                *refused, answer = threads.map(lambda each: self.assert_documented(server, each[0], ruri, each[1]), asked)
            for each in refused:
                self.assert_error(each, 503, "UNAVAILABLE")
            self.assertEqual(answer.status, 200)
            self.assertIn("motion", answer.json())
            self.assertNotIn("agentInfo", answer.json())
        answer = self.assert_documented(server, "/api/v1/robots/{ruri}", ruri)
        self.assertIn("agentInfo", answer.json())


def locked(shared):
    """Takes the locks by which SQLite's readers and writers find into the write-ahead log."""
    try:
        fcntl.lockf(shared, fcntl.LOCK_EX | fcntl.LOCK_NB, WAL_LOCKS, WAL_LOCK_FIRST)
    except OSError:
        return False
    return True


def with_one_member_more(value, but=()):
    """Copies of a JSON value, each with one member more in one of its objects (one of each list), not within members
    of the names in `but`."""
    if isinstance(value, dict):
        yield {**value, "notDocumented": {"a": []}}
        for name, member in value.items():
            for changed in with_one_member_more(None if name in but else member, but):
                yield {**value, name: changed}
    elif isinstance(value, list):
        for changed in with_one_member_more(value[0] if value else None, but):
            yield [changed, *copy.deepcopy(value[1:])]


def good_values(name, schema):
    if "enum" in schema:
        return schema["enum"]
    if schema["type"] == "integer":
        return [str(schema["minimum"]), str(schema["maximum"])]
    if schema["type"] == "boolean":
        return ["true", "false"]
    if "enum" in schema.get("items", {}):
        return [*schema["items"]["enum"], ",".join(schema["items"]["enum"]), GOOD[name]]
    return [""] if name == "pageToken" else [GOOD[name]]


def wrong_values(name, schema):
    if "enum" in schema:
        return ["", "nonsense", schema["enum"][0].upper()]
    if schema["type"] == "integer":
        return ["", str(schema["minimum"] - 1), str(schema["maximum"] + 1), *WRONG["integer"]]
    if name == "pageToken":
        return ["x"]
    if schema["type"] == "array" and "enum" not in schema["items"]:
        return [""]
    return ["", "x"] if name == "id" else ["", *WRONG.get(schema.get("format", schema["type"]), [])]


if __name__ == "__main__":
    unittest.main()
