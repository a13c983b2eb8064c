"""/api/v1 only grows: every line of tests/fixtures/api/frozen.txt still is true of fleet.proto and openapi.yaml."""

import copy
import unittest

from api_surface import frozen, of_document, surface
from fleet_contract import contract
from openapi import Document


class Frozen(unittest.TestCase):
    def test_everything_that_was_promised_is_there(self):
        self.assertGreater(len(frozen()), 1000)
        gone = sorted(set(frozen()) - set(surface(Document(), contract())))
        self.assertEqual(gone, [], "clients rely on these: keep them, and add beside them")

    def test_what_breaks_a_client_is_found_and_what_is_added_is_not(self):
        whole = set(of_document(Document()))
        for what, change, breaks in CHANGES:
            with self.subTest(what):
                document = Document()
                change(document.root)
                self.assertEqual(bool(whole - set(of_document(document))), breaks)

    def test_the_list_has_each_line_once_and_in_order(self):
        self.assertEqual(frozen(), sorted(set(frozen())))


def drop_path(root):
    del root["paths"]["/api/v1/gaps"]


def rename_member(root):
    properties = root["components"]["schemas"]["Gap"]["properties"]
    properties["first"] = properties.pop("firstSeq")


def member_that_may_be_absent(root):
    root["components"]["schemas"]["Gap"]["required"].remove("firstSeq")


def other_type(root):
    root["components"]["schemas"]["Gap"]["properties"]["firstSeq"] = {"type": "integer"}


def drop_word(root):
    root["components"]["schemas"]["Presence"]["enum"].remove("unknown")


def drop_parameter(root):
    root["paths"]["/api/v1/gaps"]["get"]["parameters"].pop(0)


def need_parameter(root):
    root["components"]["parameters"]["fleet"]["required"] = True


def smaller_page(root):
    root["components"]["parameters"]["pageSize"]["schema"]["maximum"] = 500


def drop_media_type(root):
    del root["paths"]["/api/v1/gaps"]["get"]["responses"]["200"]["content"]["application/x-ndjson"]


def add_path(root):
    root["paths"]["/api/v1/more"] = copy.deepcopy(root["paths"]["/api/v1/gaps"])


def add_member(root):
    root["components"]["schemas"]["Gap"]["properties"]["more"] = {"type": "string"}


def add_word(root):
    root["components"]["schemas"]["Degraded"]["enum"].append("more")


def add_parameter(root):
    root["components"]["parameters"]["more"] = {"name": "more", "in": "query", "schema": {"type": "string"}}
    root["paths"]["/api/v1/gaps"]["get"]["parameters"].append({"$ref": "#/components/parameters/more"})


CHANGES = [
    *((change.__name__, change, True) for change in (
        drop_path, rename_member, member_that_may_be_absent, other_type, drop_word, drop_parameter, need_parameter,
        smaller_page, drop_media_type)),
    *((change.__name__, change, False) for change in (add_path, add_member, add_word, add_parameter)),
]  # fmt: skip

if __name__ == "__main__":
    unittest.main()
