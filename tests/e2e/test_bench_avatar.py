"""The benchmark of drones' calls: it runs, every call is OK, and it leaves nothing behind."""

import json
import os
import unittest

from harness import BIN, EndToEnd, run
from test_bench_fair import processes_of

RUN_SECONDS = 120


class BenchAvatar(EndToEnd):
    def test_a_short_run_has_its_figures_and_leaves_nothing(self):
        rows = self.folder / "avatar.json"
        done = run(
            BIN / "uplink_bench_avatar", "--drones", 20, "--seconds", 1, "--rounds", 1,
            "--only", "live", "--only", "all", "--only", "gateway", "--only", "memory", "--json", rows,
            timeout=RUN_SECONDS, env={**os.environ, "TMPDIR": str(self.folder)},
        )  # fmt: skip
        page = json.loads(rows.read_text(encoding="utf-8"))
        figures = {row["scenario"]: row for row in page["rows"]}
        for scenario in ("live", "all", "gateway"):
            # The sink is measured like the server.
            for side in ("value", "comparator_value"):
                self.assertGreater(figures[f"{scenario}_p99"][side], 0)
                self.assertGreater(figures[f"{scenario}_answered"][side], 0)
                self.assertEqual(figures[f"{scenario}_not_ok"][side], 0, done.stderr)
        for scenario in ("all", "gateway"):
            self.assertGreater(figures[f"{scenario}_durable_p99"]["value"], 0)
        self.assertIn("memory", figures)
        # Each sample was applied or stored.
        self.assertNotIn("neither applied nor stored", done.stderr)
        self.assertEqual(processes_of(self.folder), [])
        self.assertEqual(list(self.folder.glob("uplinkd_*")), [])


if __name__ == "__main__":
    unittest.main()
