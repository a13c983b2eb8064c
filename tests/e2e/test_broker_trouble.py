"""A server and its broker in trouble: no room, no store, small windows, a way that swallows everything, a
broker that forgets or refuses. What the broker acked to publishers is stored once, and no robot is called
offline while it could not be heard."""

import contextlib
import json
import pathlib
import re
import subprocess
import time
import unittest
import urllib.request

import broker_stores
from broker_reading import DEADLINE_SECONDS, PRESENCE_TIMEOUT_SECONDS, Reading
from broker_script import ruri_of
from mqtt_client import Client
from presence import ONLINE, UNKNOWN
from tcp_proxy import Cut, TcpProxy

# Twins: one that goes on saying where it is, one that says it once, some that speak at QoS 1, and one at
# QoS 0.
LIVE, QUIET, LOSSY = 0, 1, 2
DURABLE = range(3, 8)
ALL = range(8)
SILENT = range(1, 8)
SPEAKING = [LIVE, *DURABLE]


class NoRoom(Reading):
    """The store is held back until the journal is full."""

    # Those that are in the journal before it is full.
    FIRST = 2 * len(DURABLE)
    LOSSY_MESSAGES = 300
    EACH = 100

    def begin(self, journal):
        # One twin alone may fill it at QoS 0, which its share keeps it from otherwise.
        self.store_settings = f"[journal]\nrobot_share = 1\n{journal}"
        self.serve()
        twins = self.twins()
        self.wait_for_presence(ALL, ONLINE, lambda: twins.pose(ALL, 1))
        return twins

    def fill(self, twins):
        """Until some at QoS 1 wait for their commit, messages at QoS 0 are refused, and a further one at
        QoS 1 is held; gives how many were refused."""
        twins.tell(twins.next_keys(DURABLE, 2))
        self.wait(lambda: self.mqtt("messages_in_flight") == self.FIRST, "the first at QoS 1 are in the journal")
        twins.tell_unacked(twins.next_keys([LOSSY], self.LOSSY_MESSAGES))
        self.wait(lambda: self.mqtt("publishes_total", connection="durable", qos="0") == self.LOSSY_MESSAGES,
                  "all at QoS 0 came")  # fmt: skip
        refused = self.settled("refused")
        self.assertGreater(refused, 0)
        # Of the rest nothing can be stored: it waits.
        self.assertEqual(self.settled("stored"), 0)
        self.assertEqual(self.mqtt("messages_in_flight"), self.FIRST + self.LOSSY_MESSAGES - refused)
        twins.tell(twins.next_keys(DURABLE, self.EACH))
        self.wait(lambda: self.mqtt("message_held_back") == 1, "a message at QoS 1 is held back")
        self.assertEqual(self.mqtt("unacked", connection="durable"), self.FIRST + 1)
        self.assertEqual(self.mqtt("pubacks_total", connection="durable"), 0)
        return refused

    def assert_pong(self):
        pinger = self.keep(Client(self.broker.port, "pinger", "cyberwave/pong/here/response"))
        pinger.publish("cyberwave/ping/here/request", json.dumps({"type": "ping"}))
        pinger.wait(lambda: pinger.heard, "the pong")
        self.assertEqual(json.loads(pinger.heard[0].payload)["type"], "pong")

    def go_through_a_full_journal(self, journal):
        twins = self.begin(journal)
        with self.sqlite_held():
            refused = self.fill(twins)
            self.assertEqual(self.mqtt("reading_stopped", connection="durable", why="journal"), 1)
            self.wait_for_presence(ALL, ONLINE, lambda: twins.pose(ALL, 2))
            self.watch.begin()
            twins.pose([LIVE], 42)
            self.wait(lambda: self.x(LIVE) == 42, "live state goes on")
            self.assert_pong()
            self.wait_for_presence(SILENT, UNKNOWN, lambda: twins.pose([LIVE], 43))
            self.wait(lambda: "mqtt_unread" in self.degraded(), "the server says that it does not read")
            self.stay(PRESENCE_TIMEOUT_SECONDS, lambda: twins.pose([LIVE], 44))
            self.assert_never_offline(ALL)
            self.assertEqual(self.watch.seen(LIVE), {ONLINE})
            # Still none of them is acked to the broker, or lost.
            self.assertEqual(self.mqtt("pubacks_total", connection="durable"), 0)
            self.assertEqual(self.settled("refused"), refused)
        self.wait_until_all_is_stored()
        self.assert_stored_once()
        self.assertEqual(self.settled("refused"), refused)
        stored = sum(twin == LOSSY for twin, _, _ in self.rows())
        self.assertEqual(stored, self.LOSSY_MESSAGES - refused, "all at QoS 0 that was not refused")
        self.assertEqual(self.mqtt("message_held_back"), 0)
        self.assert_offline_at_last(ALL)
        self.assertNotIn("mqtt_unread", self.degraded())

    def test_a_journal_that_is_full_of_records_loses_nothing_at_qos_1(self):
        self.go_through_a_full_journal("records_max = 40\nbatch_records_max = 40")

    def test_a_journal_that_is_full_of_bytes_loses_nothing_at_qos_1(self):
        self.go_through_a_full_journal('bytes_max = "8KiB"')

    def test_a_kill_while_the_journal_is_full_loses_nothing_at_qos_1(self):
        twins = self.begin("records_max = 40\nbatch_records_max = 40")
        with self.sqlite_held():
            self.fill(twins)
            self.running.kill()
        self.running.start()
        self.wait_until_subscribed()
        self.wait_until_all_is_stored()
        self.assert_stored_once()


