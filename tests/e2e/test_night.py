"""A bad night, and what the server tells of it in the morning: why each robot's connection ended, on both stores."""

import unittest
import urllib.parse

from ending_agents import DRAIN, PATIENCE_SECONDS, RURI, SECONDS, EndingAgents
from harness import Cluster, Server, uplinkctl, wait_until
from tcp_proxy import Cut

# So long does the certificate of one robot last.
EXPIRES_SECONDS = 30
SETTINGS = DRAIN + '[presence]\ntimeout = "5s"\n'


class Night(EndingAgents):
    def pages(self, path, name, **parameters):
        """All rows of a list, walked by small pages."""
        rows, token = [], ""
        while True:
            query = urllib.parse.urlencode({**parameters, "pageSize": 2, "pageToken": token})
            page = self.running.get(f"{path}?{query}")
            if page is None:
                return rows
            rows += page[name]
            token = page["nextPageToken"]
            if not token:
                return rows

    def story(self, name):
        """Oldest first."""
        return self.pages("/api/v1/robot/story", "entries", ruri=RURI + name, orderBy="oldest")

    def ends(self, name):
        return [
            entry["detail"]["end"]["why"] for entry in self.story(name) if entry["kind"] == "disconnected"
        ]

    def expect(self, name, *ends):
        try:
            wait_until(
                self.running.process, lambda: len(self.ends(name)) >= len(ends), PATIENCE_SECONDS, f"{name} ends"
            )
        except AssertionError as error:
            raise AssertionError(f"{error}: {self.story(name)}\n{self.running.text()}") from None
        self.assertEqual(self.ends(name), list(ends), self.story(name))

    def night(self, server):
        self.serve(server)
        self.certify("expiring", EXPIRES_SECONDS)

        # Those that take long first.
        self.agent("hello", name="expiring")
        self.agent("silent", name="firewall", through=self.proxy.address)
        self.proxy.cut(Cut.BLACK_HOLE)
        self.agent("half_close", name="parked")
        self.agent("hello", name="killed").kill()
        self.agent("hello", name="twin")
        self.agent("hello", name="twin").kill()

        self.expect("parked", "orderly")
        self.expect("killed", "broken")
        self.expect("twin", "replaced", "broken")
        self.expect("firewall", "silent")
        self.expect("expiring", "certificate_expired")

        self.agent("hello", name="drained")
        self.assertEqual(self.running.terminate(SECONDS), 0)
        self.running.start()
        self.expect("drained", "drained")

        self.agent("hello", name="open")
        wait_until(self.running.process, lambda: self.story("open"), SECONDS, "its connection is kept")
        self.assertEqual(self.ends("open"), [])
        self.running.kill()
        self.running.start()
        self.expect("open", "server_ended")
        self.look_back()

    def look_back(self):
        """What lists show of that night."""
        self.assertRegex(
            [entry["title"] for entry in self.story("firewall")][-1],
            r"^The connection from 127\.0\.0\.1:\d+ ended: silent \(nothing answered the server's keepalive\)\.$",
        )
        for why, name in (("silent", "firewall"), ("certificate_expired", "expiring"), ("server_ended", "open")):
            rows = self.pages("/api/v1/connections", "connections", why=why)
            self.assertEqual([row["ruri"] for row in rows], [RURI + name])
        self.assertEqual(self.pages("/api/v1/connections", "connections", open="true"), [])
        first, second = self.pages("/api/v1/connections", "connections", ruri=RURI + "twin", orderBy="oldest")
        self.assertEqual((first["takeovers"], second["takeovers"]), (0, 1))
        self.assertEqual(first["end"]["code"], "ABORTED")
        self.assertRegex(first["address"], r"^127\.0\.0\.1:\d+$")
        self.assertEqual(first["certificate"], second["certificate"])
        self.assertRegex(first["certificate"]["sha256"], "^[0-9a-f]{64}$")
        self.assertIn("notAfter", first["certificate"])
        self.assertEqual(first["source"], "uplink")

    def test_on_sqlite(self):
        self.night(self.server(SETTINGS))

    def test_on_postgresql(self):
        cluster = Cluster(self.folder)
        self.open_things.append(cluster)
        cluster.create().migrate()
        server = Server(self.folder, SETTINGS, store_url=cluster.url("uplinkd"))
        self.open_things.append(server)
        self.night(server)

    def test_presence_says_why_a_robot_went_offline(self):
        server = self.server(SETTINGS).start()
        fleet = self.fleet(server, "--robots", 1)
        ruri = wait_until(
            server.process,
            lambda: [robot["ruri"] for robot in server.get("/api/v1/robots?presence=online")["robots"]],
            SECONDS, "the robot is online",
        )[0]  # fmt: skip
        fleet.close()

        def offline():
            changes = server.get(f"/api/v1/presence?ruri={urllib.parse.quote(ruri, safe='')}")["presenceChanges"]
            return changes[0] if changes and changes[0]["presence"] == "offline" else None

        change = wait_until(server.process, offline, SECONDS, "the robot is offline")
        self.assertEqual(change["why"], "broken")
        story = server.get(f"/api/v1/robot/story?ruri={urllib.parse.quote(ruri, safe='')}")["entries"]
        self.assertEqual(story[0]["title"], "The robot is offline: its last connection ended as broken.")

    def test_a_robot_that_is_forgotten_leaves_no_story(self):
        self.serve(self.server(SETTINGS))
        self.agent("hello", name="gone").kill()
        self.expect("gone", "broken")
        uplinkctl("store", "forget", "--url", self.running.store_url, "--yes", RURI + "gone")
        self.assertEqual(self.story("gone"), [])


if __name__ == "__main__":
    unittest.main()
