"""What a drone published and was answered, and what of it has to be stored: the book that a drone of these
tests keeps (drone.py), and its comparison with the rows of a server.

A drone sends a durable sample again until it is answered for good, and only then the next one of the type.
So the numbers of a type are settled in their order, and at most the last one is open: that one may be
stored or not.
"""

import collections
import json
import re

from drone_samples import MODES, STORED, alerts_of, requests_of, value_of

NUMBER = re.compile(r"number (\d+)\.")
# Answers after which a sample is not sent again.
FINAL = ("STORED", "DUPLICATE", "REJECTED")
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
        """An outcome, or the name of a status other than OK."""
        self.samples[name][number].append(word)

    def is_settled(self, name, number):
        return any(word in FINAL for word in self.samples[name][number])

    def open_samples(self):
        return [(name, number) for name in STORED for number in self.samples[name]
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

    def problems(self, stored):
        """A text for each thing that is wrong. `stored`: by type the rows in the order of the store, each
        (line, value), of which those of one line have an order (see rows_of)."""
        found = [f"{name} {number}: rejected" for name in STORED for number, words in self.samples[name].items()
                 if "REJECTED" in words]  # fmt: skip
        for name in STORED:
            numbers = list(self.samples[name])
            least = [number for number in numbers if self.is_settled(name, number)]
            rows, due, possible = (
                _by_line(each) for each in (stored.get(name, ()), rows_due(name, least), rows_due(name, numbers))
            )
            for line in sorted({*rows, *possible}):
                found += _compare(f"{name} {line}".strip(), *(each.get(line, []) for each in (rows, due, possible)))
        return found


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


def rows_of(events, messages, faults, requests):
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
        if int(row["closedAtMs"]):
            stored["OperatorActionRequests"].append((row["requestId"], False))
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
