"""The rules of deployed.py on the files of this tree, with one thing changed."""

import pathlib
import unittest

import deployed
from test_tidy import RuleTest as Rules

ROOT = pathlib.Path(__file__).resolve().parents[2]
FILES = {"CMakeLists.txt", deployed.SCHEMA, deployed.VALUES, deployed.README, deployed.EXAMPLE}
FILES |= {path for path, _ in (*deployed.VERSIONS, *deployed.PORTS)}


class DeployedTest(Rules):
    def changed(self, path="", old="", new=""):
        files = {name: (ROOT / name).read_text(encoding="utf-8") for name in FILES}
        if path:
            self.assertIn(old, files[path])
            files[path] = files[path].replace(old, new)
        return files

    def assert_found(self, rule, path, old, new, at=None):
        found = self.find(rule, self.changed(path, old, new))
        self.assertEqual([where for where, _, _ in found], [at or path])

    def test_takes_this_tree(self):
        for rule in (deployed.versions, deployed.ports, deployed.sections, deployed.readme):
            self.assert_clean(rule, self.changed())

    def test_refuses_another_version(self):
        self.assert_found(deployed.versions, deployed.YAML, "appVersion: \"", "appVersion: \"9")
        self.assert_found(deployed.versions, deployed.COMPOSE, "image: uplinkd:", "image: uplinkd:9")
        self.assert_found(deployed.versions, "CMakeLists.txt", "project(uplinkd", "project(other")

    def test_refuses_another_port(self):
        for path, _ in deployed.PORTS[1:]:
            self.assert_found(deployed.ports, path, "7481", "7482")
            self.assert_found(deployed.ports, path, "7481", "")
        self.assert_found(deployed.ports, deployed.HELPERS, "[::]:7481", "")

    def test_refuses_a_section_that_only_one_has(self):
        self.assert_found(deployed.sections, deployed.EXAMPLE, "[drain]", "[stop]\n[drain]", deployed.SCHEMA)
        self.assert_found(deployed.sections, deployed.EXAMPLE, "[drain]", "", deployed.SCHEMA)

    def test_refuses_a_page_that_values_have_left(self):
        self.assert_found(deployed.readme, deployed.README, "| `image.", "| `picture.")
        self.assert_found(deployed.readme, deployed.VALUES, "\nimage:\n", "\nwithout: comment\nimage:\n")


if __name__ == "__main__":
    unittest.main()
