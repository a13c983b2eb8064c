"""What the crash campaigns with a broker (broker_chaos.py) and with drones (uncrew_chaos.py) share: rounds of
load and a kill, and a comparison after some of them, for which the load rests.

With a canary, a server that is wrong on purpose, they compare after each kill and go on until they find
something.
"""

import collections
import contextlib
import random
import threading
import time

import broker_stores
from harness import BIN, Server, wait_until
from tcp_proxy import Cut

COMPARE_EVERY = 25
# From a kill to the first message that is stored again, and to the end of all that waits.
RECOVERY_SECONDS = 120
# Waits that are made of a random part of these.
LOAD_SECONDS = 1.0
HALT_SECONDS = 0.05
# A kill after which the next one does not wait for the recovery.
HURRIED = 0.25


class Rounds:
    """Part of a campaign, which has of its own:

    settings(): of each server.
    load(): the process that lives all the time.
    start(): starts all of it.
    ways(): the proxies whose connections are killed.
    wait_for_recovery(kind): until something that is said from now on is stored.
    rest(): the load rests, and all that it said is settled. go_on(): it goes on.
    look(): compares, while nothing else has the store.
    line(): what it ends with. canary_found(): whether what was found is what was planted.
    """

    # Programs that are wrong on purpose, by name.
    canaries = {}
    # What of the store's kills is none of this campaign's.
    unused_kills = ()
    # What is killed where there is a canary.
    canary_kills = ("server", "connection")

    def __init__(self, folder, store, seed, canary):
        self.random = random.Random(seed)
        self.folder = folder
        self.canary = canary
        self.store = {"postgres": broker_stores.Postgres, "sqlite": broker_stores.Sqlite}[store](folder)
        self.kinds = {kind: share for kind, share in self.store.kills.items() if kind not in self.unused_kills}
        self.servers = [self.new_server(folder)]
        self.wrong = []
        self.done = 0
        self.kills = collections.Counter()
        self.acked = self.stored = 0
        # By kind of kill, from it on: seconds until what was killed is back, and until something that was
        # said then is stored.
        self.recoveries = collections.defaultdict(list)

    # The parts and their lives.

    def new_server(self, folder):
        return Server(folder, self.settings(), self.store.url)

    def start_server(self, server):
        """With SQLite alternately the program itself and the one that loses what is not synced."""
        programs = ["uplinkd"]
        if self.canary:
            programs = [self.canaries[self.canary]]
        elif isinstance(self.store, broker_stores.Sqlite):
            programs = ["uplinkd", "uplinkd_held"]
        server.program = BIN / programs[server.starts % len(programs)]
        server.environment = {"UPLINK_HELD_SEED": str(self.random.randrange(1 << 30))}
        server.start()

    def wait(self, condition, what, seconds=RECOVERY_SECONDS):
        """While the load lives."""
        try:
            return wait_until(self.load(), condition, seconds, what)
        except AssertionError as error:
            raise AssertionError(f"{error}\n{[server.text()[-1500:] for server in self.servers]}") from None

    def pause(self, seconds):
        """Any moment of the seconds to come."""
        threading.Event().wait(self.random.random() * seconds)

    def end(self, server):
        """In order."""
        if server.terminate(60) != 0:
            raise AssertionError(f"a server did not end in order: {server.text()[-500:]}")

    # Kills.

    def kill_server(self):
        self.servers[0].kill()
        self.start_server(self.servers[0])

    def kill_connection(self):
        """What is on its way, answers too, is lost."""
        way = self.random.choice(self.ways())
        way.cut(Cut.BLACK_HOLE)
        self.pause(HALT_SECONDS)
        way.drop()
        way.mend()

    def kill(self, kind):
        """False if there was nothing to kill."""
        match kind:
            case "server":
                self.kill_server()
            case "connection":
                self.kill_connection()
            case "cluster":
                self.store.cluster.crash()
            case "backend" | "backend crash":
                return self.store.kill_backend(kind == "backend crash")
            case _:
                raise AssertionError(kind)
        return True

    def draw(self):
        """What is killed next."""
        kinds = self.canary_kills if self.canary else list(self.kinds)
        return self.random.choices(kinds, [self.kinds[each] for each in kinds])[0]

    def round(self):
        self.pause(LOAD_SECONDS)
        kind = self.draw()
        began = time.monotonic()
        if not self.kill(kind):
            return
        self.done += 1
        self.kills[kind] += 1
        if self.canary:
            self.compare()
            self.go_on()
        elif self.random.random() >= HURRIED:
            back = time.monotonic()
            self.wait_for_recovery(kind)
            self.recoveries[kind].append((time.monotonic() - began, back - began))

    def compare(self):
        self.rest()
        with self.store_alone():
            self.look()

    @contextlib.contextmanager
    def store_alone(self):
        """No other process may read an SQLite store that uplinkd_held serves: part of it is in memory."""
        if isinstance(self.store, broker_stores.Postgres):
            yield
            return
        self.servers[0].kill()
        yield
        self.start_server(self.servers[0])

    # The end.

    def clean(self):
        return not self.wrong

    def recovery_lines(self):
        """By kind of kill how long it took until something behind it was stored."""
        lines = []
        for kind, kills in sorted(self.kills.items()):
            line = f"{kind}: kills {kills}"
            if each := sorted(self.recoveries[kind]):
                (median, back), (most, most_back) = each[len(each) // 2], each[-1]
                line += f", recovery median {median:.1f} s ({back:.1f} s until it was back)"
                line += f", most {most:.1f} s ({most_back:.1f} s)"
            lines.append(line)
        return lines

    def run(self, kills, progress=None):
        """To the end, or to the first thing that is wrong."""
        self.start()
        compared = 0
        while self.done < kills and self.clean():
            self.round()
            if self.done < compared + COMPARE_EVERY:
                continue
            compared = self.done
            self.compare()
            self.go_on()
            if progress:
                print(self.line(), file=progress, flush=True)
        if self.clean():
            self.finish()
        return self.clean()

    def finish(self):
        self.compare()
        for server in self.servers:
            self.end(server)

    def close(self):
        for server in self.servers:
            server.close()
        for way in self.ways():
            way.close()
        self.store.close()
