"""run.py MODULE [unittest's arguments]: its tests, and a last line "N passed, N failed"."""

import pathlib
import sys
import unittest

# The helpers that every suite shares.
sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[1] / "support"))


def main():
    program = unittest.main(module=sys.argv.pop(1), exit=False, verbosity=2, failfast=False)
    result = program.result
    # A test whose parts failed counts once.
    failed = len({getattr(test, "test_case", test).id() for test, _ in (*result.failures, *result.errors)})
    print(f"{result.testsRun - failed} passed, {failed} failed", flush=True)
    return 0 if result.testsRun > 0 and failed == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
