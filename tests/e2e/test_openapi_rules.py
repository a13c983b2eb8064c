"""The rules for OpenAPI documents find what is wrong with one."""

import copy
import tempfile
import unittest
from pathlib import Path

from openapi import Document, read_document
from openapi_rules import flaws

RURI = {"name": "ruri", "in": "path", "required": True, "schema": {"type": "string"}}
FLEET = {"name": "fleet", "in": "query", "schema": {"type": "string"}}
GOOD = {
    "openapi": "3.1.0",
    "info": {"title": "t", "version": "1"},
    "paths": {
        "/robots": {
            "get": {
                "operationId": "robots",
                "parameters": [{"$ref": "#/components/parameters/fleet"}],
                "responses": {"200": {"description": "All."}, "4XX": {"$ref": "#/components/responses/Error"}},
            }
        },
        "/robots/{ruri}": {
            "get": {"operationId": "robot", "parameters": [RURI], "responses": {"default": {"description": "One."}}}
        },
    },
    "components": {
        "parameters": {"fleet": FLEET},
        "responses": {"Error": {"description": "It failed."}},
        "schemas": {"A/B": {"$ref": "#/components/schemas/A~1B"}},
    },
}


class Rules(unittest.TestCase):
    def setUp(self):
        self.root = copy.deepcopy(GOOD)
        self.paths = self.root["paths"]
        self.robots = self.paths["/robots"]["get"]
        self.robot = self.paths["/robots/{ruri}"]["get"]

    def assert_flaws(self, *expected):
        self.assertEqual(flaws(self.root), list(expected))

    def test_a_good_document_has_none(self):
        self.assert_flaws()

    def test_the_documentation_has_none(self):
        self.assertEqual(flaws(Document().root), [])

    def test_a_parameter_of_the_path_that_is_not_declared(self):
        self.robot["parameters"] = []
        self.assert_flaws("get /robots/{ruri}: {ruri} is not declared")

    def test_a_parameter_of_the_path_that_is_declared_elsewhere(self):
        self.robot["parameters"] = [{**RURI, "in": "query"}]
        self.assert_flaws("get /robots/{ruri}: {ruri} is not declared")

    def test_a_parameter_that_the_path_declares_for_all_its_operations_is_good(self):
        self.paths["/robots/{ruri}"]["parameters"] = [self.robot["parameters"].pop()]
        self.assert_flaws()

    def test_a_parameter_that_the_path_does_not_have(self):
        self.robots["parameters"] = [RURI]
        self.assert_flaws("get /robots: parameter ruri is not in the path")

    def test_a_parameter_of_the_path_that_is_not_required(self):
        for required in ({}, {"required": False}):
            with self.subTest(required):
                self.robot["parameters"] = [{"name": "ruri", "in": "path", "schema": {}, **required}]
                self.assert_flaws("get /robots/{ruri}: parameter ruri is not required")

    def test_a_parameter_twice(self):
        self.robots["parameters"].append(FLEET)
        self.assert_flaws("get /robots: more than one parameter fleet in query")

    def test_a_parameter_without_a_schema(self):
        del self.robot["parameters"][0]["schema"]
        self.assert_flaws("get /robots/{ruri}: parameter ruri has no schema")

    def test_a_name_twice_in_a_path(self):
        self.paths["/robots/{ruri}/{ruri}"] = self.paths.pop("/robots/{ruri}")
        self.assert_flaws("get /robots/{ruri}/{ruri}: {ruri} more than once")

    def test_a_path_without_a_slash(self):
        self.paths["robots"] = self.paths.pop("/robots")
        self.assert_flaws("get robots: begins without a slash")

    def test_paths_that_only_their_parameters_tell_apart(self):
        other = copy.deepcopy(self.paths["/robots/{ruri}"])
        other["get"]["operationId"] = "other"
        other["get"]["parameters"][0]["name"] = "id"
        self.paths["/robots/{id}"] = other
        self.assert_flaws("paths: more than one path /robots/{}")

    def test_an_operation_id_twice(self):
        self.robot["operationId"] = "robots"
        self.assert_flaws("paths: more than one operationId robots")

    def test_an_operation_id_twice_on_one_path(self):
        self.paths["/robots"]["put"] = copy.deepcopy(self.robots)
        self.assert_flaws("paths: more than one operationId robots")

    def test_an_operation_without_an_id(self):
        del self.robots["operationId"]
        self.assert_flaws("get /robots: no operationId")

    def test_a_reference_that_leads_nowhere(self):
        for ref in ("#/components/parameters/none", "#/components/parameters/fleet/name/x", "other.yaml", "fleet"):
            with self.subTest(ref):
                self.robots["parameters"] = [{"$ref": ref}]
                self.assert_flaws(f"/paths//robots/get/parameters/0: {ref} leads nowhere")

    def test_a_discriminator_that_leads_nowhere(self):
        for ref, leads in (("#/components/schemas/none", False), ("#/components/schemas/A~1B", True)):
            with self.subTest(ref):
                self.root["components"]["schemas"]["C"] = {"discriminator": {"mapping": {"c": ref}}}
                where = f"/components/schemas/C/discriminator/mapping/c: {ref} leads nowhere"
                self.assert_flaws(*([] if leads else [where]))

    def test_a_response_without_a_description(self):
        for response in ({}, {"description": ""}):
            with self.subTest(response):
                self.robot["responses"] = {"200": response}
                self.assert_flaws("get /robots/{ruri}: response 200 has no description")
        self.root["components"]["responses"]["Error"] = {"content": {}}
        self.robot["responses"] = {"200": {"description": "One."}}
        self.assert_flaws("get /robots: response 4XX has no description")

    def test_an_operation_without_a_response(self):
        self.robot["responses"] = {}
        self.assert_flaws("get /robots/{ruri}: no response")
        del self.robot["responses"]
        self.assert_flaws("get /robots/{ruri}: no response")

    def test_a_response_of_no_status(self):
        # YAML reads a number where the quotes are missing.
        for status in ("600", "20", "2xx", "ok", 200):
            with self.subTest(status):
                self.robot["responses"] = {status: {"description": "One."}}
                self.assert_flaws(f"get /robots/{{ruri}}: {status!r} is no status")


class Reading(unittest.TestCase):
    def read(self, text):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "openapi.yaml"
            file.write_text(text, encoding="utf-8")
            return read_document(file)

    def test_a_name_twice_is_refused(self):
        self.assertEqual(self.read("paths:\n  /a: {get: 1}\n  /b: {get: 2}\n")["paths"]["/b"], {"get": 2})
        with self.assertRaisesRegex(ValueError, "line 3.*'/a' twice"):
            self.read("paths:\n  /a: {get: 1}\n  /a: {get: 2}\n")


if __name__ == "__main__":
    unittest.main()
