"""What the twins of the crash campaign with a broker (broker_chaos.py) say, by their keys (broker_book.py),
and how those are read from what is stored.
"""

import collections
import enum
import itertools
import json
import re

TWINS = 40
# The twin whose messages show that the server is there again.
PROBE = TWINS
ROBOT = "rcan://local.rcan/cyberwave/twin/"
UUID = "00000000-0000-4000-8000-{:012}"
# The number of a rejected message is how much longer than this it is: its row always has the length.
WRONG_BYTES = 64


class Kind(enum.Enum):
    TELEMETRY = "telemetry"
    EVENT = "event"
    DRIVERLOG = "driverlog"
    # Errors: two faults that are raised, and the two before cleared. Both that are raised are keys.
    METRICS = "metrics"
    METRICS_TOO = "metrics too"
    # The errors of the metrics before it once more: no row. Taken after later metrics, it would raise again.
    STEADY = "steady"
    # Without its type, so that it is a row of quarantine.
    WRONG = "wrong"
    # Of an environment, which is no robot.
    SCOPE = "scope"


# What is published as a message of its own.
KINDS = [kind for kind in Kind if kind is not Kind.METRICS_TOO]
# The order in which a twin says them.
TURNS = [Kind.TELEMETRY, Kind.EVENT, Kind.DRIVERLOG, Kind.METRICS, Kind.TELEMETRY, Kind.STEADY,
         Kind.DRIVERLOG, Kind.EVENT, Kind.TELEMETRY, Kind.SCOPE, Kind.METRICS, Kind.STEADY, Kind.TELEMETRY,
         Kind.EVENT, Kind.WRONG]  # fmt: skip


def uuid_of(twin):
    return UUID.format(twin)


def ruri_of(twin):
    return ROBOT + uuid_of(twin)


def numbers_of(twin):
    """The keys of a twin's messages, without end."""
    counts = collections.Counter()
    for kind in itertools.cycle(TURNS):
        counts[kind] += 1
        yield twin, kind, counts[kind]


def keys_of(key):
    """The rows that this message must leave."""
    twin, kind, number = key
    if kind is Kind.STEADY:
        return []
    return [key, (twin, Kind.METRICS_TOO, number)] if kind is Kind.METRICS else [key]


def keys_again(key):
    """The rows that this message may leave when its publisher says it again, behind what it said since."""
    twin, kind, number = key
    return keys_of((twin, Kind.METRICS, number) if kind is Kind.STEADY else key)


def message_of(twin, kind, number):
    """Topic and payload."""
    below = f"cyberwave/twin/{uuid_of(twin)}/"
    match kind:
        case Kind.TELEMETRY:
            return below + "telemetry", json.dumps({"type": "chaos", "n": number})
        case Kind.EVENT:
            said = {"event_type": "chaos_step", "source": "chaos", "data": {"n": number}}
            return below + "event", json.dumps(said)
        case Kind.DRIVERLOG:
            return below + "driverlog", json.dumps({"message": f"line {number}", "level": "info"})
        case Kind.METRICS | Kind.STEADY:
            cpu = 0.5 if kind is Kind.METRICS else 0.25
            metrics = {"errors": [f"first {number}", f"second {number}"], "load": {"cpu": cpu}}
            return below + "metrics", json.dumps({"source_type": "edge", "metrics": metrics})
        case Kind.WRONG:
            return below + "telemetry", json.dumps({"n": number}).ljust(WRONG_BYTES + number)
        case Kind.SCOPE:
            return f"cyberwave/environment/{uuid_of(twin)}/chaos", json.dumps(
                {"type": "chaos", "data": {"n": number}}
            )
    raise AssertionError(kind)


# A row each: the table, the RURI or what stands for it, and the text that holds the number; in order of
# the writing. Raised faults alone: a cleared one shows in `CLEARED`.
ROWS = """
SELECT what, whose, said FROM (
  SELECT entry, kind AS what, ruri AS whose, detail AS said FROM events
  UNION ALL SELECT entry, 'log', ruri, message FROM messages
  UNION ALL SELECT entry, 'raised', ruri, fault_id FROM faults_history
    WHERE CAST(active AS INTEGER) = 1
  UNION ALL SELECT entry, 'wrong', ruri, CAST(payload_bytes AS TEXT) FROM quarantine
  UNION ALL SELECT entry, 'scope', id, detail FROM scope_updates) AS said
ORDER BY entry"""
# Faults that were raised another number of times than they were cleared and are active.
UNBALANCED = """
SELECT h.ruri, h.fault_id FROM faults_history AS h
GROUP BY h.ruri, h.fault_id
HAVING sum(2 * CAST(h.active AS INTEGER) - 1) <> (SELECT count(*) FROM faults_active AS a
  WHERE a.ruri = h.ruri AND a.fault_id = h.fault_id)"""

KIND_OF = {"cyberwave/chaos": Kind.TELEMETRY, "cyberwave/chaos_step": Kind.EVENT, "log": Kind.DRIVERLOG,
           "wrong": Kind.WRONG, "scope": Kind.SCOPE}  # fmt: skip
NUMBER = re.compile(r"\d+")


def key_of_row(what, whose, said):
    twin = int(whose[-12:])
    number = int(NUMBER.search(said).group())
    if what == "raised":
        return twin, Kind.METRICS if said.startswith("first") else Kind.METRICS_TOO, number
    if what == "wrong":
        number -= WRONG_BYTES
    return twin, KIND_OF[what], number
