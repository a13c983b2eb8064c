"""What purging removes, by the script alone: in a mount namespace whose /etc and /var/lib are empty."""

import pathlib
import tempfile
import unittest

from machine import run

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "deploy/debian/uplinkd.postrm"
ALONE = """
set -eu
mount -t tmpfs none /etc
mount -t tmpfs none /var/lib
mkdir -p /etc/uplinkd/keys /var/lib/uplinkd
{prepared}
sh {script} purge
find /etc /var/lib -mindepth 1 -printf 'there: %p\\n'
"""


class Postrm(unittest.TestCase):
    def purge(self, prepared, script=SCRIPT):
        """What it says; then each file that is left, as `there: PATH`."""
        text = ALONE.format(prepared=prepared, script=script)
        return run("unshare", "--mount", "sh", "-c", text).stdout.splitlines()

    def test_the_store_goes_with_its_folder(self):
        self.assertEqual(self.purge("touch /var/lib/uplinkd/uplinkd.db /var/lib/uplinkd/.hidden"), [])

    def test_a_store_on_a_mount_of_its_own_goes_and_the_mount_stays(self):
        with tempfile.TemporaryDirectory(prefix="uplinkd-postrm-") as folder:
            script = pathlib.Path(folder) / "postrm"
            text = SCRIPT.read_text(encoding="utf-8")
            self.assertIn("#DEBHELPER#", text)
            script.write_text(text.replace("#DEBHELPER#", "echo the rest is done"), encoding="utf-8")
            said = self.purge(
                "mount -t tmpfs none /var/lib/uplinkd\nmkdir /var/lib/uplinkd/a\ntouch /var/lib/uplinkd/a/b", script
            )
        self.assertEqual(
            said, ["uplinkd: left in place: /var/lib/uplinkd", "the rest is done", "there: /var/lib/uplinkd"]
        )

    def test_a_store_behind_a_link_is_left_and_named(self):
        said = self.purge("rmdir /var/lib/uplinkd\nmkdir /var/lib/disk\nln -s disk /var/lib/uplinkd\ntouch /var/lib/disk/db")
        self.assertIn("uplinkd: left in place: /var/lib/uplinkd", said)
        self.assertIn("there: /var/lib/disk/db", said)

    def test_keys_that_stay_are_named_links_too(self):
        said = self.purge("touch /etc/uplinkd/keys/ca.crt\nln -s /run/key /etc/uplinkd/keys/server.key")
        for name in ("ca.crt", "server.key"):
            self.assertIn(f"uplinkd: left in place: /etc/uplinkd/keys/{name}", said)
            self.assertIn(f"there: /etc/uplinkd/keys/{name}", said)

    def test_a_machine_that_has_nothing_of_it_is_fine(self):
        self.assertEqual(self.purge("rm -r /etc/uplinkd /var/lib/uplinkd"), [])


if __name__ == "__main__":
    unittest.main()
