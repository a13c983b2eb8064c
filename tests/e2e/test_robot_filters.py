"""The list of robots, with robots of every source: a fleet on streams that also sends RCAN Robot States, twins behind a
broker, drones. Each filter gives the robots whose members say so, and no other one.
"""

import datetime
import json
import unittest
import urllib.parse

from broker_messages import A, B, MessageTest, topic, twin
from drone_samples import request_of, times
from drones import ROOT, SETTINGS, certify, make_modules, python_drone

ROBOTS = 4
DRONES = {ROOT + "d1": 15.5, ROOT + "d2": 95}
TWINS = {twin(A): 12, twin(B): 88}
# West, south, east, north: each drone and twin is in one of the two.
NORTH, SOUTH = (8, 47, 9, 48), (150, -35, 152, -33)
# No robot becomes offline meanwhile.
TWINS_PRESENCE = 'presence_timeout = "10m"\n'
PRESENCE = """[presence]
timeout = "10m"
"""
FUTURE = "2999-01-01T00:00:00Z"
PAST = "2000-01-01T00:00:00Z"


def sources_of(robots):
    return {robot["source"] for robot in robots}


def is_within(robot, box):
    position = robot.get("position", {})
    if position.get("frame") != "wgs84":
        return False
    west, south, east, north = box
    return west <= position["longitude"] <= east and south <= position["latitude"] <= north


