"""The agent's memory on disk: what has to be stored, until the server says that it is."""

import contextlib
import os
import sqlite3
import threading
import time

# Messages that wait at most. One more is refused, so that the disk does not fill while a link is away.
WAITING_MAX = 100_000
# The server's Limits: messages of a frame, the largest payload, and half of the largest frame.
BATCH_MAX, PAYLOAD_BYTES_MAX, FRAME_BYTES_MAX = 256, 256 * 1024, 512 * 1024

TABLES = """
CREATE TABLE IF NOT EXISTS session (
  only INTEGER PRIMARY KEY CHECK (only = 1), id BLOB NOT NULL,
  last INTEGER NOT NULL, settled INTEGER NOT NULL, judged INTEGER NOT NULL);
CREATE TABLE IF NOT EXISTS message (
  at INTEGER PRIMARY KEY AUTOINCREMENT, seq INTEGER UNIQUE, key TEXT NOT NULL, due REAL NOT NULL,
  payload BLOB NOT NULL);
"""


class ProtocolError(Exception):
    """The server named a number that no message has had."""


class Spool:
    """Numbers and messages of one session, in a file of SQLite. A message has its number from the moment at
    which it may be sent, and keeps it. Each change is on disk when its method returns, and undone when it raises
    sqlite3.Error, such as for a full disk, or ProtocolError. Thread-safe."""

    def __init__(self, path):
        self.lock = threading.Lock()
        self.base = sqlite3.connect(path, check_same_thread=False, isolation_level=None)
        self.base.execute("PRAGMA journal_mode = WAL")
        self.base.execute("PRAGMA synchronous = FULL")
        self.base.executescript(TABLES)
        if "kept_ms" not in (row[1] for row in self.base.execute("PRAGMA table_info(message)")):
            # Files of earlier versions lack it: 0 is unknown.
            self.base.execute("ALTER TABLE message ADD COLUMN kept_ms INTEGER NOT NULL DEFAULT 0")
        with self.change() as base:
            base.execute("INSERT OR IGNORE INTO session VALUES (1, ?, 0, 0, 0)", (os.urandom(16),))
            # The monotonic clock may have begun anew since: what waits to be repeated is due at once.
            base.execute("UPDATE message SET due = 0 WHERE seq IS NULL")

    @contextlib.contextmanager
    def change(self):
        """A transaction: all of it, or nothing."""
        with self.lock:
            self.base.execute("BEGIN IMMEDIATE")
            try:
                yield self.base
                self.base.execute("COMMIT")
            finally:
                # An error leaves it open, unless SQLite has rolled it back itself.
                if self.base.in_transaction:
                    self.base.execute("ROLLBACK")

    def one(self, query, *values):
        with self.lock:
            return self.base.execute(query, values).fetchone()

    def hello(self):
        """The session's id, and the highest numbers that the server settled and judged."""
        return self.one("SELECT id, settled, judged FROM session")

    def waiting(self):
        (count,) = self.one("SELECT count(*) FROM message")
        return count

    def backlog(self, above):
        """How many messages were not sent up to that number, and since when the oldest of them waits; 0 if none
        does."""
        return self.one(
            "SELECT count(*), coalesce(min(kept_ms), 0) FROM message WHERE seq IS NULL OR seq > ?", above
        )

    def keep(self, key, payload):
        """Keeps a durable message, or says why not. `key` is what a later message of the same thing has too,
        such as a fault's id."""
        if len(payload) > PAYLOAD_BYTES_MAX:
            return f"{len(payload)} bytes are too many"
        with self.change() as base:
            (count,) = base.execute("SELECT count(*) FROM message").fetchone()
            if count >= WAITING_MAX:
                return "too many wait"
            # What waits to be repeated is out of date now.
            base.execute("DELETE FROM message WHERE seq IS NULL AND key = ?", (key,))
            base.execute(
                "INSERT INTO message (seq, key, due, payload, kept_ms) VALUES (?, ?, 0, ?, ?)",
                (self.number(base), key, payload, time.time_ns() // 1_000_000),
            )
        return None

    @staticmethod
    def number(base):
        base.execute("UPDATE session SET last = last + 1")
        (last,) = base.execute("SELECT last FROM session").fetchone()
        return last

    def batch(self, above, now, live):
        """What goes out next, as (number, payload) in order: durable messages above a number, and after the
        last of them the live ones, which get their numbers here. And whether the live ones are in it."""
        with self.change() as base:
            due = "SELECT at FROM message WHERE seq IS NULL AND due <= ? ORDER BY at LIMIT ?"
            for (row,) in base.execute(due, (now, BATCH_MAX)).fetchall():
                base.execute("UPDATE message SET seq = ? WHERE at = ?", (self.number(base), row))
            batch, room = [], FRAME_BYTES_MAX
            rows = base.execute("SELECT seq, payload FROM message WHERE seq > ? ORDER BY seq", (above,))
            for row in rows:
                room -= len(row[1])
                if len(batch) == BATCH_MAX or (batch and room < 0):
                    return batch, False
                batch.append(row)
            if len(batch) + len(live) > BATCH_MAX or sum(map(len, live)) > room:
                return batch, not live
            return batch + [(self.number(base), payload) for payload in live], True

    @staticmethod
    def check(base, *numbers):
        """Numbers on the wire go up to 2^64-1, which SQLite does not hold."""
        (last,) = base.execute("SELECT last FROM session").fetchone()
        if max(numbers) > last:
            raise ProtocolError(f"the server names {max(numbers)}, and the last number is {last}")

    def acked(self, through, judged):
        """Only an Ack lets the agent forget."""
        with self.change() as base:
            self.check(base, through, judged)
            base.execute("DELETE FROM message WHERE seq <= ?", (through,))
            base.execute(
                "UPDATE session SET settled = max(settled, ?), judged = max(judged, ?)", (through, judged)
            )

    def judged(self, seq):
        with self.change() as base:
            self.check(base, seq)
            base.execute("UPDATE session SET judged = max(judged, ?)", (seq,))

    def repeat(self, seq, due):
        """A message came too soon: it goes out again under a new number, not before `due` by time.monotonic(),
        which no change of the wall clock moves."""
        with self.change() as base:
            self.check(base, seq)
            found = base.execute("SELECT key FROM message WHERE seq = ?", (seq,)).fetchone()
            if found is None:
                return
            newer = "SELECT 1 FROM message WHERE key = ? AND seq > ?"
            if base.execute(newer, (found[0], seq)).fetchone():
                base.execute("DELETE FROM message WHERE seq = ?", (seq,))
            else:
                base.execute("UPDATE message SET seq = NULL, due = ? WHERE seq = ?", (due, seq))
