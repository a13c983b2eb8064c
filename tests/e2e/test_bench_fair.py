"""The benchmark of one bad robot beside others: it runs, and leaves nothing behind, however it ends."""

import json
import os
import pathlib
import re
import signal
import subprocess
import unittest

from harness import BIN, EndToEnd, run, wait_until

RUN_SECONDS = 120
LEFT_SECONDS = 20


def processes_of(folder):
    """Command lines of processes that name the folder."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            line = (entry / "cmdline").read_bytes() if entry.name.isdigit() else b""
        except OSError:
            continue  # it ended meanwhile
        if str(folder).encode() in line:
            found.append(line.replace(b"\0", b" ").decode())
    return found


class BenchFair(EndToEnd):
    def environment(self):
        return {**os.environ, "TMPDIR": str(self.folder)}

    def bench(self, *flags, code=0):
        return run(
            BIN / "uplink_bench_fair", "--robots", 5, "--seconds", 1, *flags,
            code=code, timeout=RUN_SECONDS, env=self.environment(),
        )  # fmt: skip

    def test_a_short_run_has_its_figures_and_leaves_nothing(self):
        rows = self.folder / "fair.json"
        done = self.bench("--only", "takeover", "--only", "joints", "--only", "gateway", "--json", rows)
        self.assertIn("goals: ", done.stdout)
        # It did what it is there for.
        sent = [int(count) for count in re.findall(r"the bad robot: did: .* (\d+) messages", done.stderr)]
        self.assertEqual(len(sent), 3, done.stderr)
        self.assertGreater(min(sent), 0, done.stderr)
        page = json.loads(rows.read_text(encoding="utf-8"))
        figures = {row["scenario"]: row["value"] for row in page["rows"]}
        for scenario in ("takeover", "joints", "gateway"):
            self.assertGreater(figures[f"{scenario}_ack_p99"], 0)
            self.assertGreater(figures[f"{scenario}_memory"], 0)
            self.assertGreater(figures[f"{scenario}_scrapes"], 0)
            self.assertEqual(figures[f"{scenario}_law_broken"], 0)
        self.assertEqual(processes_of(self.folder), [])
        self.assertEqual(list(self.folder.glob("uplinkd_*")), [])

    def test_a_server_that_does_not_start_is_said(self):
        done = self.bench("--only", "gaps", "--server-bin", "/bin/false", code=1)
        self.assertIn("no figures: /bin/false does not listen", done.stdout)

    def test_what_it_started_ends_with_it(self):
        bench = subprocess.Popen(
            [str(BIN / "uplink_bench_fair"), "--robots", "5", "--seconds", "60", "--only", "gaps"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=self.environment(),
        )  # fmt: skip
        try:
            wait_until(bench, lambda: processes_of(self.folder), LEFT_SECONDS, "it has started a server")
        finally:
            bench.send_signal(signal.SIGKILL)
            bench.wait(LEFT_SECONDS)
        with subprocess.Popen(["sleep", "infinity"]) as waiting:
            try:
                wait_until(waiting, lambda: not processes_of(self.folder), LEFT_SECONDS, "nothing is left")
            finally:
                waiting.kill()


if __name__ == "__main__":
    unittest.main()
