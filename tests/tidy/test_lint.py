"""Tests of tools/dev/lint: what a unit's key depends on, and what is remembered."""

import os
import pathlib
import sys
import tempfile
import time
import unittest
from unittest import mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools/dev/lint"))

import clang_tidy  # noqa: E402
import foreign  # noqa: E402
import passed  # noqa: E402
import units  # noqa: E402

FILES = {
    "server/a.cc": '#include "server/a.h"\n#include "uplink/v1/relay.pb.h"\n#include <vector>\n',
    "server/a.h": '#include "schema/b.h"\n',
    "schema/b.h": "int b;\n",
    "schema/c.h": "int c;\n",
    "build/lint/proto/uplink/v1/relay.pb.h": "#include <google/arena.h>\n",
}


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = pathlib.Path(self.folder.name)


class Units(Folder):
    def write(self, root, **changed):
        for path, text in {**FILES, **changed}.items():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text, encoding="utf-8")
        return str(root)

    def unit(self, root, more=""):
        command = f"clang++-14 -I{root} -isystem {root}/build/lint/proto {more} -o a.o -c {root}/server/a.cc"
        tree = units.Tree(root)
        return tree, units.Unit(tree, "server/a.cc", command)

    def key(self, root, more="", context=b""):
        tree, unit = self.unit(root, more)
        return unit.key(tree, context)

    def test_ReadsWhatItReachesAndTheHeadersMadeInTheBuild(self):
        _, unit = self.unit(self.write(self.root))
        self.assertEqual(
            unit.files,
            ["build/lint/proto/uplink/v1/relay.pb.h", "schema/b.h", "server/a.cc", "server/a.h"],
        )
        self.assertEqual(unit.foreign, {"vector", "uplink/v1/relay.pb.h"})

    def test_KeyIsTheSameWhereverTheTreeLies(self):
        here, there = self.write(self.root / "x"), self.write(self.root / "elsewhere/y")
        self.assertEqual(self.key(here, f'-DP="{here}/bin/p"'), self.key(there, f'-DP="{there}/bin/p"'))

    def test_KeyChangesWithWhatIsReadAndNothingElse(self):
        before = self.key(self.write(self.root))
        self.assertEqual(self.key(self.write(self.root, **{"schema/c.h": "int d;\n"})), before)
        self.assertNotEqual(self.key(self.write(self.root, **{"schema/b.h": "int d;\n"})), before)
        made = {"build/lint/proto/uplink/v1/relay.pb.h": "int d;\n"}
        self.assertNotEqual(self.key(self.write(self.root, **made)), before)

    def test_KeyChangesWithFlagsAndContext(self):
        root = self.write(self.root)
        self.assertNotEqual(self.key(root, "-Wshadow"), self.key(root))
        self.assertNotEqual(self.key(root, "-DFMT_SHARED"), self.key(root))
        self.assertNotEqual(self.key(root, context=b"other"), self.key(root))

    def test_DefineOfOursCountsOnlyWhereItIsMentioned(self):
        root = self.write(self.root)
        self.assertEqual(self.key(root, "-DUPLINK_X"), self.key(root))
        self.write(self.root, **{"schema/b.h": "#ifdef UPLINK_X\n#endif\n"})
        self.assertNotEqual(self.key(root, "-DUPLINK_X"), self.key(root))

    def test_UnitWithTheSameFlagsIsReadOnce(self):
        root = self.write(self.root)
        entries = [
            {"directory": f"{root}/build/lint", "file": f"{root}/{file}", "command": f"c++ -I{root} {more} -o {o} -c x"}
            for file, more, o in [
                ("server/a.cc", "", "a.o"),
                ("server/a.cc", "-DUPLINK_X", "b.o"),
                ("server/a.cc", "-DFMT_SHARED", "c.o"),
                ("build/lint/made.cc", "", "d.o"),
            ]
        ]
        database = self.root / "compile_commands.json"
        database.write_text(units.json.dumps(entries), encoding="utf-8")
        found = units.read_units(units.Tree(root), database)
        self.assertEqual([each.defines for each in found], [[], ["FMT_SHARED"]])

    def test_PrecompiledHeaderLeavesOurDefinesToTheUnits(self):
        root = self.write(self.root, **{"schema/b.h": "#ifdef UPLINK_X\n#endif\n"})
        found = [self.unit(root, "-DUPLINK_X -DFMT_SHARED")[1], self.unit(root, "-DBOOST")[1]]
        apart = self.unit(root, "-fno-rtti")[1]
        precompiled = foreign.Precompiled([*found, found[0], found[0], apart])
        self.assertEqual(precompiled.defines, ["FMT_SHARED", "BOOST"])
        self.assertEqual(precompiled.headers, ["<uplink/v1/relay.pb.h>", "<vector>"])
        self.assertFalse(precompiled.suits(apart))
        precompiled.path = "/p.pch"
        self.assertIn("-DUPLINK_X", precompiled.flags(found[0]))
        self.assertNotIn("-DUPLINK_X", precompiled.flags(found[1]))
        self.assertNotIn("/p.pch", precompiled.flags(apart))


class Passed(Folder):
    def test_HoldsWhatWasRemembered(self):
        memory = passed.Passed(self.root / "new/folder")
        self.assertFalse(memory.holds("k"))
        memory.remember("k")
        self.assertTrue(memory.holds("k"))

    def test_ForgetsWhatWasNotUsedForLong(self):
        memory = passed.Passed(self.root)
        memory.remember("old")
        memory.remember("used")
        long_ago = time.time() - (passed.KEEP_DAYS + 1) * 86400
        for key in ("old", "used"):
            os.utime(self.root / key, (long_ago, long_ago))
        self.assertTrue(memory.holds("used"))
        memory.prune()
        self.assertEqual(os.listdir(self.root), ["used"])

    def test_KeepsNoMoreThanItsCount(self):
        memory = passed.Passed(self.root)
        for number in range(4):
            memory.remember(str(number))
            os.utime(self.root / str(number), (time.time() - number, time.time() - number))
        with mock.patch.object(passed, "KEEP_COUNT", 3):
            memory.prune()
        self.assertEqual(sorted(os.listdir(self.root)), ["0", "1", "2"])

    def test_RemembersNothingWhereItCannotWrite(self):
        (self.root / "file").write_text("", encoding="utf-8")
        memory = passed.Passed(self.root / "file/below")
        memory.remember("k")
        memory.prune()
        self.assertFalse(memory.holds("k"))


class Planted(Folder):
    def setUp(self):
        super().setUp()
        folder = self.root / clang_tidy.PLANTED
        folder.mkdir(parents=True)
        (folder / "f.cc").write_text("int A;  // finds: naming, other\n", encoding="utf-8")

    def finding(self, line, check):
        path = self.root / clang_tidy.PLANTED / "f.cc"
        return f"{path}:{line}:5: error: a text [{check},-warnings-as-errors]\n"

    def test_PassesWhenExactlyThePlantedIsFound(self):
        output = self.finding(1, "naming") + self.finding(1, "other")
        self.assertEqual(clang_tidy.judge_planted(self.root, output), "")

    def test_FailsWhenAPlantedFaultIsNotFound(self):
        self.assertIn("not found: ", clang_tidy.judge_planted(self.root, self.finding(1, "naming")))
        self.assertIn("not found: ", clang_tidy.judge_planted(self.root, ""))

    def test_FailsWhenSomethingElseIsFound(self):
        output = self.finding(1, "naming") + self.finding(1, "other") + self.finding(2, "naming")
        self.assertIn("not planted: ", clang_tidy.judge_planted(self.root, output))


if __name__ == "__main__":
    unittest.main()