class RobotFilters(MessageTest):
    def setUp(self):
        super().setUp()
        self.here = self.serve(more=TWINS_PRESENCE + SETTINGS + PRESENCE)
        self.fly()
        self.publish()
        fleet = self.fleet(self.here, "--robots", ROBOTS, "--rcan-share", 0.5, "--faults", 30)
        self.here.wait_for_status(lambda status: int(status["uplinks"]["stored"]) >= 60, 60, "the fleet is at work")
        self.wait(self.here, lambda: self.ask("top")["robots"], "the fleet sends most")
        self.top = self.ask("top?by=messages")
        self.assert_agrees(fleet)
        # Nothing changes from here on.
        self.robots = self.ask("robots?parts=none&pageSize=1000")["robots"]
        self.assertEqual(len(self.robots), ROBOTS + len(DRONES) + len(TWINS))

    def fly(self):
        modules = make_modules(self.folder)
        for ruri, percent in DRONES.items():
            uav = ruri.removeprefix(ROOT)
            drone = python_drone(modules)
            self.open_things.append(drone)
            drone.tell("connect", name="server", target=self.here.relay, **certify(self.here.pki, uav))
            place = NORTH if percent < 50 else SOUTH
            for name, sample in {
                "Battery": {"id": 0, "remaining_percent": percent},
                "Position": {"latitude_deg": place[1] + 0.5, "longitude_deg": place[0] + 0.5},
            }.items():
                request = request_of(name, sample, {**times(1), "uav_id": ""})
                answer = drone.tell("call", to="server", type=name, request=request)
                self.assertEqual((answer["code"], answer["outcome"]), ("OK", "APPLIED"), answer)

    def publish(self):
        client = self.client("publisher")
        for uuid, percent, place in ((A, 12, NORTH), (B, 88, SOUTH)):
            gps = {"latitude": place[1] + 0.25, "longitude": place[0] + 0.25}
            client.publish(topic(uuid, "gps"), json.dumps(gps))
            client.publish(topic(uuid, "metrics"), json.dumps({"metrics": {"power": {"battery_percent": percent}}}), qos=1)
        self.outcomes(self.here, 4)

    def ask(self, path):
        answer = self.here.get(f"/api/v1/{path}")
        self.assertIsNotNone(answer, path)
        return answer

    def find(self, **filters):
        """The robots of a filter, page by page."""
        words = {name: str(value).lower() if isinstance(value, bool) else value for name, value in filters.items()}
        query, found = urllib.parse.urlencode({**words, "parts": "none", "pageSize": 3}, quote_via=urllib.parse.quote), []
        token = ""
        while True:
            page = self.ask(f"robots?{query}&pageToken={token}")
            found += page["robots"]
            token = page["nextPageToken"]
            self.assertEqual(page["unjudged"], "0")
            if not token:
                self.assertEqual(int(page["total"]), len(found))
                return found

    def assert_finds(self, meets, sources=None, **filters):
        """A filter finds the robots that meet a condition, of these sources among others."""
        expected = sorted(robot["ruri"] for robot in self.robots if meets(robot))
        found = self.find(**filters)
        self.assertEqual(sorted(robot["ruri"] for robot in found), expected, filters)
        self.assertLessEqual(sources or set(), sources_of(found), filters)

    def test_each_filter_finds_the_robots_of_every_source_that_say_so(self):
        every = {"uplink", "cyberwave", "uncrew"}
        by_ruri = {robot["ruri"]: robot for robot in self.robots}
        for ruri, percent in {**DRONES, **TWINS}.items():
            self.assertEqual(by_ruri[ruri]["batteryPercent"], percent)
        for percent in (0, 50, 100):
            self.assert_finds(
                lambda robot, percent=percent: robot.get("batteryPercent", 100) < percent,
                every if percent == 100 else {"cyberwave", "uncrew"} if percent else set(), batteryBelow=percent,
            )  # fmt: skip
        for box in (NORTH, SOUTH, (-180, -90, 180, 90)):
            self.assert_finds(
                lambda robot, box=box: is_within(robot, box), {"cyberwave", "uncrew"}, bbox=",".join(map(str, box))
            )
        for word in (True, False):
            self.assert_finds(lambda robot, word=word: robot.get("estop") == word, estop=word)
            self.assert_finds(lambda robot, word=word: bool(robot["heldBack"]) == word, heldBack=word)
        for presence in ("online", "offline", "unknown"):
            self.assert_finds(lambda robot, presence=presence: robot["presence"] == presence, presence=presence)
        for q, of in (("UAV/D1", ROOT + "d1"), (A.upper(), twin(A))):
            self.assert_finds(lambda robot, of=of: robot["ruri"] == of, q=q)
        versions = {robot["agentVersion"] for robot in self.robots} - {""}
        self.assertTrue(versions)
        for version in versions:
            # The software of a robot may be named alike, and no member shows it here.
            found = {robot["ruri"] for robot in self.find(software=version)}
            self.assertLessEqual({robot["ruri"] for robot in self.robots if robot["agentVersion"] == version}, found)
        self.assertEqual(self.find(software="no such version"), [])
        self.assertEqual(self.find(offlineBefore=PAST), [])
        self.assert_finds(lambda robot: robot["presence"] == "offline", offlineBefore=FUTURE)
        # Drones are still connected by their certificates, and the fleet has left.
        self.assert_finds(lambda robot: "certificateNotAfter" in robot, {"uncrew"}, certificateExpiresBefore=FUTURE)
        self.assertEqual(self.find(certificateExpiresBefore=PAST), [])
        faulted = {robot["ruri"] for robot in self.find(faulted=True)}
        self.assertLessEqual({robot["ruri"] for robot in self.robots if robot["activeFaults"]}, faulted)
        self.assertEqual(len(faulted) + len(self.find(faulted=False)), len(self.robots))

    def test_orders_put_robots_without_the_value_last(self):
        for sign in ("", "-"):
            found = [robot.get("batteryPercent") for robot in self.find(orderBy=f"{sign}battery")]
            values = [value for value in found if value is not None]
            self.assertEqual(values, sorted(values, reverse=bool(sign)))
            self.assertEqual(found[len(values) :], [None] * (len(found) - len(values)))
            names = [robot["ruri"] for robot in self.find(orderBy=f"{sign}ruri")]
            self.assertEqual(names, sorted(names, reverse=bool(sign)))
            heard = [
                datetime.datetime.fromisoformat(robot["lastSignOfLife"])
                for robot in self.find(orderBy=f"{sign}lastHeard") if "lastSignOfLife" in robot
            ]  # fmt: skip
            self.assertEqual(heard, sorted(heard, reverse=bool(sign)))

    def test_the_series_say_the_same_of_battery_and_place(self):
        for robot in self.robots:
            name = f'{{ruri="{robot["ruri"]}"}}'
            if "batteryPercent" in robot:
                shown = self.series(self.here, f"rcan_robot_battery_pct{name}")
                self.assertEqual([float(value) for value in shown], [robot["batteryPercent"]] * len(shown))

    def test_fleets_add_up(self):
        fleets = self.ask("fleets")["fleets"]
        self.assertEqual(sum(int(fleet["robots"]) for fleet in fleets), len(self.robots))
        for fleet in fleets:
            own = [robot for robot in self.robots if robot["fleet"] == fleet["fleet"]]
            for presence in ("online", "offline", "unknown"):
                self.assertEqual(int(fleet[presence]), sum(robot["presence"] == presence for robot in own))
            self.assertEqual(int(fleet["estops"]), sum(robot.get("estop", False) for robot in own))
            active = sum(int(count) for count in fleet["activeFaults"].values())
            self.assertEqual(active, sum(robot["activeFaults"] for robot in own))

    def test_the_fleet_at_work_sends_most(self):
        self.assertEqual(self.top["by"], "messages")
        self.assertTrue(self.top["robots"])
        rates = [robot["perSecond"] for robot in self.top["robots"]]
        self.assertEqual(rates, sorted(rates, reverse=True))
        self.assertNotIn(self.top["robots"][0]["ruri"], {*DRONES, *TWINS})


if __name__ == "__main__":
    unittest.main()
