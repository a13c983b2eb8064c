"""How long acks take while a Prometheus scrapes the robots without a pause, beside without it.

usage: scrape_acks.py --json FILE [--robots N] [--seconds N]; UPLINK_BIN_DIR names the programs.
Rows are added to FILE, which uplink_bench_scrape wrote. Nothing is asserted about a time.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "e2e"))

from harness import Fleet, Server  # noqa: E402


SCRAPER_NICE = 19


class Scraper:
    """Scrapes as fast as answers come, until it is closed."""

    def __init__(self, server):
        self.url = f"http://{server.http}/metrics/robots"
        self.done = threading.Event()
        self.scrapes = 0
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        # The fleet has the same core, and what it sends must not come in heaps because of this thread.
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), SCRAPER_NICE)
        while not self.done.is_set():
            with urllib.request.urlopen(self.url, timeout=30) as answer:
                answer.read()
            self.scrapes += 1

    def close(self):
        self.done.set()
        self.thread.join()


def buckets(server):
    """Upper bounds in seconds and counts up to each, of uplinkd_ack_seconds."""
    with urllib.request.urlopen(f"http://{server.http}/metrics", timeout=30) as answer:
        text = answer.read().decode()
    found = re.findall(r'^uplinkd_ack_seconds_bucket\{le="([^"]+)"\} (\S+)$', text, re.MULTILINE)
    return [(float(bound), float(count)) for bound, count in found]


def between(before, after):
    return [(bound, late - early) for (bound, late), (_, early) in zip(after, before)]


def p99_ms(counts):
    """Interpolated within its bucket, as Prometheus does."""
    wanted = 0.99 * counts[-1][1]
    low, below = 0.0, 0.0
    for bound, count in counts:
        if count >= wanted:
            return 1e3 * (low + (bound - low) * (wanted - below) / max(count - below, 1))
        low, below = bound, count
    return 1e3 * low


def together(rounds):
    return [(rounds[0][i][0], sum(counts[i][1] for counts in rounds)) for i in range(len(rounds[0]))]


def play(server, arguments, scraped):
    """Waits from arrival to ack while the fleet is at work, and how many scrapes there were."""
    fleet = Fleet(
        server, "--robots", arguments.robots, "--rate", 1, "--rcan-share", 1, "--faults", 0.1, "--pace", 0.1
    )
    try:
        os.sched_setaffinity(fleet.process.pid, {os.cpu_count() - 1})
        server.wait_for_status(
            lambda status: int(status["streams"]) == arguments.robots, 120, "all robots stream"
        )
        scraper = Scraper(server) if scraped else None
        before = buckets(server)
        try:
            fleet.process.wait(arguments.seconds)
        except subprocess.TimeoutExpired:
            pass
        after = buckets(server)
        if scraper:
            scraper.close()
        return between(before, after), scraper.scrapes if scraper else 0
    finally:
        fleet.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", required=True)
    parser.add_argument("--robots", type=int, default=1500)
    parser.add_argument("--seconds", type=int, default=15)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    without, beside = [], []
    scrapes = 0
    for _ in range(arguments.rounds):
        for scraped, figures in ((False, without), (True, beside)):
            with tempfile.TemporaryDirectory() as folder:
                server = Server(folder).start()
                for thread in os.listdir(f"/proc/{server.process.pid}/task"):
                    os.sched_setaffinity(int(thread), {0})
                try:
                    counts, count = play(server, arguments, scraped)
                finally:
                    server.close()
                scrapes += count
                figures.append(counts)
    # A p99 of all acks together: that of one round is a handful of them.
    value, base = p99_ms(together(beside)), p99_ms(together(without))
    without, beside = [p99_ms(counts) for counts in without], [p99_ms(counts) for counts in beside]
    print(f"acks of {arguments.robots} robots: p99 {base:.1f} ms without scrapes, {value:.1f} ms with {scrapes} "
          f"back to back: ratio {value / base:.2f}; rounds "
          f"{[round(each, 1) for each in without]} and {[round(each, 1) for each in beside]}")  # fmt: skip
    path = pathlib.Path(arguments.json)
    document = json.loads(path.read_text(encoding="utf-8"))
    document["rows"].append(
        {
            "scenario": "ack_p99_while_scraped", "value": value, "unit": "ms", "comparator": "without scrapes",
            "comparator_value": base, "ratio": value / base,
            "spread": (max(beside) - min(beside)) / 2 / value if value else 0,
        }
    )  # fmt: skip
    path.write_text(json.dumps(document) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
