"""fleet.proto, openapi.yaml and the answers of tests/fixtures/api: what one of them says the others say too.

/api/v1 only grows. A name or a type that changes makes one of the frozen answers wrong; a member that is added
passes, since an answer need not have it.
"""

import json
import unittest

from fleet_contract import contract
from google.protobuf import descriptor_pb2, json_format, message_factory
from harness import SOURCE
from openapi import Document

ANSWERS = SOURCE / "tests/fixtures/api"
# By operation its RPC.
RPCS = {
    "status": "GetStatus", "robots": "ListRobots", "robot": "GetRobot", "robot_by_ruri": "GetRobot",
    "robot_story": "GetRobotStory", "connections": "ListConnections", "fleets": "ListFleets", "top": "ListTop",
    "events": "ListEvents", "messages": "ListMessages", "presence": "ListPresenceChanges",
    "quarantine": "ListQuarantine", "gaps": "ListGaps", "scope_updates": "ListScopeUpdates", "faults": "ListFaults",
    "missions": "ListMissions", "mission_reports": "ListMissionReports", "operator_requests": "ListOperatorRequests",
    "shapes": "ListShapes", "objects": "ListObjects", "config": "GetConfig",
}  # fmt: skip
# The same of FleetAdmin: lists, and what is posted.
ADMIN_LISTS = {"audit": "ListAudit", "revocations": "ListRevocations"}
COMMANDS = {
    "robot_block": "BlockRobot", "robot_unblock": "UnblockRobot", "robot_disconnect": "DisconnectRobot",
    "robot_note": "NoteRobot", "robot_add": "AddRobot", "fault_acknowledge": "AcknowledgeFault",
    "certificate_revoke": "RevokeCertificate", "certificate_unrevoke": "UnrevokeCertificate", "reload": "Reload",
}  # fmt: skip
ALL = {**RPCS, **ADMIN_LISTS, **COMMANDS}
# Texts that are no messages.
FILES = {"openapi"}
# Nothing answers by HTTP what is a stream.
STREAMS = {"WatchRobots"}
TIMESTAMP = "google.protobuf.Timestamp"
# JSON of any form.
ANY = ("google.protobuf.Struct", "google.protobuf.Value")
KINDS = {
    descriptor_pb2.FieldDescriptorProto.TYPE_INT64: "string", descriptor_pb2.FieldDescriptorProto.TYPE_UINT64: "string",
    descriptor_pb2.FieldDescriptorProto.TYPE_STRING: "string", descriptor_pb2.FieldDescriptorProto.TYPE_BYTES: "string",
    descriptor_pb2.FieldDescriptorProto.TYPE_INT32: "integer", descriptor_pb2.FieldDescriptorProto.TYPE_UINT32: "integer",
    descriptor_pb2.FieldDescriptorProto.TYPE_DOUBLE: "number", descriptor_pb2.FieldDescriptorProto.TYPE_BOOL: "boolean",
}  # fmt: skip


def message_of(descriptor):
    if hasattr(message_factory, "GetMessageClass"):
        return message_factory.GetMessageClass(descriptor)()
    return message_factory.MessageFactory(descriptor.file.pool).GetPrototype(descriptor)()


def is_map(field):
    return field.message_type is not None and field.message_type.GetOptions().map_entry


def missing(expected, found, where=""):
    """What of a JSON value another one lacks or has differently, a text each."""
    if isinstance(expected, dict) and isinstance(found, dict):
        return [text for name in expected for text in missing(expected[name], found.get(name), f"{where}/{name}")]
    if isinstance(expected, list) and isinstance(found, list) and len(expected) == len(found):
        return [text for pair in zip(expected, found) for text in missing(*pair, f"{where}[]")]
    # A number within a Struct is a double.
    alike = type(expected) is type(found) or {type(expected), type(found)} == {int, float}
    return [] if expected == found and alike else [f"{where}: {found!r}, not {expected!r}"]


class Both(unittest.TestCase):
    """The contract and the document."""

    @classmethod
    def setUpClass(cls):
        cls.service = contract()
        cls.admin = contract("FleetAdmin")
        cls.methods = {**cls.service.methods_by_name, **cls.admin.methods_by_name}
        cls.document = Document()
        cls.commands = {each["operationId"]: each for each in cls.document.commands().values()}
        cls.operations = {
            operation["operationId"]: operation
            for path, operation in cls.document.operations().items()
            if path.startswith("/api/v1/") and operation["operationId"] not in FILES
        }

    def schema_of(self, operation):
        return self.document.response(operation, 200)["content"]["application/json"]["schema"]


