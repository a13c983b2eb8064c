"""The campaign of failovers: a primary that dies, and an asynchronous standby that lacks its last commits and
takes over, again and again. chaos_run.py runs it.

What was acked before the primary died, and that only it had, is gone: robots have forgotten it. All that robots
still hold then, or send afterwards, must be stored before it is acked. So in two rounds of three the road of the
robots is cut at a random moment, and they are killed: the server commits on the lost primary what robots never
get an ack for, and then send again. In the others their streams stand all the time.

Two places take turns: the one that died becomes the copy that follows the other.
"""

import os
import pathlib
import random
import signal
import time

from chaos import PROGRESS_EVERY, ROBOTS, Robots
from chaos_pair import WRONG
from chaos_stores import LIVE_STEP, RECOVERY_SECONDS, STEPS, Postgres
from harness import BIN, POSTGRES, Server, Standby, run, wait_until
from tcp_proxy import Cut, TcpProxy

PACE_MS = 40
# Within that a robot has read what its stream brought.
QUIET_SECONDS = 1
CANARY = "trusts_reconnect"
# Silence of the robots while the road is cut, and the primary away, is shorter than that by far.
SETTINGS = """[presence]
timeout = "30s"
"""
# Robots' numbers that left a row, and how often.
ROWS = """WITH said AS (
  SELECT ruri, seq FROM uplinkd.events UNION ALL SELECT ruri, seq FROM uplinkd.messages
  UNION ALL SELECT ruri, seq FROM uplinkd.faults_history UNION ALL SELECT ruri, seq FROM uplinkd.mission_reports
  UNION ALL SELECT ruri, seq FROM uplinkd.quarantine)
SELECT right(ruri, 3)::int, seq, count(*) FROM said GROUP BY ruri, seq"""
STREAMS = "SELECT pid FROM pg_stat_replication WHERE application_name = 'standby' AND state = 'streaming'"


class Pair:
    """A primary, and an asynchronous standby that can be kept from what comes; `store` follows the primary."""

    def __init__(self, folder, store):
        self.store = store
        self.primary = store.cluster
        self.standby = Standby(folder, self.primary)
        places = [self.primary.place, self.standby.place]
        self.url = "postgresql://uplinkd@/uplinkd?" + "&".join(
            f"{key}=" + ",".join(place[name] for place in places)
            for key, name in (("host", "folder"), ("port", "port"))
        )

    def wait(self, condition, what):
        """On processes that are none of ours."""
        deadline = time.monotonic() + RECOVERY_SECONDS
        while not (found := condition()):
            if time.monotonic() > deadline:
                raise AssertionError(f"not within {RECOVERY_SECONDS} s: {what}")
        return found

    def hold_back(self):
        """From now on the standby gets nothing more."""
        sender = self.wait(lambda: self.primary.sql(STREAMS, "postgres"), "the standby follows")
        os.kill(int(sender), signal.SIGSTOP)

    def kill(self):
        """All processes of the primary at once, as a machine that loses power."""
        self._signal(signal.SIGKILL)

    def hang(self):
        """The primary keeps its connections and answers nothing, as a machine whose disk stalls."""
        self._signal(signal.SIGSTOP)

    def _signal(self, number):
        data = pathlib.Path(self.primary.place["folder"]) / "data"
        postmaster = int((data / "postmaster.pid").read_text().split()[0])
        children = pathlib.Path(f"/proc/{postmaster}/task/{postmaster}/children").read_text().split()
        for pid in (postmaster, *map(int, children)):
            try:
                os.kill(pid, number)
            except ProcessLookupError:
                pass

    def promote(self):
        """The standby replays what it has, and takes writes."""
        run(POSTGRES, "promote", self.standby.state)
        self.primary, self.standby = self.standby, self.primary
        self.store.cluster = self.primary

    def rejoin(self):
        """The place that died follows the new primary."""
        run(POSTGRES, "rejoin", self.standby.state, self.primary.state, timeout=120)

    def close(self):
        self.standby.close()
        self.primary.close()


