"""The benchmark of operators' questions: each is answered, on both stores."""

import json
import os
import unittest

from harness import SOURCE, EndToEnd, run

RUN_SECONDS = 300


class BenchQuestions(EndToEnd):
    def rows(self, store):
        path = self.folder / "questions.json"
        flags = ["--store", store, "--robots", 200, "--rows", 20_000, "--rate", 200, "--asks", 1, "--json", path]
        done = run("python3", SOURCE / "tests/bench/questions/questions.py", *flags, timeout=RUN_SECONDS,
                   env={**os.environ, "TMPDIR": str(self.folder)})  # fmt: skip
        self.assertIn(" 0 refused", done.stdout, done.stdout)
        return {row["target"]: row["rows"] for row in json.loads(path.read_text())["questions"]}

    def test_both_stores_answer_each_and_find_the_same(self):
        sqlite = self.rows("sqlite")
        postgres = self.rows("postgres")
        found = [target for target, rows in sqlite.items() if rows]
        self.assertGreater(len(found), len(sqlite) / 2, f"most find nothing: {sorted(set(sqlite) - set(found))}")
        # What the load adds meanwhile differs; a filter finds only what was filled in.
        filled = {target for target in sqlite if "kind=" in target or "severity=" in target or "status=" in target}
        self.assertTrue(filled)
        for target in filled:
            self.assertEqual(sqlite[target], postgres[target], target)


if __name__ == "__main__":
    unittest.main()
