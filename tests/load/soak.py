"""Hours of load with reconnects and store outages: does anything grow that should not?

    soak.py [--minutes N] [--store sqlite|postgres] [--robots N] [--seed S] [--outage-every SECONDS]
            [--json FILE]

A synthetic fleet works on a real uplinkd while the store goes away again and again. Memory,
descriptors, threads and file sizes are looked at every ten seconds; the slopes of what is left after
the first quarter are printed, per hour. It ends with the fleet's own verification.
"""

import argparse
import json
import os
import pathlib
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "e2e"))
from harness import BIN, Cluster, Server, mismatches, wait_until  # noqa: E402

# Without an outage, at the end: so long, and at most a third of the run.
QUIET_SECONDS = 20
QUIET_SHARE = 1 / 3
# A ninth of the time the store is away.
OUTAGE_SHARE = 1 / 9
SCENARIO = pathlib.Path(__file__).parent / "scenarios" / "soak.toml"


class SqliteStore:
    def __init__(self, folder):
        self.path = folder / "uplinkd.db"
        self.url = f"sqlite://{self.path}"
        self.holder = None

    def take_away(self):
        """Another process writes, and does not end."""
        self.holder = sqlite3.connect(self.path, timeout=30, isolation_level=None)
        self.holder.execute("BEGIN IMMEDIATE")

    def give_back(self):
        self.holder.rollback()
        self.holder.close()
        self.holder = None

    def size(self):
        return sum(path.stat().st_size for path in self.path.parent.glob(self.path.name + "*"))

    def close(self):
        if self.holder is not None:
            self.give_back()


class PostgresStore:
    def __init__(self, folder):
        self.cluster = Cluster(folder).create().migrate()
        self.url = self.cluster.url("uplinkd")
        self.last_size = 0

    def take_away(self):
        self.cluster.halt()

    def give_back(self):
        self.cluster.crash()

    def size(self):
        try:
            self.last_size = int(self.cluster.sql("SELECT pg_database_size('uplinkd')", "postgres"))
        except AssertionError:
            pass  # away
        return self.last_size

    def close(self):
        self.cluster.close()


def look(pid, store):
    """What the process holds now."""
    status = pathlib.Path(f"/proc/{pid}/status").read_text(encoding="utf-8")
    fields = dict(line.split(":", 1) for line in status.splitlines() if ":" in line)
    return {
        "rss_kib": int(fields["VmRSS"].split()[0]),
        "descriptors": len(os.listdir(f"/proc/{pid}/fd")),
        "threads": int(fields["Threads"]),
        "store_kib": store.size() // 1024,
    }


def slope_an_hour(samples, key):
    """Least squares over (seconds, value)."""
    count = len(samples)
    if count < 2:
        return 0.0
    mean_x = sum(at for at, _ in samples) / count
    mean_y = sum(values[key] for _, values in samples) / count
    over = sum((at - mean_x) * (values[key] - mean_y) for at, values in samples)
    under = sum((at - mean_x) ** 2 for at, _ in samples)
    return 3600 * over / under


def table(samples):
    rest = samples[len(samples) // 4 :]
    lines = [f"{'what':<12} {'first':>12} {'after 1/4':>12} {'most':>12} {'last':>12} {'an hour':>12}"]
    for key in samples[0][1]:
        most = max(values[key] for _, values in samples)
        lines.append(
            f"{key:<12} {samples[0][1][key]:>12} {rest[0][1][key]:>12} {most:>12} {samples[-1][1][key]:>12}"
            f" {slope_an_hour(rest, key):>+12.1f}"
        )
    return "\n".join(lines)


class Soak:
    def __init__(self, folder, arguments):
        self.arguments = arguments
        self.store = (PostgresStore if arguments.store == "postgres" else SqliteStore)(folder)
        self.server = Server(folder, store_url=self.store.url).start()
        # Each outage is seen.
        self.look_seconds = min(10, arguments.outage_every * OUTAGE_SHARE / 2)
        self.samples = []
        self.outages = 0
        self.away = False
        self.told = 0
        self.fleet = None
        self.folder = folder

    def start_fleet(self):
        with (self.folder / "fleet.log").open("wb") as log:
            self.fleet = subprocess.Popen(
                [str(BIN / "uplink-fleet"), "--target", self.server.relay, "--http", self.server.http,
                 "--pki", str(self.server.pki), "--scenario", str(SCENARIO), "--robots",
                 str(self.arguments.robots), "--for", f"{self.arguments.minutes * 60:.0f}s", "--seed",
                 str(self.arguments.seed), "--report", "json"],
                stdout=(self.folder / "report.json").open("wb"), stderr=log,
            )  # fmt: skip

    def outage(self, seconds):
        """By turns the store goes, and comes back."""
        every = self.arguments.outage_every
        away = seconds % every >= every * (1 - OUTAGE_SHARE)
        if away == self.away:
            return
        self.away = away
        if away:
            self.outages += 1
            self.store.take_away()
        else:
            self.store.give_back()

    def run(self):
        """To the end of the load, then the fleet's code and report."""
        self.start_fleet()
        began = time.monotonic()
        end = self.arguments.minutes * 60
        quiet = min(QUIET_SECONDS, end * QUIET_SHARE)
        while (seconds := time.monotonic() - began) < end:
            try:
                self.fleet.wait(self.look_seconds)
                break
            except subprocess.TimeoutExpired:
                pass
            self.samples.append((seconds, look(self.server.process.pid, self.store)))
            # Quiet at the end, so that all can be settled.
            if seconds < end - quiet:
                self.outage(seconds)
            elif self.away:
                self.outage(0)
            if seconds >= self.told + 60:
                self.told = seconds
                print(f"{seconds:6.0f} s {self.samples[-1][1]}", file=sys.stderr, flush=True)
        code = self.fleet.wait(600)
        wait_until(self.server.process, lambda: self.server.get("/api/v1/status"), 30, "the server answers")
        return code, json.loads((self.folder / "report.json").read_text(encoding="utf-8"))

    def close(self):
        if self.fleet is not None and self.fleet.poll() is None:
            self.fleet.kill()
            self.fleet.wait(30)
        self.server.close()
        self.store.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--store", choices=("sqlite", "postgres"), default="sqlite")
    parser.add_argument("--robots", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--outage-every", type=int, default=180)
    parser.add_argument("--json")
    arguments = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="uplink-soak."))
    soak = Soak(folder, arguments)
    try:
        code, report = soak.run()
    finally:
        soak.close()
    run_ = report["run"]
    print(table(soak.samples))
    print(f"{arguments.store}, {arguments.minutes:g} min, {arguments.robots} robots, seed {arguments.seed}:"
          f" {run_['sent']:.0f} messages, {run_['ackedDurable']:.0f} durable acked, {run_['connects']:.0f}"
          f" connections, {soak.outages} outages of the store")  # fmt: skip
    print("verification: all agree" if code == 0 else f"verification: {mismatches(report)}")
    if arguments.json:
        pathlib.Path(arguments.json).write_text(
            json.dumps({"samples": soak.samples, "run": run_, "ok": code == 0}), encoding="utf-8"
        )
    if code == 0:
        shutil.rmtree(folder)
    else:
        print(f"kept: {folder}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
