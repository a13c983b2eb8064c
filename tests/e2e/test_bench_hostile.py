"""The benchmark of hostile clients: it runs, and leaves nothing behind."""

import json
import os
import unittest

from harness import BIN, EndToEnd, run
from test_bench_fair import processes_of

RUN_SECONDS = 180


class BenchHostile(EndToEnd):
    def bench(self, *flags, code=0):
        return run(
            BIN / "uplink_bench_hostile", "--seconds", 1, *flags,
            code=code, timeout=RUN_SECONDS, env={**os.environ, "TMPDIR": str(self.folder)},
        )  # fmt: skip

    def assert_nothing_left(self):
        self.assertEqual(processes_of(self.folder), [])
        self.assertEqual(list(self.folder.glob("uplinkd_*")), [])

    def test_a_short_run_has_its_figures_and_leaves_nothing(self):
        rows = self.folder / "hostile.json"
        done = self.bench("--only", "settings", "--json", rows)
        self.assertIn("goals: ", done.stdout)
        page = json.loads(rows.read_text(encoding="utf-8"))
        figures = {row["scenario"]: row["value"] for row in page["rows"]}
        self.assertGreater(figures["settings_ack_p99"], 0)
        self.assertGreater(figures["settings_acked"], 0)
        self.assertEqual(figures["settings_lost"], 0)
        self.assertEqual(figures["settings_serves_after"], 1)
        # The attack did what it is there for, and was told from everything else.
        self.assertEqual(figures["settings_in_log"], 1)
        self.assertEqual(figures["settings_in_metric"], 1)
        self.assert_nothing_left()

    def test_a_server_that_does_not_start_is_said(self):
        done = self.bench("--only", "pings", "--server-bin", "/bin/false", code=1)
        self.assertIn("no figures: /bin/false does not listen", done.stdout)
        self.assert_nothing_left()


if __name__ == "__main__":
    unittest.main()
