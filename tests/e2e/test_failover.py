"""A primary that dies under load, with a standby that acks wait for, or with one that lags."""

import functools
import json
import time
import unittest

import broker_stores
from broker_reading import Reading
from broker_script import ruri_of, uuid_of
from chaos import ROBOTS, Campaign
from chaos_stores import Postgres
from failovers import CANARY, FailoverCampaign, Pair
from harness import EndToEnd, Fleet, Server, Standby, wait_until
from mqtt_client import Client
from presence import OFFLINE, ONLINE, problems_of, stored_histories
from tcp_proxy import TcpProxy
from two_servers import A, B


# The standby has all that the primary wrote.
REPLAYED = "SELECT bool_and(replay_lsn >= pg_current_wal_lsn()) FROM pg_stat_replication"


class Failover(EndToEnd):
    def test_with_a_synchronous_standby_nothing_that_was_acked_is_lost(self):
        campaign = Campaign(self.folder, "postgres", 1)
        self.open_things.append(campaign)
        primary = campaign.store.cluster
        standby = Standby(self.folder, primary)
        self.open_things.append(standby)
        primary.sql("ALTER SYSTEM SET synchronous_standby_names = 'standby'", "postgres")
        primary.sql("SELECT pg_reload_conf()", "postgres")
        places = [primary.place, standby.place]
        campaign.server.store_url = "postgresql://uplinkd@/uplinkd?" + "&".join(
            f"{key}=" + ",".join(place[name] for place in places)
            for key, name in (("host", "folder"), ("port", "port"))
        )
        campaign.start()
        campaign.wait_for_more(500)
        state = "SELECT sync_state FROM pg_stat_replication WHERE application_name = 'standby'"
        self.assertEqual(primary.sql(state, "postgres"), "sync")

        primary.halt()
        campaign.server.wait_for_status(lambda s: "store" in s["degraded"], 60, "the primary is away")
        acked = dict(campaign.robots.acked())
        self.assertEqual(int(campaign.server.get("/api/v1/status")["streams"]), ROBOTS, "robots stay connected")
        # The standby alone takes no writes: acks wait until somebody promotes it.
        standby.promote()
        campaign.store.cluster = standby
        campaign.wait_for_more(500)
        wait_until(
            campaign.server.process,
            lambda: "store" not in (campaign.server.get("/api/v1/status") or {"degraded": ["store"]})["degraded"],
            60,
            "the standby serves",
        )
        self.assertGreater(sum(campaign.robots.acked().values()), sum(acked.values()))
        campaign.compare()
        self.assertTrue(campaign.clean(), "\n".join([campaign.line(), *campaign.wrong]))
        self.assertEqual(campaign.server.metric("uplinkd_store_went_back_robots_total"), 0)
        self.assertNotIn("store_went_back", campaign.server.text(), "nothing was missing")

    def campaign_of_failovers(self, failovers, canary=None):
        campaign = FailoverCampaign(self.folder, 3, canary)
        self.open_things.append(campaign)
        campaign.run(failovers)
        return campaign

    def test_what_robots_still_hold_is_stored_after_a_failover_to_a_standby_that_lags(self):
        campaign = self.campaign_of_failovers(3)
        self.assertTrue(campaign.clean(), "\n".join([campaign.line(), *campaign.wrong]))
        self.assertGreater(campaign.gone, 0, "the standby lagged")
        self.assertGreater(campaign.went_back, 0)
        campaign.server.wait_for_line("store_went_back")

    def test_a_server_that_trusts_what_it_told_before_is_found(self):
        campaign = self.campaign_of_failovers(20, CANARY)
        self.assertTrue(campaign.canary_found(), "\n".join([campaign.line(), *campaign.wrong]))


class Muted(TcpProxy):
    """The server's way to its broker; while it is mute, nothing that the server says arrives."""

    mute = False

    def _take(self, ends, source, data):
        return b"" if self.mute and source is ends[0] else data


