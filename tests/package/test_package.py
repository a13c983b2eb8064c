"""The packages as files: the same tree gives the same bytes; Debian's own tester takes them."""

import hashlib
import os
import pathlib
import subprocess
import tempfile
import unittest

from base import MIRROR, SUITE
from machine import run

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PACKAGES = pathlib.Path(os.environ["UPLINK_PACKAGES"])
CACHE = pathlib.Path(os.environ["UPLINK_PACKAGE_CACHE"])
PACKAGE_SECONDS = 600


def digests(folder):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.glob("*.deb"))}


class Package(unittest.TestCase):
    def test_the_same_tree_gives_the_same_bytes(self):
        with tempfile.TemporaryDirectory(prefix="uplinkd-again-") as folder:
            again = pathlib.Path(folder) / "again"
            run(SOURCE / "tools/dev/package.sh", "--out", again, timeout=PACKAGE_SECONDS)
            self.assertEqual(digests(again), digests(PACKAGES))
        self.assertEqual(len(digests(PACKAGES)), 4)

    def test_piuparts_installs_and_purges_them(self):
        packages = [path for path in sorted(PACKAGES.glob("*.deb")) if "dbgsym" not in path.name]
        with tempfile.TemporaryDirectory(prefix="uplinkd-piuparts-") as folder:
            log = pathlib.Path(folder) / "log"
            done = subprocess.run(
                ["piuparts", "-b", CACHE / f"{SUITE}.tar.gz", "-m", MIRROR, "--skip-minimize", "--warn-on-others",
                 "--do-not-verify-signatures", "-d", SUITE, "-t", folder, "-l", log, *packages],
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
            )  # fmt: skip
            text = log.read_text(encoding="utf-8", errors="replace") if log.exists() else str(done.stdout)
            self.assertEqual(done.returncode, 0, text[-8000:])
