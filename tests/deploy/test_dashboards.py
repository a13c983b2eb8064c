"""The dashboards fit the types of npm's @grafana/schema: keys that Grafana would ignore, and values that it could
not read, are errors."""

import copy
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

# Makes tests/e2e importable.
import images  # noqa: F401
from dashboards import FILES, dashboards

# Folders with TypeScript and the types of one version of Grafana each.
TYPES = [pathlib.Path(folder) for folder in os.environ["UPLINK_GRAFANA_TYPES"].split(":")]
HEAD = "import type { Dashboard } from '@grafana/schema';\nexport const dashboard: Partial<Dashboard> ="
OPTIONS = {"strict": True, "noEmit": True, "skipLibCheck": True, "types": [], "target": "es2022",
           "module": "nodenext", "moduleResolution": "nodenext"}  # fmt: skip
SECONDS = 120


def errors(types, named):
    """What the compiler finds in each of these dashboards, as its lines."""
    with tempfile.TemporaryDirectory(prefix="uplink-types-") as folder:
        folder = pathlib.Path(folder)
        (folder / "node_modules").symlink_to(types / "node_modules")
        (folder / "tsconfig.json").write_text(json.dumps({"compilerOptions": OPTIONS}), encoding="utf-8")
        for name, dashboard in named.items():
            # A value of its own type would not be searched for unknown keys: the JSON is part of the source.
            (folder / f"{name}.ts").write_text(f"{HEAD} {json.dumps(dashboard, indent=2)};\n", encoding="utf-8")
        done = subprocess.run([types / "node_modules/.bin/tsc", "--pretty", "false", "-p", folder], cwd=folder,
                              capture_output=True, text=True, timeout=SECONDS, check=False)  # fmt: skip
    found = [line for line in done.stdout.splitlines() if not line.startswith(" ")]
    assert (done.returncode == 0) == (not found), done.stdout + done.stderr
    return found


def name_unknown_in_panel(dashboard):
    dashboard["panels"][1]["caption"] = "Online"


def name_unknown_in_field(dashboard):
    dashboard["panels"][1]["fieldConfig"]["defaults"]["units"] = "s"


def widen_by_text(dashboard):
    dashboard["panels"][1]["gridPos"]["w"] = "4"


def refresh_by_text(dashboard):
    dashboard["templating"]["list"][1]["refresh"] = "on"


class Dashboards(unittest.TestCase):
    def test_dashboards_fit_the_types(self):
        for types in TYPES:
            with self.subTest(types.name):
                self.assertEqual(errors(types, dashboards()), [])

    def test_unknown_keys_and_values_of_another_type_are_found(self):
        good = dashboards()[FILES[0].name]
        mistakes = [name_unknown_in_panel, name_unknown_in_field, widen_by_text, refresh_by_text]
        bad = {}
        for mistake in mistakes:
            bad[mistake.__name__] = copy.deepcopy(good)
            mistake(bad[mistake.__name__])
        for types in TYPES:
            with self.subTest(types.name):
                files = {line.split(".ts(", 1)[0] for line in errors(types, bad)}
                self.assertEqual(files, set(bad))


if __name__ == "__main__":
    unittest.main()