class TwinsFailover(Reading):
    TWINS = range(5)
    HELD = 20

    def lose_what_the_broker_still_holds(self):
        """The primary has HELD messages that no PUBACK reached the broker for, and dies; its standby lacks them."""
        self.store = self.keep(broker_stores.Postgres(self.folder))
        self.pair = self.keep(Pair(self.folder, self.store))
        self.store.url = self.pair.url
        self.start_broker()
        self.way = self.keep(Muted(f"127.0.0.1:{self.broker.port}"))
        self.serve(way=self.way.address)
        twins = self.twins()
        twins.tell(twins.next_keys(self.TWINS, 1))
        self.wait(lambda: self.settled("stored") == len(self.TWINS), "the first are stored")
        self.pair.hold_back()
        self.way.mute = True
        twins.tell(twins.next_keys(self.TWINS, self.HELD // len(self.TWINS)))
        self.wait(lambda: self.settled("stored") == len(self.TWINS) + self.HELD, "the lost primary has them")
        self.pair.kill()
        self.wait(lambda: "store" in self.degraded(), "the primary is away")

    def come_again(self):
        """The broker delivers what it holds by a new connection."""
        self.way.mute = False
        self.way.drop()

    def assert_all_is_stored(self):
        self.wait_until_all_is_stored()
        # Since the store went back the server connects to the broker anew. The last message may be stored
        # before that, and what is delivered again after it.
        self.wait(lambda: set(self.book.published) <= set(self.rows()), "nothing was acked from memory, and lost")
        self.assert_stored_once()
        self.wait(lambda: "store_went_back" in self.degraded(), "that is shown")
        for twin in self.TWINS:
            self.assertNotIn(OFFLINE, self.watch.seen(twin))

    def test_what_a_broker_delivers_again_is_stored_after_a_failover_to_a_standby_that_lags(self):
        self.lose_what_the_broker_still_holds()
        self.pair.promote()
        self.assertEqual(len(self.rows()), len(self.TWINS), "the standby lagged")
        self.come_again()
        self.assert_all_is_stored()

    def test_what_a_broker_delivers_again_before_the_failover_gets_no_ack_from_memory(self):
        self.lose_what_the_broker_still_holds()
        self.come_again()
        dups = functools.partial(self.mqtt, "dups_total", connection="durable")
        self.wait(lambda: dups() >= self.HELD, "all of it has come again")
        self.pair.promote()
        # How many rows the standby had cannot be counted: what came again is stored at once. That it
        # lagged, store_went_back says.
        self.assert_all_is_stored()

    def tell_errors(self, twin, errors):
        """Metrics at QoS 1, whose numbers never came before."""
        self.said += 1
        metrics = {"source_type": "edge", "metrics": {"errors": errors, "load": {"cpu": self.said}}}
        self.publisher.publish(f"cyberwave/twin/{uuid_of(twin)}/metrics", json.dumps(metrics), qos=1)
        self.publisher.flush()

    def active(self, cluster=None):
        """The faults of twins that the primary has, or another cluster."""
        rows = (cluster or self.pair.primary).sql("SELECT ruri, fault_id FROM uplinkd.faults_active").splitlines()
        return sorted(tuple(row.split("|")) for row in rows)

    def test_metrics_that_change_no_fault_get_no_ack_from_memory(self):
        hot, cold = (ruri_of(1), "hot"), (ruri_of(2), "cold")
        self.store = self.keep(broker_stores.Postgres(self.folder))
        self.pair = self.keep(Pair(self.folder, self.store))
        self.store.url = self.pair.url
        self.start_broker()
        self.serve()
        self.publisher = self.keep(Client(self.broker.port, "metrics"))
        self.said = 0
        self.tell_errors(2, ["cold"])
        self.wait(lambda: self.active() == [cold], "the first fault is stored")
        self.pair.wait(lambda: self.pair.primary.sql(REPLAYED, "postgres") == "t", "the standby has it")
        self.pair.hold_back()
        self.tell_errors(1, ["hot"])
        self.tell_errors(2, [])
        self.wait(lambda: self.active() == [hot], "the lost primary has that")
        self.pair.kill()
        self.tell_errors(1, ["hot"])
        self.tell_errors(2, [])
        self.wait(lambda: self.settled("applied") == 2, "they change no fault")
        self.assertEqual(self.mqtt("unacked", connection="durable"), 2, "acked from memory")
        self.assertEqual(self.active(self.pair.standby), [cold], "the standby lags")
        self.pair.promote()
        self.wait(lambda: self.active() == [hot], "the faults are what the twins said last")
        self.wait(lambda: self.mqtt("unacked", connection="durable") == 0, "they are acked")
        self.assertEqual(self.watch.breaches, [])


class Hang(EndToEnd):
    """Two servers on a primary that hangs, and on the standby that takes over from it."""

    SETTINGS = 'checkpoint = "1s"\n[presence]\nstartup_grace = "5s"\n'
    # Longer than presence.timeout and a lease's lateness together.
    SECONDS = 25

    def start(self):
        self.pair = Pair(self.folder, Postgres(self.folder))
        self.open_things.append(self.pair)
        self.servers = []
        for name in "AB":
            folder = self.folder / name
            folder.mkdir()
            if self.servers:
                (folder / "pki").symlink_to(self.folder / "A/pki")
            self.servers.append(Server(folder, self.SETTINGS, self.pair.url))
            self.open_things.append(self.servers[-1])
            self.servers[-1].start()
        self.road = TcpProxy(*(server.relay for server in self.servers))
        self.open_things.append(self.road)
        self.open_things.append(Fleet(self.servers[A], "--robots", 1, "--seed", 3, target=self.road.address))

    def shown(self, place):
        """Of the robot, by this server: its presence and whether another holds it."""
        robots = (self.servers[place].get("/api/v1/robots") or {}).get("robots", [])
        return [(robot["presence"], bool(robot["heldBy"])) for robot in robots]

    def wait_for(self, condition, what):
        wait_until(self.servers[A].process, condition, 60, what)

    def watch(self, seconds):
        """For so long no server calls the robot offline: it streams."""
        end = time.monotonic() + seconds

        def look():
            for place in (A, B):
                self.assertNotIn(OFFLINE, [presence for presence, _ in self.shown(place)], "AB"[place])
            return time.monotonic() > end

        self.wait_for(look, "the time passes")

    def test_a_robot_that_moved_just_before_is_offline_nowhere(self):
        self.start()
        self.wait_for(lambda: self.shown(B) == [(ONLINE, True)], "A holds it, and B says so")
        self.pair.wait(lambda: self.pair.primary.sql(REPLAYED, "postgres") == "t", "the standby has that")
        self.pair.hold_back()
        self.road.choose(B)
        self.road.drop(A)
        self.wait_for(lambda: self.shown(B) == [(ONLINE, False)], "it moved to B, which only the primary has")
        self.pair.hang()
        self.watch(self.SECONDS)
        self.pair.kill()
        self.pair.promote()
        self.wait_for(lambda: self.shown(A) == [(ONLINE, True)], "A learns from the new primary who holds it")
        self.watch(12)
        (rows,) = stored_histories(self.pair.primary).values()
        self.assertEqual(problems_of(rows, 1), [], rows)


if __name__ == "__main__":
    unittest.main()
