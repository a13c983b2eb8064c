"""How long the questions of operators take, page 1 and page 100, while messages arrive.

usage: questions.py [--store sqlite|postgres] [--robots N] [--rows N] [--rate N] [--asks N] [--json FILE] [--only TEXT]
UPLINK_BIN_DIR names the programs. Nothing is asserted about a time: the goal is a p99 of 50 ms.
"""

import argparse
import contextlib
import http.client
import json
import pathlib
import sys
import tempfile
import time
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "e2e"))

import filling  # noqa: E402
from harness import Cluster, Fleet, Server  # noqa: E402

GOAL_MS = 50
PAGE_ROWS = 100
FAR_PAGE = 100
# Robots of the load; each sends so many messages a second.
LOAD_ROBOTS = 100
FLEET = "fleet7"
# A robot that is of that fleet.
ROBOT = filling.ruri(27)
ROBOT_FILTERS = (
    "presence=offline", "batteryBelow=20", "bbox=7,46,8,48", "software=1.0", "heldBack=true", "estop=true", "faulted=true",
    "certificateExpiresBefore=2999-01-01T00:00:00Z", "orderBy=battery", "orderBy=-lastHeard", "orderBy=-backlog",
)  # fmt: skip
OTHERS = [filling.ruri(47), filling.ruri(67)]


def questions(robots):
    """Each list with each filter alone; the same again with a fleet follows from it."""
    ruri = urllib.parse.quote(ROBOT, safe="")
    several = "&".join(f"ruri={urllib.parse.quote(name, safe='')}" for name in [ROBOT, *OTHERS])
    # The last tenth of the rows' time, and an hour in its middle.
    day = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(time.time() - 9 * 86_400))
    lists = {
        "events": ["kind=kind7"],
        "messages": ["level=error"],
        "faults": ["severity=critical", "faultId=fault7", "source=drive7", "active=true", "active=true&severity=critical"],
        "missions": ["status=error", "missionId=mission7", "runId=run777", "open=true"],
        "mission-reports": ["status=error", "missionId=mission7", "runId=run777"],
        "presence": [],
        "gaps": [],
        "quarantine": ["reason=unknown_variant"],
        "operator-requests": ["open=true"],
        "connections": ["open=true", "why=broken", "source=uplink"],
        "scope-updates": ["id=00000000-0000-4000-8000-000000000007"],
    }  # fmt: skip
    for name, filters in lists.items():
        # What a scope reports is no robot's.
        by_robot = [] if name == "scope-updates" else [f"ruri={ruri}", several]
        for text in ("", f"from={day}", "orderBy=oldest", *by_robot, *filters):
            yield f"/api/v1/{name}", text
    for text in ("", *ROBOT_FILTERS, f"q=r{robots - 1}", f"offlineBefore={day}"):
        yield "/api/v1/robots", f"{text}&parts=none".lstrip("&")
    yield "/api/v1/robots", ""
    yield "/api/v1/fleets", ""
    yield "/api/v1/robot/story", f"ruri={ruri}"


class Asker:
    def __init__(self, server):
        host, port = server.http.rsplit(":", 1)
        self.connection = http.client.HTTPConnection(host, int(port), timeout=60)

    def ask(self, target):
        """Milliseconds and the answer."""
        began = time.perf_counter()
        self.connection.request("GET", target)
        answer = self.connection.getresponse()
        body = answer.read()
        took = (time.perf_counter() - began) * 1000
        if answer.status != 200:
            return took, answer.status, body[:200].decode(errors="replace")
        return took, 200, json.loads(body)

    def page(self, target, number):
        """The target of this page; nothing if the list is shorter."""
        here = target
        for _ in range(number - 1):
            _, status, page = self.ask(here)
            token = page.get("nextPageToken") if status == 200 else None
            if not token:
                return None
            here = f"{target}&pageToken={urllib.parse.quote(token, safe='')}"
        return here


def percentile(values, share):
    return sorted(values)[min(int(len(values) * share), len(values) - 1)]