class Contract(Both):
    """fleet.proto and openapi.yaml."""

    def test_every_operation_is_an_rpc_and_the_other_way_round(self):
        self.assertEqual(set(self.operations), set(RPCS) | set(ADMIN_LISTS))
        self.assertEqual(set(self.commands), set(COMMANDS))
        self.assertEqual(set(self.service.methods_by_name), set(RPCS.values()) | STREAMS)
        self.assertEqual(set(self.admin.methods_by_name), {*ADMIN_LISTS.values(), *COMMANDS.values()})

    def test_every_member_of_a_command_is_a_field_and_the_other_way_round(self):
        self.seen = set()
        for name, operation in self.commands.items():
            with self.subTest(name):
                request = self.methods[COMMANDS[name]].input_type
                body = operation["requestBody"]["content"]["application/json"]["schema"]
                self.assertEqual(body["$ref"].rpartition("/")[2], request.name)
                self.assert_message(body, request)
                fields = {field.json_name: field for field in request.fields}
                for parameter, schema in self.document.parameters(operation, "query").items():
                    self.assert_parameter(schema, fields[parameter])

    def test_every_parameter_is_a_field_of_the_request_and_the_other_way_round(self):
        for name, operation in self.operations.items():
            with self.subTest(name):
                request = self.methods[ALL[name]].input_type
                parameters = {
                    **self.document.parameters(operation, "query"), **self.document.parameters(operation, "path"),
                }  # fmt: skip
                fields = {field.json_name: field for field in request.fields}
                self.assertEqual(set(parameters), set(fields))
                for parameter, schema in parameters.items():
                    self.assert_parameter(schema, fields[parameter])

    def assert_parameter(self, schema, field):
        where = field.full_name
        if field.label == field.LABEL_REPEATED:
            self.assertEqual(schema["type"], "array", where)
        elif field.message_type is not None:
            self.assertEqual(field.message_type.full_name, TIMESTAMP, where)
            self.assertEqual((schema["type"], schema["format"]), ("string", "date-time"), where)
        else:
            self.assertEqual(schema["type"], KINDS[field.type], where)

    def test_every_member_of_an_answer_is_a_field_and_the_other_way_round(self):
        self.seen = set()
        for name, operation in {**self.operations, **self.commands}.items():
            with self.subTest(name):
                answer = self.methods[ALL[name]].output_type
                self.assertEqual(self.schema_of(operation)["$ref"].rpartition("/")[2], answer.name)
                self.assert_message(self.schema_of(operation), answer)

    def assert_message(self, schema, descriptor):
        if descriptor.full_name in self.seen:
            return
        self.seen.add(descriptor.full_name)
        fields = {field.json_name: field for field in descriptor.fields}
        whole = self.document.look_up(schema)
        # An event has a schema for each of its kinds.
        for each in whole.get("oneOf", whole.get("anyOf", [whole])):
            properties = self.document.look_up(each).get("properties", {})
            self.assertEqual(set(properties), set(fields), descriptor.full_name)
            for name, field in fields.items():
                self.assert_member(self.document.look_up(properties[name]), field)

    def assert_member(self, schema, field):
        where = field.full_name
        if is_map(field):
            value = field.message_type.fields_by_name["value"]
            self.assertEqual(schema["type"], "object", where)
            inner = [*schema.get("properties", {}).values()] or [schema["additionalProperties"]]
            for each in inner:
                self.assert_one(self.document.look_up(each), value)
        elif field.label == field.LABEL_REPEATED:
            self.assertEqual(schema["type"], "array", where)
            self.assert_one(self.document.look_up(schema["items"]), field)
        else:
            self.assert_one(schema, field)

    def assert_one(self, schema, field):
        where = field.full_name
        if field.message_type is None:
            kinds = {self.document.look_up(each).get("type") for each in schema.get("anyOf", [schema])}
            self.assertEqual(kinds, {KINDS[field.type]}, where)
        elif field.message_type.full_name == TIMESTAMP:
            self.assertEqual(schema, self.document.root["components"]["schemas"]["Time"], where)
        elif field.message_type.full_name not in ANY:
            self.assert_message(schema, field.message_type)

    def test_no_name_says_milliseconds_of_a_point_in_time(self):
        def fields(descriptor, seen):
            if descriptor.full_name in seen or descriptor.full_name.startswith("google."):
                return
            seen.add(descriptor.full_name)
            for field in descriptor.fields:
                yield field
                if field.message_type is not None:
                    yield from fields(field.message_type, seen)

        for method in (*self.service.methods, *self.admin.methods):
            for field in [*fields(method.input_type, set()), *fields(method.output_type, set())]:
                self.assertFalse(field.name.endswith(("_at_ms", "_since_ms", "_unix_ms")), field.full_name)
                self.assertIsNone(field.enum_type, field.full_name)


class FrozenAnswers(Both):
    """tests/fixtures/api: an answer per operation, with every member that there was when it was frozen."""

    def answers(self):
        for name in {**self.operations, **self.commands}:
            yield name, json.loads((ANSWERS / f"{name}.json").read_text(encoding="utf-8"))

    def test_each_operation_has_one(self):
        self.assertEqual({path.stem for path in ANSWERS.glob("*.json")}, {*self.operations, *self.commands})

    def test_each_is_as_the_document_says(self):
        for name, answer in self.answers():
            with self.subTest(name):
                operation = {**self.operations, **self.commands}[name]
                self.assertEqual(self.document.problems(self.schema_of(operation), answer), [])

    def test_each_is_as_the_contract_says(self):
        for name, answer in self.answers():
            with self.subTest(name):
                message = message_of(self.methods[ALL[name]].output_type)
                json_format.ParseDict(answer, message)
                again = json_format.MessageToDict(message, including_default_value_fields=True)
                self.assertEqual(missing(answer, again), [])

    def test_a_changed_name_or_type_is_found_and_a_new_member_is_not(self):
        schema = self.schema_of(self.operations["gaps"])
        answer = json.loads((ANSWERS / "gaps.json").read_text(encoding="utf-8"))
        message = message_of(self.service.methods_by_name["ListGaps"].output_type)
        row = answer["gaps"][0]
        for changed in ({**row, "sessionID": "a"}, {**row, "seenAt": 5}):
            wrong = {**answer, "gaps": [changed]}
            self.assertNotEqual(self.document.problems(schema, wrong), [])
            with self.assertRaises(json_format.ParseError):
                json_format.ParseDict(wrong, message)
        self.assertEqual(missing(row, {**row, "new": 1}), [])
        self.assertNotEqual(missing(row, {**row, "firstSeq": 5}), [])


if __name__ == "__main__":
    unittest.main()
