"""The benchmark of operators' questions: each is answered, on both stores."""

import json
import unittest

from harness import SOURCE, EndToEnd, run

RUN_SECONDS = 300


class BenchQuestions(EndToEnd):
    def rows(self, store):
        path = self.folder / "questions.json"
        flags = ["--store", store, "--robots", 200, "--rows", 20_000, "--rate", 200, "--asks", 1, "--json", path]
        done = run("python3", SOURCE / "tests/bench/questions/questions.py", *flags, timeout=RUN_SECONDS)
        self.assertIn(" 0 refused", done.stdout, done.stdout)
        return {row["target"]: row["rows"] for row in json.loads(path.read_text())["questions"]}

    def test_both_stores_answer_each_and_find_the_same(self):
        sqlite = self.rows("sqlite")
        postgres = self.rows("postgres")
        found = [target for target, rows in sqlite.items() if rows]
        self.assertGreater(len(found), len(sqlite) / 2, f"most find nothing: {sorted(set(sqlite) - set(found))}")
        # What the load adds meanwhile differs, but not of the fleets that were filled in; nor is a time the same twice.
        filled = {target for target in sqlite if "fleet=" in target and target in postgres}
        self.assertGreater(len(filled), len(sqlite) / 3)
        for target in filled:
            self.assertEqual(sqlite[target], postgres[target], target)


if __name__ == "__main__":
    unittest.main()
