"""What publishers and their broker said of each message, and what is stored of it: the book of the
crash campaign with a broker (broker_chaos.py).

A message is called by its key: (twin, kind, number). A publisher that was not told whether the broker
has a message may publish it again, which makes a second message of it.
"""

import collections
import threading

# Of each finding the keys that are shown.
SHOWN = 5


class Findings:
    """What is wrong. Each is a list of keys."""

    def __init__(self):
        self.missing = []
        self.doubled = []
        self.strange = []
        self.disordered = []

    def lists(self):
        return {
            "missing": self.missing,
            "doubled": self.doubled,
            "never published": self.strange,
            "out of order": self.disordered,
        }

    def lines(self):
        return [f"{what}: {len(keys)}, such as {keys[:SHOWN]}" for what, keys in self.lists().items() if keys]


class Book:
    """Thread-safe."""

    def __init__(self):
        self.lock = threading.Lock()
        self.published = collections.Counter()
        self.acked = collections.Counter()

    def publish(self, key):
        """It goes to the broker now, perhaps once more."""
        with self.lock:
            self.published[key] += 1

    def ack(self, key):
        """The broker has it, and answers for it from now on."""
        with self.lock:
            self.acked[key] += 1

    def acks(self):
        with self.lock:
            return self.acked.total()

    def check(self, rows):
        """`rows`: the key of each row, in the order of the store."""
        with self.lock:
            published, acked = self.published.copy(), self.acked.copy()
        stored = collections.Counter(rows)
        found = Findings()
        for key, least in acked.items():
            # A state that is said twice in a row is the same state: for such kinds one row stands for
            # both, which is why not `least` is due but one.
            if stored[key] < min(least, 1):
                found.missing.append(key)
        for key, count in stored.items():
            if key not in published:
                found.strange.append(key)
            elif count > published[key]:
                found.doubled.append(key)
        found.disordered = self.out_of_order(rows)
        return found

    @staticmethod
    def out_of_order(rows):
        """Keys whose first row comes behind one of a higher number of the same twin and kind: each has
        one publisher, which counts."""
        highest, seen, found = {}, set(), []
        for key in rows:
            if key in seen:
                continue
            seen.add(key)
            twin, kind, number = key
            if number < highest.get((twin, kind), 0):
                found.append(key)
            else:
                highest[twin, kind] = number
        return found
