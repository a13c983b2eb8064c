"""Histories of presence, and what is true of them whatever happened to the servers."""

import collections
import urllib.parse

# By the number in the table.
NAMES = ("PRESENCE_UNKNOWN", "PRESENCE_ONLINE", "PRESENCE_OFFLINE")
UNKNOWN, ONLINE, OFFLINE = NAMES
# Rows that a robot whose holder is gone may get: nobody hears it, then somebody does.
ROWS_OF_A_MOVE = 2


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
    answer = server.get(f"/api/v1/robots/{urllib.parse.quote(ruri, safe='')}/presence?pageSize=1000") or {}
    return [change["presence"] for change in reversed(answer.get("changes", []))]


def problems_of(history, moves):
    """What is wrong with the history of a robot that streamed all the time, and was at most `moves`
    times without a holder."""
    if not history:
        return ["no change at all"]
    found = []
    if OFFLINE in history:
        found.append("offline, though it streamed")
    if any(before == after for before, after in zip(history, history[1:])):
        found.append("a row that changes nothing")
    if history[-1] != ONLINE:
        found.append("not online at last")
    if len(history) > 1 + ROWS_OF_A_MOVE * moves:
        found.append(f"{len(history)} rows for {moves} moves")
    return found
