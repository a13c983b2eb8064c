"""The files of an SQLite store are removed, replaced, moved or overwritten under the server."""

import contextlib
import os
import pathlib
import shutil
import signal
import subprocess
import unittest

from chaos import Campaign
from harness import EndToEnd, wait_until

ROUND_SECONDS = 60
MESSAGES = 200
# Records of commits that succeeded.
TOLD = "uplinkd_store_commit_records_sum"


class StoreFiles(EndToEnd):
    def setUp(self):
        super().setUp()
        self.campaign = Campaign(self.folder, "sqlite", 1)
        self.open_things.append(self.campaign)
        # How long a stop may wait for a store that fails.
        self.campaign.server.settings = '[drain]\ntimeout = "3s"\n'
        self.campaign.start()
        self.campaign.wait_for_more(MESSAGES)
        self.server, self.path = self.campaign.server, self.campaign.store.path

    def names(self):
        return [pathlib.Path(f"{self.path}{end}") for end in ("", "-wal", "-shm")]

    def wait_until_it_fails(self, name, why="no longer leads to"):
        """No commit's outcomes are told from now on. Robots may read acks of those before."""
        self.server.wait_for_status(lambda status: "store" in status["degraded"], ROUND_SECONDS, "no name")
        told = self.server.metric(TOLD)
        self.server.wait_for_status(
            lambda status: int(status["journalOldestMs"]) > 2000, ROUND_SECONDS, "durable messages wait"
        )
        self.assertEqual(self.server.metric(TOLD), told)
        self.assertRegex(self.server.text(), f"store_fails .*{name}.* {why}")

    def open_files(self):
        """Of the files of the store, what the server has open; by their names."""
        descriptors = pathlib.Path(f"/proc/{self.server.process.pid}/fd")
        found = {}
        for descriptor in descriptors.iterdir():
            # Others may be closed meanwhile.
            with contextlib.suppress(FileNotFoundError):
                found.setdefault(os.readlink(descriptor).removesuffix(" (deleted)"), descriptor)
        return {name: found[str(name)] for name in self.names()}

    def kill_and_compare(self):
        self.campaign.kill_server()
        self.campaign.wait_for_more(MESSAGES)
        self.campaign.compare()
        self.assertTrue(self.campaign.clean(), "\n".join([self.campaign.line(), *self.campaign.wrong]))

    def test_removed_files_come_back_out_of_the_running_server(self):
        for name in self.names():
            name.unlink()
        self.wait_until_it_fails(self.path)
        # As docs/operate/sqlite.md has it.
        saved = self.folder / "saved"
        saved.mkdir()
        for name, descriptor in self.open_files().items():
            if not str(name).endswith("-shm"):
                shutil.copyfile(descriptor, saved / name.name)
        self.server.terminate(ROUND_SECONDS)
        for file in saved.iterdir():
            shutil.move(file, self.path.parent)
        self.campaign.start_server(self.server)
        self.kill_and_compare()

    def test_a_removed_wal_comes_back_by_an_orderly_stop(self):
        self.names()[1].unlink()
        self.wait_until_it_fails(f"{self.path}-wal")
        self.server.terminate(ROUND_SECONDS)
        self.campaign.start_server(self.server)
        self.kill_and_compare()

    def test_a_file_that_is_put_in_its_place_gets_nothing_that_is_acked(self):
        copy = self.folder / "copy.db"
        subprocess.run(["sqlite3", str(self.path), f"VACUUM INTO '{copy}'"], check=True)
        aside = self.folder / "aside.db"
        os.link(self.path, aside)
        copy.rename(self.path)
        self.wait_until_it_fails(self.path)
        aside.rename(self.path)
        wait_until(
            self.server.process, lambda: "store_works_again" in self.server.text(), ROUND_SECONDS, "its name is back"
        )
        self.kill_and_compare()

    def test_a_copy_over_the_file_gets_nothing_that_is_acked(self):
        copy = self.folder / "copy.db"
        subprocess.run(["sqlite3", str(self.path), f".backup '{copy}'"], check=True)
        # What the copy lacks is in the file itself, and no longer in the WAL.
        self.campaign.wait_for_more(MESSAGES)
        subprocess.run(["sqlite3", str(self.path), "PRAGMA wal_checkpoint(TRUNCATE)"], check=True)
        self.campaign.wait_for_more(MESSAGES)
        self.server.process.send_signal(signal.SIGSTOP)
        before = self.path.read_bytes()
        shutil.copyfile(copy, self.path)
        self.server.process.send_signal(signal.SIGCONT)
        self.wait_until_it_fails(self.path, "is not what its index says")
        self.server.terminate(ROUND_SECONDS)
        self.assertEqual(self.path.read_bytes(), copy.read_bytes(), "a stop changes nothing")
        self.assertTrue(pathlib.Path(f"{self.path}.damaged").exists())
        # What was overwritten belongs to the WAL that is left, and nothing that was acked is lost.
        self.path.write_bytes(before)
        self.campaign.start_server(self.server)
        self.assertFalse(pathlib.Path(f"{self.path}.damaged").exists())
        self.assertRegex(self.server.text(), rf"store_check_begins store={self.path} bytes={len(before)} ")
        self.assertRegex(self.server.text(), r"store_check_done .*result=sound")
        self.kill_and_compare()


if __name__ == "__main__":
    unittest.main()