class StoreAway(Reading):
    """PostgreSQL is not there, for longer than a server's lease and every timeout."""

    WINDOW = 1024
    AWAY_SECONDS = 60
    # Longer than the store's timeout and the lease: another server takes one for silent after 30 s.
    HOLE_SECONDS = 33

    def begin(self, by_way=False):
        self.store = self.keep(broker_stores.Postgres(self.folder))
        if by_way:
            self.way = self.keep(TcpProxy(f"127.0.0.1:{self.store.cluster.place['port']}"))
            password = self.folder / "store.password"
            password.write_text("uplinkd\n", encoding="utf-8")
            self.store.url = f"postgresql://uplinkd@127.0.0.1:{self.way.port}/uplinkd?sslmode=disable"
            self.store_settings = f'password_file = "{password}"\n'
        self.store_settings += 'timeout = "2s"'
        self.serve()
        talk = self.talk(DURABLE, [LIVE], each=3)
        quiet = self.twins("quiet")
        # Its last words are heard just before the trouble.
        self.wait_for_presence([*SPEAKING, QUIET], ONLINE, lambda: quiet.pose([QUIET], 1))
        self.watch.begin()
        return talk

    def go_through(self, seconds):
        """So long, from now on."""
        end = time.monotonic() + seconds
        self.wait(lambda: "store" in self.degraded(), "the store is known to be away")
        self.wait(lambda: self.mqtt("unacked", connection="durable") >= self.WINDOW, "the window is full")
        self.stay(end - time.monotonic(), lambda: self.assert_never_offline([*SPEAKING, QUIET]))
        # It says where it is, and that is heard all the time; of the others nothing is read.
        self.assertEqual(self.watch.seen(LIVE), {ONLINE})
        self.assertIn(UNKNOWN, self.watch.seen(QUIET))
        self.acked_meanwhile = self.book.acks()

    def end(self, talk):
        self.wait_for_presence(SPEAKING, ONLINE)
        self.assert_never_offline(SPEAKING)
        talk.end()
        self.assertGreater(self.book.acks(), self.acked_meanwhile, "the twins went on speaking")
        self.wait_until_all_is_stored()
        self.assert_stored_once()
        self.assert_offline_at_last(SPEAKING)

    def test_a_store_that_is_dead_for_a_minute_loses_and_doubles_nothing(self):
        talk = self.begin()
        self.store.cluster.halt()
        self.go_through(self.AWAY_SECONDS)
        # It starts what was halted.
        self.store.cluster.crash()
        self.end(talk)

    def test_a_store_that_does_not_answer_loses_and_doubles_nothing(self):
        talk = self.begin(by_way=True)
        # What was being committed may be committed without an answer.
        self.way.cut(Cut.BLACK_HOLE)
        self.go_through(self.HOLE_SECONDS)
        self.way.drop()
        self.way.mend()
        self.end(talk)


