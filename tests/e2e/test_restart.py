"""What a restart of the server leaves as it was, though no robot has come back yet.

The last number of some robots is that of a live message, which leaves no row of its own.
"""

import unittest
import urllib.parse

from chaos import ROBOTS, Campaign
from chaos_stores import Sqlite
from harness import Cluster, EndToEnd, Server, wait_until

ROUND_SECONDS = 60
ACKS = 200


class Restart(EndToEnd):
    def sessions(self, server):
        """Session and settled number of each robot, once all are known."""

        def look():
            robots = (server.get(f"/api/v1/robots?pageSize={ROBOTS}") or {"robots": []})["robots"]
            return robots if len(robots) == ROBOTS else None

        robots = wait_until(server.process, look, ROUND_SECONDS, "all robots are known")
        return {robot["ruri"]: (robot["sessionId"], int(robot["settledSeq"])) for robot in robots}

    def checkpointed(self, store):
        """The sum of all robots' settled numbers as of their checkpoints."""
        if isinstance(store, Sqlite):
            return store.read("SELECT sum(settled_seq) FROM live")[0][0]
        return int(store.sql("SELECT sum(settled_seq) FROM uplinkd.live"))

    def work(self, campaign):
        """The robots go away after a while, and all that they sent is settled; what is shown then."""
        campaign.server.wait_for_status(
            lambda status: int(status["streams"]) == ROBOTS, ROUND_SECONDS, "all robots stream"
        )
        wait_until(
            campaign.server.process,
            lambda: all(settled for _, settled in self.sessions(campaign.server).values()),
            ROUND_SECONDS,
            "something of each robot is settled",
        )
        campaign.wait_for_more(ACKS)
        campaign.robots.kill()
        campaign.server.wait_for_status(
            lambda status: status["streams"] == "0" and status["uplinks"]["inFlight"] == "0",
            ROUND_SECONDS,
            "nothing waits",
        )
        return self.sessions(campaign.server)

    def compare(self, campaign, before, restarts):
        campaign.server.start()
        after = self.sessions(campaign.server)
        for ruri, (session, settled) in before.items():
            self.assertRegex(session, "^[0-9a-f]{32}$", ruri)
            self.assertGreater(settled, 0, ruri)
            self.assertEqual(after[ruri], (session, settled), f"{ruri} after a restart {restarts}")

    def restart_on(self, store):
        campaign = Campaign(self.folder, store, 5)
        self.open_things.append(campaign)
        campaign.start()
        before = self.work(campaign)
        self.assertEqual(campaign.server.terminate(ROUND_SECONDS), 0)
        self.compare(campaign, before, "in order")

        campaign.robots.start(campaign.server.relay.rsplit(":", 1)[1])
        before = self.work(campaign)
        wait_until(
            campaign.server.process,
            lambda: self.checkpointed(campaign.store) == sum(settled for _, settled in before.values()),
            ROUND_SECONDS,
            "a checkpoint holds it all",
        )
        campaign.server.kill()
        self.compare(campaign, before, "by a kill")

    def test_sessions_on_sqlite_are_shown_as_they_were(self):
        self.restart_on("sqlite")

    def test_sessions_on_postgres_are_shown_as_they_were(self):
        self.restart_on("postgres")


class Presence(EndToEnd):
    """Robots: one half went offline before the restart, and the other half was online."""

    ROBOTS = 3
    SETTINGS = """[presence]
timeout = "5s"
startup_grace = "10m"
"""

    def shown(self, server):
        return {robot["ruri"]: robot for robot in (server.get("/api/v1/robots") or {}).get("robots", [])}

    def history(self, server, ruri):
        name = urllib.parse.quote(ruri, safe="")
        return [change["presence"] for change in reversed(server.get(f"/api/v1/presence?ruri={name}")["presenceChanges"])]

    def fleet_of(self, server, number):
        return self.fleet(server, "--robots", self.ROBOTS, "--ruri-prefix", f"rcan://restart/{number}", "--rate", 5)

    def wait_for(self, server, presence, number):
        """The robots of this fleet, once all are so."""

        def look():
            found = {ruri: robot for ruri, robot in self.shown(server).items() if f"restart/{number}" in ruri}
            all_are = all(robot["presence"] == presence for robot in found.values())
            return found if len(found) == self.ROBOTS and all_are else None

        return wait_until(server.process, look, ROUND_SECONDS, f"fleet {number} is {presence}")

    def restart(self, server):
        server.start()
        fleet = self.fleet_of(server, 1)
        self.wait_for(server, "online", 1)
        fleet.close()
        gone = self.wait_for(server, "offline", 1)
        fleet = self.fleet_of(server, 2)
        before = {ruri: ["online", "offline"] for ruri in gone}
        for end in (server.kill, lambda: self.assertEqual(server.terminate(ROUND_SECONDS), 0)):
            online = self.wait_for(server, "online", 2)
            wait_until(
                server.process,
                lambda now=online: all(self.history(server, ruri)[-1:] == ["online"] for ruri in now),
                ROUND_SECONDS,
                "the store has it",
            )
            fleet.close()
            end()
            server.start()
            server.wait_for_status(
                lambda status: all(
                    int(status["robots"][presence]) == self.ROBOTS for presence in ("unknown", "offline")
                ),
                ROUND_SECONDS,
                "it judges them, and one half is unknown",
            )
            for ruri, robot in self.wait_for(server, "offline", 1).items():
                self.assertEqual(robot["presenceSince"], gone[ruri]["presenceSince"], ruri)
            self.assertEqual({ruri: self.history(server, ruri) for ruri in gone}, before, "no row is added")
            self.wait_for(server, "unknown", 2)
            fleet = self.fleet_of(server, 2)
        fleet.close()
        self.fleet_of(server, 1)
        self.wait_for(server, "online", 1)

    def test_who_was_offline_stays_so_on_sqlite(self):
        self.restart(self.server(self.SETTINGS))

    def test_who_was_offline_stays_so_on_postgres(self):
        cluster = Cluster(self.folder).create().migrate()
        self.open_things.append(cluster)
        server = Server(self.folder, self.SETTINGS, cluster.url("uplinkd"))
        self.open_things.append(server)
        self.restart(server)


if __name__ == "__main__":
    unittest.main()
