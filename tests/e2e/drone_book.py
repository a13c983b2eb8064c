"""What a drone published and was answered, and what must be stored: the book that a drone of these
tests keeps (drone.py), and its comparison with the rows of a server.

A drone sends a durable sample again until it has an OK answer, and only then the next one of the type.
So the numbers of a type are settled in their order, and at most the last one is open: that one may be
stored or not.
"""

import collections
import json
import operator
import re
import typing

from drone_samples import MODES, STORED, WRONG, alerts_of, requests_of, value_of

NUMBER = re.compile(r"number (\d+)\.")
WRONG_NUMBER = re.compile(r"wrong-(\d+)")
# Answers after which a sample is not sent again: the outcomes of a call that ended OK.
FINAL = ("STORED", "APPLIED", "SUPERSEDED", "DUPLICATE", "REJECTED")
# What leaves rows.
KEPT = (*STORED, WRONG)
KINDS = {
    "Armed": "armed",
    "FlightMode": "flightMode",
    "UncrewFlightMode": "uncrewFlightMode",
    "CurrentMissionItem": "missionItem",
    "Error": "error",
    "ConnectionEvent": "connection",
    "UAVCommandResult": "commandResult",
}


class Book:
    """Confined to one thread, or read when that is done."""

    def __init__(self):
        # By type, in the order in which they were first published: number to its answers.
        self.samples = collections.defaultdict(dict)

    def publish(self, name, number):
        """It goes out now, perhaps once more."""
        self.samples[name].setdefault(number, [])

    def answer(self, name, number, word):
        """An outcome, the name of a status other than OK, or that an answer was not read."""
        self.samples[name][number].append(word)

    def is_settled(self, name, number):
        return any(word in FINAL for word in self.samples[name][number])

    def open_samples(self):
        return [(name, number) for name in KEPT for number in self.samples[name]
                if not self.is_settled(name, number)]  # fmt: skip

    def words(self, *names):
        """How often each answer came to samples of these types; of all without a name."""
        chosen = names or self.samples
        return collections.Counter(word for name in chosen for words in self.samples[name].values() for word in words)

    def dump(self):
        return {name: list(numbers.items()) for name, numbers in self.samples.items()}

    @classmethod
    def load(cls, dumped):
        book = cls()
        for name, numbers in dumped.items():
            book.samples[name] = {number: list(words) for number, words in numbers}
        return book

    def add(self, later):
        """What another book of the same drone has: other types, or later numbers."""
        for name, numbers in later.samples.items():
            self.samples[name].update(numbers)

    def last(self):
        """The highest number of all."""
        return max((number for numbers in self.samples.values() for number in numbers), default=0)

    def sets(self):
        """The ids of the alerts and of the requests of the sets that were answered last."""
        return tuple(
            ids_of(max((number for number in self.samples[name] if self.is_settled(name, number)), default=0))
            for name, ids_of in (("Alert", alerts_of), ("OperatorActionRequests", requests_of))
        )

    def due(self, name):
        """The rows of what was answered for, and of that with what is open."""
        numbers = list(self.samples[name])
        return rows_due(name, [each for each in numbers if self.is_settled(name, each)]), rows_due(name, numbers)

    def account(self, stored):
        """How many rows are due, are there, are missing, and are too many."""
        acked, possible, rows = collections.Counter(), collections.Counter(), collections.Counter()
        for name in KEPT:
            for counter, each in zip((acked, possible, rows), (*self.due(name), stored.get(name, ()))):
                counter.update((name, *row) for row in each)
        return Account(acked.total(), rows.total(), (acked - rows).total(), (rows - possible).total())

    def problems(self, stored):
        """A text for each thing that is wrong. `stored`: by type the rows in the order of the store, each
        (line, value); those of one line have an order (see rows_of)."""
        found = [f"{name} {number}: {' '.join(words)}" for name in KEPT for number, words in self.samples[name].items()
                 if self.is_settled(name, number) and (name == WRONG) != ("REJECTED" in words)]  # fmt: skip
        for name in KEPT:
            rows, due, possible = map(_by_line, (stored.get(name, ()), *self.due(name)))
            for line in sorted({*rows, *possible}):
                found += _compare(f"{name} {line}".strip(), *(each.get(line, []) for each in (rows, due, possible)))
        return found


class Account(typing.NamedTuple):
    """Numbers of rows."""

    acked: int = 0
    stored: int = 0
    lost: int = 0
    doubled: int = 0

    def __add__(self, other):
        return Account(*map(operator.add, self, other))


def rows_due(name, numbers):
    """What samples of these numbers leave in the store, one after the other."""
    if name == "Alert":
        return _changes_of_sets(map(alerts_of, numbers))
    if name == "OperatorActionRequests":
        return _changes_of_sets(map(requests_of, numbers))
    rows, before = [], None
    for number in numbers:
        value = value_of(name, number)
        if value != before:
            rows.append(("", value))
        before = value
    return rows


def rows_of(events, messages, faults, requests, quarantine=()):
    """By type what lists of a server hold, the first to come first. A request is one row, with a second
    value once it is closed."""
    stored = collections.defaultdict(list)
    names = {kind: name for name, kind in KINDS.items()}
    for row in events:
        name = names.get(row["kind"])
        if name:
            stored[name].append(("", _value(name, row["detail"])))
    stored["StatusText"] = [("", int(NUMBER.search(row["message"]).group(1))) for row in messages]
    stored["Alert"] = [(row["faultId"], row["active"]) for row in faults]
    for row in requests:
        stored["OperatorActionRequests"].append((row["requestId"], True))
        if "closedAt" in row:
            stored["OperatorActionRequests"].append((row["requestId"], False))
    if quarantine:
        stored[WRONG] = [("", int(WRONG_NUMBER.search(row["detail"]).group(1))) for row in quarantine]
    return stored


def plain(word):
    """RETURN_TO_LAUNCH, FLIGHT_MODE_RETURN_TO_LAUNCH and returnToLaunch are one mode."""
    return re.sub(r"[^a-z0-9]", "", str(word).lower()).removeprefix("flightmode")


def _value(name, detail):
    to = detail.get("to")
    if name == "Armed":
        return to
    if name == "FlightMode":
        return next((mode for mode in MODES if plain(mode) == plain(to)), to)
    if name == "UncrewFlightMode":
        return to["mode"] if isinstance(to, dict) else to
    if name == "CurrentMissionItem":
        return int(to["current"] if isinstance(to, dict) else to)
    return int(NUMBER.search(json.dumps(detail)).group(1))


def _changes_of_sets(sets):
    """What each set brings, after what it ends: (id, whether it came)."""
    rows, before = [], set()
    for now in sets:
        rows += [(each, False) for each in sorted(before - now)]
        rows += [(each, True) for each in sorted(now - before)]
        before = now
    return rows


def _by_line(rows):
    lines = collections.defaultdict(list)
    for line, value in rows:
        lines[line].append(value)
    return dict(lines)


def _compare(what, rows, due, possible):
    """`due`: of what was answered for; `possible`: also of what was not."""
    if rows in (due, possible):
        return []

    def at(values):
        return repr(values[place]) if place < len(values) else "nothing"

    differing = (place for place, (row, other) in enumerate(zip(rows, possible)) if row != other)
    place = next(differing, min(len(rows), len(possible)))
    return [f"{what}: row {place} is {at(rows)}, not {at(possible)}"]