class StuckShard(Reading):
    """Somebody holds what one of the connections that write needs, and the others go on."""

    # The session of a robot that has one: its next commit writes there.
    HOLD = "BEGIN; SELECT FROM uplinkd.sessions WHERE ruri = '{ruri}' FOR UPDATE; SELECT pg_sleep(3600)"
    EACH = 10
    # Longer than it takes where no commit is stuck.
    OLD_SECONDS = 2

    @contextlib.contextmanager
    def held(self, twin):
        """Until the end a commit for that twin waits."""
        url = self.store.cluster.url("postgres")
        holder = subprocess.Popen(
            ["psql", "-X", "-q", "-c", self.HOLD.format(ruri=ruri_of(twin)), url],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        asleep = "SELECT count(*) FROM pg_stat_activity WHERE wait_event = 'PgSleep'"
        try:
            self.wait(lambda: self.store.cluster.sql(asleep) == "1", "somebody holds the row")
            yield
        finally:
            self.store.cluster.sql("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE wait_event = 'PgSleep'")
            holder.wait(DEADLINE_SECONDS)

    def old_shards(self):
        """How many shards have a record that waits for long."""
        with urllib.request.urlopen(f"http://{self.running.http}/metrics", timeout=10) as page:
            ages = re.findall(r"^uplinkd_journal_shard_oldest_seconds\{.*\} (.*)$", page.read().decode(), re.MULTILINE)
        self.assertGreater(len(ages), 1)
        return sum(float(age) > self.OLD_SECONDS for age in ages)

    def test_every_ack_waits_for_it_and_it_is_shown(self):
        self.store = self.keep(broker_stores.Postgres(self.folder))
        self.serve()
        twins = self.twins()
        twins.tell(twins.next_keys([LIVE, *DURABLE], 1))
        self.wait_until_all_is_stored()
        acked = self.mqtt("pubacks_total", connection="durable")
        with self.held(LIVE):
            twins.tell(twins.next_keys([LIVE], 1))
            others = twins.next_keys(DURABLE, self.EACH)
            twins.tell(others)
            self.wait(lambda: self.mqtt("unacked", connection="durable") == 1 + len(others), "all came")
            self.wait(lambda: set(others) & set(self.rows()), "what other shards write is stored")
            self.wait(lambda: self.old_shards() == 1, "the shard is shown")
            twins.pose([QUIET], 5)
            self.wait(lambda: self.x(QUIET) == 5, "live state goes on")
            self.assertEqual(self.mqtt("pubacks_total", connection="durable"), acked, "one waits, and all behind it")
        self.wait_until_all_is_stored()
        self.wait(lambda: self.mqtt("unacked", connection="durable") == 0, "all are acked")
        self.assert_stored_once()


class Windows(Reading):
    """Small ones, each with a backlog, messages that come meanwhile, and a kill while the window is full."""

    EACH = 100

    def go_through_a_window(self, version, window):
        self.serve(f'version = "{version}"\nunacked_max = {window}')
        self.assertEqual(self.mqtt("unacked_limit"), window)
        twins = self.twins()
        twins.tell(twins.next_keys(DURABLE, 1))
        self.assertEqual(self.running.terminate(60), 0)
        twins.tell(twins.next_keys(DURABLE, self.EACH))
        self.running.start()
        self.wait(lambda: self.settled("stored") > 0, "the backlog comes")
        with self.sqlite_held():
            twins.tell(twins.next_keys(DURABLE, self.EACH))
            unacked = set()

            def full():
                unacked.add(self.mqtt("unacked", connection="durable"))
                return window in unacked

            self.wait(full, "the window is full")
            self.stay(1, full)
            self.assertEqual(max(unacked), window)
            self.running.kill()
        self.running.start()
        twins.tell(twins.next_keys(DURABLE, self.EACH))
        self.wait_until_all_is_stored()
        self.assertGreaterEqual(self.mqtt("dups_total", connection="durable"), window)
        self.assert_stored_once()
        self.assertEqual(len(self.rows()), (3 * self.EACH + 1) * len(DURABLE) + 1)

    def test_one_at_a_time_by_mqtt_5(self):
        self.go_through_a_window("5", 1)

    def test_one_at_a_time_by_mqtt_3_1_1(self):
        self.go_through_a_window("3.1.1", 1)

    def test_twenty_at_a_time_by_mqtt_5(self):
        self.go_through_a_window("5", 20)

    def test_twenty_at_a_time_by_mqtt_3_1_1(self):
        self.go_through_a_window("3.1.1", 20)


class Hole(Reading):
    """The way to the broker stands, and not a byte passes."""

    HOLE_SECONDS = PRESENCE_TIMEOUT_SECONDS

    def go_through_a_hole(self, version):
        self.start_broker()
        way = self.keep(TcpProxy(f"127.0.0.1:{self.broker.port}"))
        self.serve(f'version = "{version}"', way=way.address)
        talk = self.talk(DURABLE, [LIVE])
        self.wait_for_presence(SPEAKING, ONLINE)
        self.watch.begin()
        way.cut(Cut.BLACK_HOLE)
        self.wait(lambda: "mqtt_away" in self.degraded(), "it is known that the broker is not heard")
        self.wait_for_presence(SPEAKING, UNKNOWN)
        self.stay(self.HOLE_SECONDS, lambda: self.assert_never_offline(SPEAKING))
        acked = self.book.acks()
        way.mend()
        self.wait_until_subscribed()
        self.wait_for_presence(SPEAKING, ONLINE)
        self.assert_never_offline(SPEAKING)
        self.assertNotIn("mqtt_session_lost", self.degraded())
        talk.end()
        self.assertGreater(self.book.acks(), acked, "the twins went on speaking")
        self.wait_until_all_is_stored()
        self.assert_stored_once()
        self.assert_offline_at_last(SPEAKING)

    def test_twins_behind_a_black_hole_are_unknown_by_mqtt_5(self):
        self.go_through_a_hole("5")

    def test_twins_behind_a_black_hole_are_unknown_by_mqtt_3_1_1(self):
        self.go_through_a_hole("3.1.1")


class Forgotten(Reading):
    """The broker restarts, and has forgotten every session."""

    def go_through(self, version):
        self.serve(f'version = "{version}"')
        self.assertEqual(self.mqtt("sessions_lost_total"), 0)
        twins = self.twins()
        again = twins.next_keys([LIVE], 2)
        twins.tell(again)
        self.wait_until_all_is_stored()
        twins.close()
        self.broker.restart_without_memory()
        self.wait(lambda: "mqtt_session_lost" in self.degraded(), "the lost session is shown")
        self.wait_until_subscribed()
        self.assertEqual(self.mqtt("sessions_lost_total"), 1)
        return again

    def go_on_with_a_new_session(self, version):
        again = self.go_through(version)
        twins = self.twins()
        # Packet ids begin anew. The first message makes sure that the loss is committed.
        first = twins.next_keys([QUIET], 1)
        twins.tell(first)
        self.wait(lambda: first[0] in self.rows(), "the new session's first message is stored")
        with self.sqlite_held():
            # What comes a second time under the same packet id with the same content is a new message.
            twins.tell(again[1:])
            self.wait(lambda: self.mqtt("unacked", connection="durable") == 1, "it came")
            self.running.kill()
        self.running.start()
        self.wait_until_subscribed()
        twins.tell(twins.next_keys(DURABLE, 20))
        self.wait_until_all_is_stored()
        self.assertGreaterEqual(self.mqtt("dups_total", connection="durable"), 1)
        self.assert_stored_once()
        self.assertEqual(self.rows().count(again[1]), 2, "it was said in both sessions")

    def test_what_is_said_in_the_new_session_is_stored_by_mqtt_5(self):
        self.go_on_with_a_new_session("5")

    def test_what_is_said_in_the_new_session_is_stored_by_mqtt_3_1_1(self):
        self.go_on_with_a_new_session("3.1.1")


def security_plugin():
    """Of mosquitto's own package: its files of rules refuse no filter, this does."""
    found = list(pathlib.Path("/usr/lib").glob("*/mosquitto_dynamic_security.so"))
    if not found:
        raise AssertionError("install mosquitto (tools/dev/packages.txt)")
    return found[0]


class Filters(Reading):
    """The broker does not serve the filters as they were asked for."""

    REFUSED = "cyberwave/twin/+/driverlog"

    def write_rules(self, path, *refused):
        acls = [{"acltype": "subscribeLiteral", "topic": topic, "priority": 1, "allow": False} for topic in refused]
        acls.append({"acltype": "subscribePattern", "topic": "#", "priority": 0, "allow": True})
        access = {"publishClientSend": True, "publishClientReceive": True, "subscribe": False, "unsubscribe": True}
        rules = {
            "defaultACLAccess": access,
            "groups": [{"groupname": "all", "roles": [{"rolename": "some"}]}],
            "anonymousGroup": "all",
            "roles": [{"rolename": "some", "acls": acls}],
        }
        path.write_text(json.dumps(rules), encoding="utf-8")

    def log_lines(self):
        return int(self.store.read("SELECT count(*) FROM messages")[0][0])

    def tell_a_log_line(self, number):
        topic = f"cyberwave/twin/00000000-0000-4000-8000-{LIVE:012}/driverlog"
        twins = self.twins("logger")
        twins.client.publish(topic, json.dumps({"message": f"line {number}", "level": "info"}), qos=1)
        twins.client.flush()
        twins.close()

    def test_a_refused_filter_is_shown_until_it_is_served(self):
        rules = self.folder / "rules.json"
        self.write_rules(rules, self.REFUSED)
        self.start_broker(f"plugin {security_plugin()}\nplugin_opt_config_file {rules}\n")
        self.serve()
        self.wait(lambda: "mqtt_filters" in self.degraded(), "it is shown")
        self.assertEqual(self.mqtt("filters_refused", connection="durable"), 1)
        self.assertEqual(self.connection()["filtersRefused"], "1")
        self.running.wait_for_line(self.REFUSED)
        self.assertIn(self.REFUSED, self.connection()["lastError"])
        # The others are served.
        self.tell_a_log_line(1)
        twins = self.twins()
        twins.tell(twins.next_keys([LIVE, *DURABLE], 10))
        self.wait_until_all_is_stored()
        self.assertEqual(self.log_lines(), 0)
        twins.close()
        self.broker.stop()
        self.write_rules(rules)
        self.broker.start()
        self.wait(lambda: "mqtt_away" not in self.degraded(), "it is connected again")
        self.wait_until_subscribed()
        self.wait(lambda: "mqtt_filters" not in self.degraded(), "all filters are served")
        self.assertEqual(self.mqtt("filters_refused", connection="durable"), 0)
        self.assertNotIn("mqtt_session_lost", self.degraded())
        self.tell_a_log_line(2)
        self.wait(lambda: self.log_lines() == 1, "what was refused is stored")

    def go_on_at_a_lower_qos(self, version):
        self.start_broker("max_qos 0\n")
        self.serve(f'version = "{version}"')
        self.wait(lambda: "mqtt_filters" in self.degraded(), "it is shown")
        self.assertGreater(self.mqtt("filters_lower", connection="durable"), 0)
        self.assertEqual(self.mqtt("filters_refused", connection="durable"), 0)
        # The live connection asked for no more than that.
        self.assertEqual(self.mqtt("filters_lower", connection="live"), 0)
        twins = self.twins()
        keys = twins.next_keys(DURABLE, 10)
        twins.tell_unacked(keys)
        self.wait(lambda: self.settled("stored") == len(keys), "it is stored all the same")
        self.assert_stored_once()

    def test_a_lower_qos_is_shown_by_mqtt_5(self):
        self.go_on_at_a_lower_qos("5")

    def test_a_lower_qos_is_shown_by_mqtt_3_1_1(self):
        self.go_on_at_a_lower_qos("3.1.1")


class IdTaken(Reading):
    """Another client connects by uplinkd's client id, again and again."""

    QUIET_SECONDS = 20
    # The pause is a minute, and a tenth more at most.
    PAUSE_SECONDS = 66 + 15

    def intrude(self):
        """Without a clean start: it has the session now, and acks nothing of it."""
        if self.intruder is None or not self.intruder.is_connected():
            self.intruder = self.keep(Client(self.broker.port, "uplinkd", clean_start=False))

    def test_it_pauses_and_does_not_fight(self):
        self.intruder = None
        self.serve()
        twins = self.twins()
        twins.tell(twins.next_keys(DURABLE, 1))
        self.wait_for_presence(DURABLE, ONLINE)
        self.watch.begin()

        def taken():
            self.intrude()
            return "mqtt_id_taken" in self.degraded()

        self.wait(taken, "the server knows that its id is taken")
        self.assertEqual(self.mqtt("id_taken", connection="durable"), 1)
        self.assertEqual(self.mqtt("id_taken", connection="live"), 0)
        self.assertEqual(self.connection()["state"], "id_taken")
        self.intrude()
        connections = self.mqtt("connections_total", connection="durable")
        self.stay(self.QUIET_SECONDS, lambda: self.assertTrue(self.intruder.is_connected(), "a fight"))
        self.assertEqual(self.mqtt("connections_total", connection="durable"), connections)
        twins.tell(twins.next_keys(DURABLE, 20))
        self.assert_never_offline(DURABLE)
        self.intruder.close()
        self.wait(lambda: "mqtt_id_taken" not in self.degraded(), "it comes back", self.PAUSE_SECONDS)
        self.wait_until_subscribed()
        self.assertNotIn("mqtt_session_lost", self.degraded())
        self.wait_until_all_is_stored()
        self.assert_stored_once()
        self.assert_never_offline(DURABLE)


if __name__ == "__main__":
    unittest.main()
