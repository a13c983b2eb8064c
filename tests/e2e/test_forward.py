"""Whether a real server says that robots may lack what others share."""

import contextlib
import sqlite3
import time
import unittest
import urllib.request

from harness import EndToEnd, wait_until

NOTICED_SECONDS = 30
RURI = "rcan://example.org/acme/rover/1.0/r1"


class Incomplete(EndToEnd):
    def store(self, *statements):
        """What an operator, or a fault, does to the rows of the store."""
        with contextlib.closing(sqlite3.connect(self.folder / "uplinkd.db", timeout=30)) as database, database:
            for statement, *values in statements:
                database.execute(statement, values)

    def page(self):
        with urllib.request.urlopen(f"http://{self.running.http}/metrics", timeout=10) as page:
            return page.read().decode()

    def wait_for_word(self, there):
        value = int(there)
        wait_until(
            self.running.process,
            lambda: f'\nuplinkd_degraded{{reason="forward"}} {value}\n' in self.page(),
            NOTICED_SECONDS, f"uplinkd_degraded is {value} of forward",
        )  # fmt: skip
        ready = self.running.get("/readyz")
        self.assertEqual("forward" in ready["degraded"], there, ready)

    def test_a_row_that_cannot_be_forwarded_is_told_until_it_is_mended(self):
        self.running = self.server().start()
        self.wait_for_word(False)
        # Beside the server: its look finds the change. One that was silent for long would be removed.
        now = time.time_ns() // 1_000_000
        self.store(
            ("INSERT INTO robots (ruri, fleet, epoch, held_since, owner, first_seen, last_seen)"
             " VALUES (?, 'north', 1, 1, zeroblob(16), ?, ?)", RURI, now, now),
            ("INSERT INTO shapes VALUES (?, 'pit', 'north', 1, 1, 1, 0, 'The pit', 1, '', 3, 1, 0, 0, 0, 'broken')",
             RURI),
        )  # fmt: skip
        self.wait_for_word(True)
        self.running.wait_for_line(f"forward_unreadable robot={RURI} id=pit")
        self.assertEqual(self.running.metric("uplinkd_forward_items_unreadable"), 1)
        # From the first moment of another life, too.
        self.assertEqual(self.running.terminate(30), 0)
        self.running.start()
        self.wait_for_word(True)
        self.store(("DELETE FROM shapes WHERE id = 'pit'",))
        self.wait_for_word(False)
        self.assertEqual(self.running.terminate(30), 0)


if __name__ == "__main__":
    unittest.main()
