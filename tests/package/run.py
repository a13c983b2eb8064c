#!/usr/bin/env python3
"""Runs the tests of the packages, the files side by side, and ends with the line "N passed, N failed"."""

import concurrent.futures
import io
import os
import sys
import unittest

from base import Base

MODULES = ("test_host", "test_package", "test_postrm")


def run(name):
    """The result of one file, and what unittest said."""
    text = io.StringIO()
    suite = unittest.defaultTestLoader.loadTestsFromName(name)
    return unittest.TextTestRunner(stream=text, verbosity=2).run(suite), text.getvalue()


def main():
    # Two begin from the same base.
    Base(os.environ["UPLINK_PACKAGE_CACHE"]).make_if_missing()
    total = failed = 0
    with concurrent.futures.ThreadPoolExecutor(len(MODULES)) as pool:
        for result, text in pool.map(run, MODULES):
            print(text)
            total += result.testsRun
            failed += len(result.failures) + len(result.errors)
    print(f"{total - failed} passed, {failed} failed")
    return 0 if total and not failed else 1


if __name__ == "__main__":
    sys.exit(main())
