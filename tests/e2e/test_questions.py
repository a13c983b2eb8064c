"""Each question of docs/operate/questions.md, asked of a fleet by its request and by its command: the answers are what a
look through all rows finds.
"""

import datetime
import shlex
import time
import unittest
import urllib.parse

import questions
from harness import SOURCE, EndToEnd, uplinkctl, wait_until

FLEET = "north"
ROBOTS = 4
WAIT_SECONDS = 90
SETTINGS = '[presence]\ntimeout = "3s"\n'


def rows_of(answer):
    return next(part for part in answer.values() if isinstance(part, list))


class Questions(EndToEnd):
    def setUp(self):
        super().setUp()
        self.began = datetime.datetime.now(datetime.timezone.utc) - datetime.timedelta(minutes=1)
        self.asked = self.server(SETTINGS)
        self.asked.start()
        gone = self.fleet(self.asked, "--robots", 1, "--faults", 30, "--pace", 20, "--fleet", "south",
                          "--ruri-prefix", "rcan://local.rcan/gone/robots/1.0")  # fmt: skip
        self.wait(lambda: self.all("robots?presence=online"), "the robot that will be gone is online")
        gone.process.kill()
        self.fleet(self.asked, "--robots", ROBOTS, "--pace", 20, "--faults", 20, "--malformed-share", 0.05, "--fleet", FLEET,
                   "--rcan-share", 0.5)  # fmt: skip
        self.wait(self.facts, "there is something of all that is asked")

    def wait(self, condition, what):
        return wait_until(self.asked.process, condition, WAIT_SECONDS, what)

    def get(self, path):
        answer = self.asked.get(f"/api/v1/{path}")
        self.assertIsNotNone(answer, path)
        return answer

    def all(self, path):
        """All rows of a list."""
        join, rows, token = "&" if "?" in path else "?", [], ""
        while True:
            page = self.get(f"{path}{join}pageSize=1000&pageToken={urllib.parse.quote(token, safe='')}")
            rows += rows_of(page)
            token = page["nextPageToken"]
            if not token:
                return rows

    def facts(self):
        """What the questions name, as this fleet has it; nothing while something of it is missing."""
        robots = [robot for robot in self.all("robots?parts=none") if robot["fleet"] == FLEET]
        faults, runs, bad = self.all("faults"), self.all("missions"), self.all("quarantine")
        charged = [robot for robot in robots if "batteryPercent" in robot]
        placed = [robot for robot in robots if robot.get("position", {}).get("frame") == "wgs84"]
        south = self.all("robots?presence=offline&parts=none")
        if not (len(robots) == ROBOTS and faults and runs and bad and charged and placed and south):
            return None
        fault, place = faults[0], placed[0]["position"]
        return {
            "server": f"http://{self.asked.http}",
            "name": fault["ruri"].rsplit("/", 1)[-1],
            "ruri": urllib.parse.quote(fault["ruri"], safe=""),
            "fleet": FLEET,
            "percent": str(int(min(robot["batteryPercent"] for robot in charged)) + 1),
            "box": f"{place['longitude'] - 1:.4f},{place['latitude'] - 1:.4f},"
            f"{place['longitude'] + 1:.4f},{place['latitude'] + 1:.4f}",
            "fault": fault["faultId"],
            "status": runs[0]["status"],
            "run": runs[0]["runId"],
            "reason": bad[0]["reason"],
            "software": next((robot["agentVersion"] for robot in robots if robot.get("agentVersion")), "none"),
            "since": self.began.strftime("%Y-%m-%dT%H:%M:%SZ"),
            "later": "2999-01-01T00:00:00Z",
            "within": "5000d",
        }

    def test_each_is_one_request_and_one_command(self):
        facts = self.facts() or self.wait(self.facts, "all that is asked about")
        found = {}
        for group in questions.GROUPS.values():
            for question in group:
                with self.subTest(question.ask):
                    path = question.path.format(**facts).replace(" ", "%20")
                    began = time.monotonic()
                    rows = rows_of(self.get(path))
                    asked = time.monotonic()
                    words = {name: shlex.quote(fact) for name, fact in facts.items()}
                    command = shlex.split(question.command.format(**words))
                    shown = uplinkctl(*command, "--server", facts["server"]).stdout
                    done = time.monotonic()
                    found[question.path] = rows
                    if rows:
                        self.assertTrue(shown.strip(), command)
                    print(f"{(asked - began) * 1000:6.1f} ms {(done - asked) * 1000:6.1f} ms {len(rows):5} {path}")
        self.check(facts, found)

    def check(self, facts, found):
        """Rows that questions find are those that a look through everything finds. The fleet goes on meanwhile, so of
        what is added only the sort is compared."""

        def every(path, condition):
            rows = found[path]
            self.assertTrue(rows, path)
            for row in rows:
                self.assertTrue(condition(row), (path, row))

        ruri = urllib.parse.unquote(facts["ruri"])
        every("robots?q={name}&parts=motion", lambda row: facts["name"] in row["ruri"])
        every("robots?bbox={box}&parts=none", lambda row: row["position"]["frame"] == "wgs84")
        every("robots?presence=offline&parts=none", lambda row: row["fleet"] == "south")
        self.assertEqual(sorted(row["fleet"] for row in found["fleets"]), [FLEET, "south"])
        every("robot/story?ruri={ruri}&from={since}", lambda row: row["title"])
        every("presence?fleet={fleet}&from={since}", lambda row: row["presence"] == "online")
        every("connections?open=true&fleet={fleet}", lambda row: row["certificate"]["serial"] and "end" not in row)
        self.assertEqual(len(found["connections?open=true&fleet={fleet}"]), ROBOTS)
        self.assertEqual(len(found["robots?certificateExpiresBefore={later}&parts=none"]), ROBOTS)
        every("faults?faultId={fault}&ruri={ruri}", lambda row: (row["faultId"], row["ruri"]) == (facts["fault"], ruri))
        every("missions?status={status}&from={since}", lambda row: row["status"] == facts["status"])
        every("mission-reports?runId={run}", lambda row: row["runId"] == facts["run"])
        every("quarantine?reason={reason}", lambda row: row["reason"] == facts["reason"])
        every("events?fleet={fleet}&from={since}", lambda row: row["ruri"] != "")
        every("top?by=messages", lambda row: row["perSecond"] > 0)
        rates = [row["perSecond"] for row in found["top?by=messages"]]
        self.assertEqual(rates, sorted(rates, reverse=True))
        every("robots?orderBy=-backlog&parts=none", lambda row: True)
        self.assertEqual(found["robots?heldBack=true&parts=none"], [])

    def test_the_page_is_made_from_them(self):
        page = (SOURCE / "docs/operate/questions.md").read_text(encoding="utf-8")
        self.assertEqual(page, questions.page(), "write it anew: python3 tests/e2e/questions.py > docs/operate/questions.md")


if __name__ == "__main__":
    unittest.main()
