"""Robots that say Goodbye: a fleet that is parked pages no one, and one that falls silent does."""

import unittest

from harness import EndToEnd, wait_until
from prometheus import Prometheus
from two_servers import ROBOTS, A, B, TwoServers

ROBOTS_HERE = 4
SECONDS = 60
# A robot is soon offline, and the server judges soon after its start.
PRESENCE = """[presence]
timeout = "2s"
startup_grace = "2s"
"""
FIRING = 'count(ALERTS{alertname="UplinkdRobotsOffline",alertstate="firing"})'


def robots_of(server):
    answer = server.get("/api/v1/robots?pageSize=1000") or {}
    return answer.get("robots", [])


def all_are(server, count, condition):
    robots = robots_of(server)
    return len(robots) == count and all(map(condition, robots))


def is_parked(robot):
    return robot["presence"] == "offline" and "parkedUntil" in robot


class Parked(EndToEnd):
    def wait_for_all(self, server, condition, what):
        wait_until(server.process, lambda: all_are(server, ROBOTS_HERE, condition), SECONDS, what)

    def play(self, server, *flags):
        """A fleet that comes, is heard, and leaves in order."""
        fleet = self.fleet(server, "--robots", ROBOTS_HERE, *flags)
        self.wait_for_all(server, lambda robot: robot["presence"] == "online", "all are online")
        return self.assert_agrees(fleet)

    def test_parking_a_fleet_pages_nobody_and_its_silence_does(self):
        server = self.server(PRESENCE).start()
        # With an Alertmanager, which may be away, alerts fire at once.
        prometheus = Prometheus(self.folder, server, alertmanager="127.0.0.1:9")
        self.open_things.append(prometheus)
        self.play(server, "--parked", "1h")
        self.wait_for_all(server, is_parked, "all are parked")
        self.assert_nobody_is_paged(prometheus)

        server.kill()
        server.start()
        self.wait_for_all(server, is_parked, "all are parked after a restart")
        self.assert_nobody_is_paged(prometheus)

        self.play(server)
        self.wait_for_all(
            server,
            lambda robot: robot["presence"] == "offline" and "parkedUntil" not in robot,
            "they were there again, and half-closed alone",
        )
        prometheus.wait_for_value(FIRING, 1)

    def assert_nobody_is_paged(self, prometheus):
        prometheus.wait_for_value('sum(uplinkd_robots{presence="parked"})', ROBOTS_HERE)
        # The rules have seen both.
        prometheus.wait_for_value("instance:uplinkd_robots_offline:ratio", 0)
        prometheus.wait_for_value("instance:uplinkd_robots_present:count", ROBOTS_HERE)
        self.assertEqual(prometheus.query(FIRING), [])

    def test_a_goodbye_counts_as_long_as_the_server_says_at_most(self):
        server = self.server(PRESENCE + 'parked_max = "8s"\n').start()
        fleet = self.fleet(server, "--robots", ROBOTS_HERE, "--parked", "1h")
        self.wait_for_all(server, lambda robot: robot["presence"] == "online", "all are online")
        code, report = fleet.finish()
        # Robots believe what they said, and the server does not.
        self.assertEqual({check["what"] for check in report["checks"] if not check["ok"]}, {"robots parked"})
        self.assertNotEqual(code, 0)
        self.wait_for_all(server, is_parked, "all are parked")
        self.wait_for_all(server, lambda robot: "parkedUntil" not in robot, "the maximum is over")

    def test_a_robot_that_comes_and_goes_is_flapping(self):
        server = self.server(PRESENCE + "flap_changes = 3\n").start()
        self.play(server)
        self.wait_for_all(server, lambda robot: robot["presence"] == "offline", "all have left")
        self.assertTrue(all_are(server, ROBOTS_HERE, lambda robot: not robot["flapping"]))
        self.play(server)
        self.wait_for_all(server, lambda robot: robot["flapping"], "all have come and gone")
        self.assertEqual(server.metric('uplinkd_robots_flapping{fleet="default"}'), ROBOTS_HERE)


class ParkedBesideAnother(TwoServers):
    """Two servers on one database: what one was told the other knows, and keeps."""

    def test_the_other_server_shows_it_and_takes_it_over(self):
        self.start(A, B)
        self.robots_at(A, "--parked", "1h")
        self.assert_all_is_stored(self.fleets[0])
        ends = self.wait_for_parked(A)
        self.assertEqual(self.wait_for_parked(B), ends)
        self.wait_for(lambda: self.parked(B, "uplinkd_robots_elsewhere") == ROBOTS, "B counts them", B)
        self.assertEqual(self.parked(A, "uplinkd_robots"), ROBOTS)
        self.servers[A].kill()
        self.wait_for(lambda: self.parked(B, "uplinkd_robots") == ROBOTS, "B has adopted them", B)
        self.assertEqual(self.wait_for_parked(B), ends)

    def parked(self, place, metric):
        return self.servers[place].metric(f'{metric}{{fleet="default",presence="parked"}}')

    def wait_for_parked(self, place):
        """By RURI until when this server shows its robots as parked."""

        def ends():
            shown = self.robots(place)
            parked = {ruri: robot["parkedUntil"] for ruri, robot in shown.items() if is_parked(robot)}
            return parked if len(parked) == ROBOTS else None

        return self.wait_for(ends, "all are parked", place)


if __name__ == "__main__":
    unittest.main()
