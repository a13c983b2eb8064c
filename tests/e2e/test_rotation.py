"""A new certificate of the server and a new authority of the robots, while a large fleet streams."""

import ssl
import unittest

from harness import EndToEnd, Fleet, uplinkctl, wait_until

ROBOTS = 1_000
ALL_SECONDS = 120
FILE_SECONDS = 60


class Rotation(EndToEnd):
    def setUp(self):
        super().setUp()
        self.running = self.server()
        self.authorities = self.folder / "authorities.crt"
        self.authorities.write_bytes((self.running.pki / "ca.crt").read_bytes())
        self.running.environment = {"UPLINKD_TLS_CLIENT_CA_FILE": str(self.authorities)}
        self.next = self.folder / "next"
        uplinkctl("pki", "init", "--dir", self.next)
        uplinkctl("pki", "server", "--dir", self.next, "--host", "localhost", "--host", "127.0.0.1")
        self.running.start()

    def wait(self, condition, what, seconds=FILE_SECONDS):
        return wait_until(self.running.process, condition, seconds, what)

    def begin(self, robots, pki=None, prefix="rcan://local.rcan/uplink/synthetic/1.0"):
        """Robots with certificates of this authority."""
        at = self.running.pki
        self.running.pki = pki or at
        fleet = Fleet(self.running, "--robots", robots, "--scenario", "steady", "--acks-only", "--ruri-prefix", prefix)
        self.running.pki = at
        self.open_things.append(fleet)
        return fleet

    def wait_for_streams(self, number):
        self.wait(lambda: self.running.metric("uplinkd_streams") == number, f"{number} streams", ALL_SECONDS)

    def replace(self, path, text):
        aside = path.with_suffix(".new")
        aside.write_bytes(text)
        aside.chmod(path.stat().st_mode & 0o777)
        aside.replace(path)

    def shown(self):
        """The certificate that new connections see."""
        place = self.running.relay.rsplit(":", 1)
        return ssl.get_server_certificate((place[0], int(place[1])))

    def connections(self):
        """Streams that began, by the robots' own histories."""
        found, token = [], ""
        while True:
            page = self.running.get(f"/api/v1/connections?pageSize=1000&pageToken={token}")
            found += page["connections"]
            token = page.get("nextPageToken", "")
            if not token:
                return found

    def test_no_stream_is_dropped(self):
        before = self.begin(ROBOTS)
        self.wait_for_streams(ROBOTS)

        self.replace(self.authorities, self.authorities.read_bytes() + (self.next / "ca.crt").read_bytes())
        self.running.wait_for_line(" authorities=2 ")
        old = self.shown()
        for name in ("server.key", "server.crt"):
            self.replace(self.running.pki / name, (self.next / name).read_bytes())
        self.wait(lambda: self.shown() != old, "the new certificate is served")

        after = self.begin(10, self.next, "rcan://local.rcan/uplink/next/1.0")
        self.wait_for_streams(ROBOTS + 10)
        frames = self.running.metric("uplinkd_frames_received_total")
        self.wait(lambda: self.running.metric("uplinkd_frames_received_total") > frames + ROBOTS, "all go on")
        self.assertEqual([row["end"] for row in self.connections() if "end" in row], [])
        for fleet in (after, before):
            code, report = fleet.finish()
            self.assertEqual(code, 0, report)
        self.assertEqual(len(self.connections()), ROBOTS + 10)


if __name__ == "__main__":
    unittest.main()