class FailoverCampaign:
    def __init__(self, folder, seed, canary=None):
        self.random = random.Random(seed)
        self.store = Postgres(folder)
        self.pair = Pair(folder, self.store)
        self.server = Server(folder, SETTINGS, self.pair.url)
        self.canary = canary
        if canary:
            self.server.program = BIN / f"uplinkd_{canary}"
        self.robots = Robots(folder, seed, PACE_MS)
        self.road = None
        self.done = 0
        # What robots were acked when the primary died.
        self.before = dict.fromkeys(range(ROBOTS), 0)
        self.acked = self.lost = self.doubled = self.gone = self.offline = self.repeated = 0
        self.went_back = 0
        self.wrong = []

    def start(self):
        self.server.start()
        self.road = TcpProxy(self.server.relay)
        self.robots.start(self.road.port)

    def wait_for_more(self, messages):
        before = self.robots.count()
        wait_until(
            self.robots.process, lambda: self.robots.count() >= before + messages, RECOVERY_SECONDS,
            f"acks of {messages} messages more ({self.server.text()[-800:]})",
        )  # fmt: skip

    def fail_over(self):
        """Kills the primary a random while after its standby got the last of it, and promotes that."""
        self.pair.hold_back()
        self.wait_for_more(self.random.randrange(1, 400))
        kills_robots = self.random.random() < 2 / 3
        if kills_robots:
            # Frames that are on their way are committed, and their acks get lost.
            self.road.cut(Cut.BLACK_HOLE)
            self.wait_a_moment(0.1)
            self.robots.kill()
            self.road.drop()
            self.road.mend()
        self.pair.kill()
        self.server.wait_for_status(lambda s: "store" in s["degraded"], RECOVERY_SECONDS, "the primary is away")
        if not kills_robots:
            self.wait_until_robots_have_read()
        self.before = dict(self.robots.acked())
        back_early = kills_robots and self.random.random() < 0.5
        if back_early:
            self.robots.start(self.road.port)
        self.pair.promote()
        if kills_robots and not back_early:
            self.robots.start(self.road.port)
        self.done += 1

    def wait_until_robots_have_read(self):
        """What they were acked before the primary died: while it is away nothing more is."""
        seen = [self.robots.count(), time.monotonic()]

        def quiet():
            if (now := self.robots.count()) != seen[0]:
                seen[:] = [now, time.monotonic()]
            return time.monotonic() - seen[1] > QUIET_SECONDS

        wait_until(self.robots.process, quiet, RECOVERY_SECONDS, "the robots are quiet")

    def wait_a_moment(self, most):
        until = time.monotonic() + self.random.random() * most
        wait_until(self.robots.process, lambda: time.monotonic() > until, RECOVERY_SECONDS, "a moment")

    def compare(self):
        acked = dict(self.robots.acked())
        stored = {robot: set() for robot in acked}
        for line in self.store.sql(ROWS).splitlines():
            robot, seq, times = map(int, line.split("|"))
            stored[robot].add(seq)
            self.doubled += times > 1
        self.acked = sum(acked.values())
        self.gone = 0
        for robot, through in acked.items():
            durable = {n for n in range(1, through + 1) if n % STEPS != LIVE_STEP}
            missing = durable - stored[robot]
            late = sorted(n for n in missing if n > self.before[robot])
            self.gone += len(missing) - len(late)
            self.lost += len(late)
            if late:
                self.wrong.append(f"robot {robot}: acked after failover {self.done} and not stored: {late[:8]}")
        gaps = self.store.sql("SELECT count(*) FROM uplinkd.gaps")
        if gaps != "0":
            self.wrong.append(f"{gaps} gaps")
        for line in self.store.sql(WRONG).splitlines():
            _, offline, repeated, _ = line.split("|")
            self.offline += int(offline)
            self.repeated += int(repeated)
            self.wrong.append(line)

    def round(self):
        self.wait_for_more(self.random.randrange(1, 200))
        self.fail_over()
        self.wait_for_more(4 * ROBOTS)
        self.compare()
        self.pair.rejoin()

    def clean(self):
        return self.lost == 0 and self.doubled == 0 and not self.wrong

    def canary_found(self):
        return self.lost > 0

    def line(self):
        return (f"failovers {self.done}, acked {self.acked}, gone with a primary {self.gone}, lost {self.lost},"
                f" doubled {self.doubled}, offline {self.offline}, repeated {self.repeated}")  # fmt: skip

    def recovery_lines(self):
        return [f"robots whose store went back: {self.went_back:.0f}"] if self.done else []

    def run(self, failovers, progress=None):
        """To the end, or to the first thing that is wrong."""
        self.start()
        while self.done < failovers and self.clean():
            self.round()
            self.went_back = self.server.metric("uplinkd_store_went_back_robots_total")
            if progress and self.done % (PROGRESS_EVERY // 10) == 0:
                print(self.line(), file=progress, flush=True)
        if self.clean():
            self.robots.kill()
            self.server.terminate(60)
            self.compare()
        return self.clean()

    def close(self):
        for process in (self.robots.process, self.server.process):
            if process is not None and process.poll() is None:
                process.kill()
                process.wait(30)
        if self.road is not None:
            self.road.close()
        self.pair.close()
