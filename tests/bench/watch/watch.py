"""What watches cost ingestion: CPU per message and waits for acks, with watchers beside without.

usage: watch.py [--robots N] [--watchers N] [--each N] [--seconds N] [--rounds N] [--json FILE]
UPLINK_BIN_DIR names the programs. Robots report once a second; each watcher names --each of them, and one more
watches all. Nothing is asserted about a time: the goal is a ratio of at most 1.10 for both.
"""

import argparse
import contextlib
import http.client
import json
import multiprocessing
import os
import pathlib
import selectors
import sys
import tempfile
import time
import urllib.parse

for folder in ("../e2e", ".", "../support"):
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / folder))

from harness import Fleet, Server  # noqa: E402
from scrape_acks import between, buckets, p99_ms, together  # noqa: E402

GOAL = 1.10
ARRIVAL_SECONDS = 300
READ_BYTES = 1 << 20
# Watchers have the same cores as the server, and must not take them from it.
WATCHER_NICE = 19
# Threads that take what robots send, by the beginning of their names; the others serve operators.
INGESTION = ("relay", "journal")


def watch_until(stop, address, targets, read):
    """Reads from all these until it is told to stop; `read` is how many bytes that were."""
    os.nice(WATCHER_NICE)
    with contextlib.ExitStack() as open_ones, selectors.DefaultSelector() as ready:
        for target in targets:
            connection = open_ones.enter_context(contextlib.closing(http.client.HTTPConnection(address, timeout=60)))
            connection.request("GET", target, headers={"Accept": "text/event-stream"})
            # The socket is read by hand, from the answer's first byte on.
            ready.register(connection.sock, selectors.EVENT_READ)
        last = {}
        while not stop.is_set():
            for key, _ in ready.select(0.1):
                part = key.fileobj.recv(READ_BYTES)
                if not part:
                    raise SystemExit(f"the server ended a watch: {last[key.fd]}")
                last[key.fd] = part[-300:]
                read.value += len(part)


class Watchers:
    def __init__(self, server, arguments):
        # Those of the first page; a request has room for so many names.
        robots = [robot["ruri"] for robot in server.get(f"/api/v1/robots?parts=none&pageSize={arguments.each}")["robots"]]
        named = "&".join(f"ruri={urllib.parse.quote(ruri, safe='')}" for ruri in robots)
        targets = [f"/api/v1/watch?{named}"] * arguments.watchers + ["/api/v1/watch"]
        self.stop, self.read = multiprocessing.Event(), multiprocessing.Value("q", 0)
        self.process = multiprocessing.Process(target=watch_until, args=(self.stop, server.http, targets, self.read))
        self.process.start()
        server.wait_for_status(lambda _: server.metric("uplinkd_watches") == len(targets), ARRIVAL_SECONDS, "they watch")

    def close(self):
        self.stop.set()
        self.process.join(60)
        if self.process.exitcode:
            raise SystemExit("the watchers failed")


def cpu_seconds(process):
    """By threads that ingest, and by all."""
    ingestion = total = 0
    for task in pathlib.Path(f"/proc/{process}/task").iterdir():
        # Nanoseconds on a core; the ticks of stat are too coarse for a few robots.
        name, used = (task / "comm").read_text(), int((task / "schedstat").read_text().split()[0]) / 1e9
        total += used
        ingestion += used if name.startswith(INGESTION) else 0
    return ingestion, total


def look(server):
    return {"cpu": cpu_seconds(server.process.pid), "messages": server.metric("uplinkd_uplinks_received_total"),
            "acks": buckets(server), "shown": server.metric("uplinkd_watch_robots_shown_total")}  # fmt: skip


def play(arguments, watched):
    """Figures of one run."""
    # Watches may take half of the connections.
    settings = f"[limits]\nrobots_max = {arguments.robots + 100}\n[http]\nconnections_max = {2 * arguments.watchers + 64}\n"
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as things:
        server = Server(pathlib.Path(folder), settings).start()
        things.callback(server.close)
        fleet = Fleet(server, "--robots", arguments.robots, "--rate", 1, "--pace", 0.1, "--acks-only")
        things.callback(fleet.close)
        server.wait_for_status(lambda status: int(status["streams"]) == arguments.robots, ARRIVAL_SECONDS, "all stream")
        watchers = Watchers(server, arguments) if watched else None
        before = look(server)
        time.sleep(arguments.seconds)
        after = look(server)
        if watchers:
            watchers.close()
        messages = after["messages"] - before["messages"]
        ingestion, total = ((late - early) * 1e6 / messages for early, late in zip(before["cpu"], after["cpu"]))
        return {"ingestion_us": ingestion, "total_us": total, "messages": messages,
                "acks": between(before["acks"], after["acks"]), "shown": after["shown"] - before["shown"],
                "bytes": watchers.read.value if watchers else 0}  # fmt: skip


def parse():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--robots", type=int, default=10_000)
    parser.add_argument("--watchers", type=int, default=100)
    parser.add_argument("--each", type=int, default=50, help="robots that one of them names")
    parser.add_argument("--seconds", type=int, default=30)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--commit", default="")
    parser.add_argument("--json", type=pathlib.Path)
    return parser.parse_args()


def main():
    arguments = parse()
    rounds = {False: [], True: []}
    for _ in range(arguments.rounds):
        for watched in (False, True):
            figures = play(arguments, watched)
            rounds[watched].append(figures)
            print(f"{'with   ' if watched else 'without'} watchers: {figures['ingestion_us']:.2f} us of ingestion and "
                  f"{figures['total_us']:.2f} us in all per message, ack p99 {p99_ms(figures['acks']):.1f} ms, "
                  f"{figures['messages']:.0f} messages, {figures['shown']:.0f} changes shown", flush=True)  # fmt: skip
    rows = []
    for name, unit, of in (
        ("ingestion_cpu_while_watched", "us/message", lambda each: sum(one["ingestion_us"] for one in each) / len(each)),
        ("ack_p99_while_watched", "ms", lambda each: p99_ms(together([one["acks"] for one in each]))),
    ):
        base, value = of(rounds[False]), of(rounds[True])
        rows.append({"scenario": name, "value": value, "unit": unit, "comparator": "without watchers",
                     "comparator_value": base, "ratio": value / base if base else 0})  # fmt: skip
        mark = "" if rows[-1]["ratio"] <= GOAL else " *"
        print(f"{name}: {base:.2f} without, {value:.2f} with, {unit}: ratio {rows[-1]['ratio']:.2f}{mark}")
    print(f"{arguments.watchers} watchers of {arguments.each} robots and one of all {arguments.robots}; "
          f"* is over the goal, {GOAL:.2f}")  # fmt: skip
    if arguments.json:
        arguments.json.write_text(json.dumps({"commit": arguments.commit, "rows": rows}) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
