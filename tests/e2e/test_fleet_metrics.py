"""What Prometheus knows of fleets, and of the robots in them."""

import unittest

from harness import EndToEnd
from prometheus import Prometheus
from test_clock import ShiftedClock

NORTH, SOUTH = 3, 1
SETTINGS = "[metrics]\nfleets_max = 1\n"
INFO = "robot:rcan_robot_info:one"
# uplink-fleet's certificates are valid for 30 days.
AHEAD_SECONDS = 20 * 24 * 3600


class FleetMetrics(EndToEnd):
    def start(self, environment=None):
        self.running = self.server(SETTINGS)
        self.running.environment = environment or {}
        self.running.start()
        self.prometheus = Prometheus(self.folder, self.running)
        self.open_things.append(self.prometheus)

    def send(self, fleet, robots):
        place = f"rcan://local.rcan/{fleet}"
        flags = ("--fleet", fleet, "--robots", robots, "--ruri-prefix", place, "--pace", 10)
        return self.fleet(self.running, *flags)

    def send_by_both(self):
        """The first fleet takes the only name; gives the second."""
        self.start()
        self.send("north", NORTH)
        self.wait_for('uplinkd_robots{fleet="north",presence="online"}', NORTH)
        south = self.send("south", SOUTH)
        self.wait_for('uplinkd_robots{fleet="_other",presence="online"}', SOUTH)
        return south

    def wait_for(self, expression, value):
        self.prometheus.wait_for_value(expression, value)

    def test_robots_count_by_fleet_and_their_series_join_to_it(self):
        self.send_by_both()
        self.wait_for('fleet:uplinkd_robots:count{fleet="north",presence="online"}', NORTH)
        self.wait_for("count(count by (fleet) (uplinkd_robots))", 2)
        # A fleet without a name on /metrics has one with its robots.
        self.wait_for(f'count({INFO}{{fleet="south"}})', SOUTH)
        self.wait_for(f'sum(rcan_robot_online * on (ruri) group_left (fleet) {INFO}{{fleet="north"}})', NORTH)
        found = self.prometheus.wait_for('rcan_robot_info{fleet="south",agent_version!="",software_version!=""}')
        ((labels, _),) = found
        self.assertEqual(labels["name"], labels["ruri"].rsplit("/", 1)[1])
        for by in ("messages", "bytes"):
            self.wait_for(f'count(uplinkd_top_robots{{by="{by}"}} > 0)', NORTH + SOUTH)
        for rule in ("battery_low", "critical_faults", "estops", "missions_failed"):
            self.wait_for(f"count(fleet:rcan_{rule}:count)", 2)

    def test_a_fleet_that_goes_dark_is_an_alert_of_its_own(self):
        south = self.send_by_both()
        self.wait_for('fleet:uplinkd_robots_dark:ratio{fleet="_other"}', 0)
        south.close()
        self.wait_for('fleet:uplinkd_robots_dark:ratio{fleet="_other"}', 1)
        self.prometheus.wait_for('ALERTS{alertname="UplinkdFleetDark",fleet="_other"}')
        self.assertEqual(self.prometheus.query('ALERTS{alertname="UplinkdFleetDark",fleet="north"}'), [])
        self.wait_for('uplinkd_robot_certificates_expiring{fleet="north",within="14d"}', 0)

    def test_certificates_that_expire_and_telemetry_that_is_late_are_alerts(self):
        clock = ShiftedClock(self.folder)
        clock.set(AHEAD_SECONDS)
        self.start(clock.environment)
        north = self.send("north", NORTH)
        self.wait_for('uplinkd_robot_certificates_expiring{fleet="north",within="14d"}', NORTH)
        self.prometheus.wait_for('ALERTS{alertname="UplinkdFleetCertificatesExpiring",fleet="north"}')
        self.prometheus.wait_for('ALERTS{alertname="UplinkdTelemetryLate",source="uplink"}')
        north.close()
        self.wait_for('uplinkd_robot_certificates_expiring{fleet="north",within="14d"}', 0)


if __name__ == "__main__":
    unittest.main()
