"""The cache of roots and packages, which several runs share."""

import pathlib
import tempfile
import threading
import unittest
from unittest import mock

import base

WAIT_SECONDS = 30
RUNS = 8


class Cache(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.cache = pathlib.Path(folder.name) / "deep/cache"
        self.made = []
        patch = mock.patch.object(base, "run", self.run_program)
        patch.start()
        self.addCleanup(patch.stop)

    def run_program(self, program, *arguments, **_):
        """mmdebstrap and gzip without a network."""
        if program == "mmdebstrap":
            self.made.append(arguments)
            arguments[-2].write_text("root", encoding="utf-8")
        else:
            part = arguments[-1]
            part.rename(part.with_suffix(".tar.gz"))

    def test_runs_at_the_same_time_make_it_once(self):
        begin = threading.Barrier(RUNS)
        failed = []

        def make():
            try:
                begin.wait(WAIT_SECONDS)
                base.Base(self.cache).make_if_missing()
            except Exception as error:  # a thread's own would only be printed
                failed.append(error)

        threads = [threading.Thread(target=make) for _ in range(RUNS)]
        for each in threads:
            each.start()
        for each in threads:
            each.join(WAIT_SECONDS)
        self.assertEqual(failed, [])
        self.assertEqual(len(self.made), 1)
        self.assertTrue(base.Base(self.cache).tar.exists())

    def test_what_an_interrupted_run_left_goes(self):
        (self.cache / "archives").mkdir(parents=True)
        (self.cache / "part.tar").write_text("half", encoding="utf-8")
        base.Base(self.cache).make_if_missing()
        self.assertEqual([each.name for each in self.cache.iterdir() if each.is_file()], ["bookworm.tar.gz"])

    def test_a_root_that_lacks_packages_is_tried_with_a_new_base_once(self):
        made = base.Base(self.cache)
        made.make_if_missing()
        with mock.patch.object(base.Base, "_fill", side_effect=["gone", ""]):
            made.root(self.cache.parent / "root", [])
        self.assertEqual(len(self.made), 2)


if __name__ == "__main__":
    unittest.main()
