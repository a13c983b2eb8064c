"""The soak script: half a minute of it, and its arithmetic."""

import json
import os
import sys
import unittest

from harness import SOURCE, EndToEnd, run

sys.path.insert(0, str(SOURCE / "tests/load"))
from soak import slope_an_hour, table  # noqa: E402


class Slopes(unittest.TestCase):
    def test_what_is_flat_and_what_grows(self):
        flat = [(at, {"rss_kib": 100}) for at in range(0, 600, 10)]
        grows = [(at, {"rss_kib": 100 + at}) for at in range(0, 600, 10)]
        self.assertEqual(slope_an_hour(flat, "rss_kib"), 0)
        self.assertAlmostEqual(slope_an_hour(grows, "rss_kib"), 3600)
        self.assertEqual(slope_an_hour(flat[:1], "rss_kib"), 0)
        self.assertIn("+3600.0", table(grows))


class Soak(EndToEnd):
    def soak(self, store):
        file = self.folder / f"{store}.json"
        done = run(
            sys.executable, SOURCE / "tests/load/soak.py", "--minutes", 0.5, "--robots", 20, "--store", store,
            "--outage-every", 9, "--json", file, timeout=400, env=dict(os.environ),
        )  # fmt: skip
        self.assertIn("verification: all agree", done.stdout)
        result = json.loads(file.read_text(encoding="utf-8"))
        self.assertTrue(result["ok"])
        self.assertIn("2 outages", done.stdout)
        self.assertGreater(len(result["samples"]), 5)
        self.assertGreater(min(values["rss_kib"] for _, values in result["samples"]), 1000)

    def test_on_sqlite(self):
        self.soak("sqlite")

    def test_on_postgres(self):
        self.soak("postgres")


if __name__ == "__main__":
    unittest.main()
