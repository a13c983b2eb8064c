"""Histories of presence, and what is true of them whatever happened to the servers."""

import collections
import urllib.parse

# By the number in the table.
NAMES = ("unknown", "online", "offline")
UNKNOWN, ONLINE, OFFLINE = NAMES
# The rows of a time in which no server hears a robot: its holder is gone, or stands still.
PAUSE = [UNKNOWN, ONLINE]


def stored_histories(cluster):
    """Of each robot what the table of changes says, in the order in which it was written."""
    rows = cluster.sql("SELECT ruri, presence FROM uplinkd.presence_changes ORDER BY ruri, entry")
    histories = collections.defaultdict(list)
    for line in rows.splitlines():
        ruri, presence = line.rsplit("|", 1)
        histories[ruri].append(NAMES[int(presence)])
    return dict(histories)


def shown_history(server, ruri):
    """What a server shows of a robot's changes, the earliest first."""
    answer = server.get(f"/api/v1/presence?ruri={urllib.parse.quote(ruri, safe='')}&pageSize=1000") or {}
    return [change["presence"] for change in reversed(answer.get("presenceChanges", []))]


def goes_on(before, now, pauses):
    """Whether a history that ended with online got no rows but those of at most so many pauses."""
    added = now[len(before) :]
    return now[: len(before)] == before and added == (pauses * PAUSE)[: len(added)]


def problems_of(history, pauses):
    """What is wrong with the history of a robot that streamed all the time, and was at most so often
    not heard."""
    if not history:
        return ["no change at all"]
    found = []
    if OFFLINE in history:
        found.append("offline, though it streamed")
    if any(before == after for before, after in zip(history, history[1:])):
        found.append("a row that changes nothing")
    if history[-1] != ONLINE:
        found.append("not online at last")
    if len(history) > 1 + len(PAUSE) * pauses:
        found.append(f"{len(history)} rows for {pauses} pauses")
    return found