def measured(asker, target, asks):
    """A row of figures."""
    times = []
    for _ in range(asks):
        took, status, answer = asker.ask(target)
        if status != 200:
            return {"target": target, "status": status, "answer": answer}
        times.append(took)
    rows = next((len(part) for part in answer.values() if isinstance(part, list)), 0)
    return {"target": target, "rows": rows, "p50_ms": percentile(times, 0.5), "p99_ms": percentile(times, 0.99)}


def survey(asker, arguments):
    rows = []
    for path, text in questions(arguments.robots):
        for fleet in ("", f"fleet={FLEET}"):
            if fleet and path.endswith("/story"):
                continue
            target = f"{path}?{'&'.join(part for part in (text, fleet, f'pageSize={PAGE_ROWS}') if part)}"
            if arguments.only and arguments.only not in target:
                continue
            row = measured(asker, target, arguments.asks)
            far = asker.page(target, FAR_PAGE) if "status" not in row else None
            if far:
                row["page_100"] = measured(asker, far, arguments.asks)
            rows.append(row)
            show(row)
    return rows


def show(row):
    if "status" in row:
        print(f"{row['status']} {row['target']} {row['answer']}", flush=True)
        return
    far = row.get("page_100", {})
    marks = "".join("*" if part.get("p99_ms", 0) > GOAL_MS else "" for part in (row, far))
    at_100 = f"{far['p50_ms']:7.1f} {far['p99_ms']:7.1f}" if "p50_ms" in far else f"{'':15}"
    print(f"{row['p50_ms']:7.1f} {row['p99_ms']:7.1f} {at_100} {row['rows']:5} {marks:2} {row['target']}", flush=True)


def parse():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--store", choices=["sqlite", "postgres"], default="sqlite")
    parser.add_argument("--robots", type=int, default=10_000)
    parser.add_argument("--rows", type=int, default=10_000_000)
    parser.add_argument("--rate", type=int, default=5_000, help="messages per second that arrive")
    parser.add_argument("--asks", type=int, default=100)
    parser.add_argument("--only", default="", help="only targets with this text")
    parser.add_argument("--json", type=pathlib.Path)
    return parser.parse_args()


def main():
    arguments = parse()
    # Rows are as old as 90 days: none goes while the questions are asked.
    settings = (
        'retention.history = "0"\nretention.quarantine = "0"\nretention.connections = "0"\n'
        f"[limits]\nrobots_max = {max(arguments.robots + LOAD_ROBOTS, 1000)}\n"
    )
    with contextlib.ExitStack() as things, tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        # The user postgres reads below it.
        folder.chmod(0o755)
        cluster = None
        if arguments.store == "postgres":
            cluster = Cluster(folder).create().migrate()
            things.callback(cluster.close)
        server = Server(folder, settings, cluster and cluster.url("uplinkd"))
        if cluster is None:
            # Makes the store's tables.
            server.start()
            server.terminate(30)
        began = time.monotonic()
        print(f"filling {arguments.rows} rows of {arguments.robots} robots", flush=True)
        if cluster is None:
            filling.fill_sqlite(folder / "uplinkd.db", arguments.rows, arguments.robots)
        else:
            filling.fill_postgres(cluster, arguments.rows, arguments.robots)
        print(f"filled in {time.monotonic() - began:.0f} s; p50 and p99 in ms of page 1 and page {FAR_PAGE},", end=" ")
        print(f"rows; * is over {GOAL_MS} ms", flush=True)
        server.start()
        things.callback(server.kill)
        fleet = Fleet(server, "--robots", LOAD_ROBOTS, "--rate", arguments.rate // LOAD_ROBOTS)
        things.callback(fleet.close)
        server.wait_for_status(lambda status: int(status["streams"]) >= LOAD_ROBOTS, 60, "the load is there")
        rows = survey(Asker(server), arguments)
    if arguments.json:
        arguments.json.write_text(json.dumps({"store": arguments.store, "rows": arguments.rows, "questions": rows}))
    late = [row for row in rows if max(row.get("p99_ms", 0), row.get("page_100", {}).get("p99_ms", 0)) > GOAL_MS]
    print(f"{len(rows)} questions, {len(late)} over {GOAL_MS} ms, {sum('status' in row for row in rows)} refused")
    return 0


if __name__ == "__main__":
    sys.exit(main())
