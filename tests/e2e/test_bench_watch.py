"""The benchmark of watches: it shows what they cost, with watchers beside without."""

import json
import unittest

from harness import SOURCE, EndToEnd, run

RUN_SECONDS = 200


class BenchWatch(EndToEnd):
    def test_both_figures_are_there(self):
        path = self.folder / "watch.json"
        flags = ["--robots", 20, "--watchers", 4, "--each", 5, "--seconds", 3, "--rounds", 1, "--json", path]
        done = run("python3", SOURCE / "tests/bench/watch/watch.py", *flags, timeout=RUN_SECONDS)
        rows = {row["scenario"]: row for row in json.loads(path.read_text())["rows"]}
        self.assertEqual(set(rows), {"ingestion_cpu_while_watched", "ack_p99_while_watched"})
        for row in rows.values():
            self.assertGreater(row["ratio"], 0, row)
        self.assertIn("0 changes shown", done.stdout.splitlines()[0])
        self.assertNotIn(" 0 changes shown", done.stdout.splitlines()[1])


if __name__ == "__main__":
    unittest.main()
