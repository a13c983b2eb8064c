"""What a release says of itself: one version, and in its SBOM all that the packages need."""

import re
import sys
import unittest

from harness import SOURCE

sys.path.insert(0, str(SOURCE / "tools/dev"))

import sbom_root  # noqa: E402


def paragraph(name, depends=""):
    return f"Package: {name}\nVersion: 1\nDepends: {depends}\nDescription: short\n long: text"


class Release(unittest.TestCase):
    def test_the_packages_have_the_version_of_the_project(self):
        project = (SOURCE / "CMakeLists.txt").read_text(encoding="utf-8")
        version = re.search(r"project\(uplinkd VERSION ([\d.]+) ", project).group(1)
        changelog = (SOURCE / "deploy/debian/changelog").read_text(encoding="utf-8")
        self.assertRegex(changelog, rf"^uplinkd \({re.escape(version)}\) ")

    def test_all_that_a_package_needs_is_listed_once(self):
        packages = {name: paragraph(name, needs) for name, needs in {
            "liba": "libc (>= 2:1.0), libb:any", "libb": "libc", "libc": "", "other": "liba"}.items()}  # fmt: skip
        ours = [paragraph("uplinkd", "absent | liba (= 1) [amd64]"), paragraph("tools", "uplinkd")]
        self.assertEqual(set(sbom_root.closure(ours, packages)), {"uplinkd", "tools", "liba", "libb", "libc"})

    def test_a_package_that_is_not_installed_here_is_an_error(self):
        with self.assertRaisesRegex(SystemExit, "absent, missing"):
            sbom_root.closure([paragraph("uplinkd", "absent | missing (>= 2)")], {})


if __name__ == "__main__":
    unittest.main()
