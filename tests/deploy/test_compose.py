"""deploy/compose under a real dockerd: each profile becomes healthy and takes robots, Prometheus scrapes it, and
an alert reaches a webhook. Grafana is left out: no package holds it."""

import json
import shutil
import subprocess
import sys
import time
import unittest
import urllib.parse

from docker import Docker
from images import MINUTES, SOURCE, WORK, run
from waiting import wait_for

FOLDERS = ("compose", "prometheus", "grafana", "mosquitto")
RECEIVER_PORT = 9999
# A machine for tests may not grant 65,536 descriptors.
OVERRIDE = """
services:
  uplinkd: {ulimits: {nofile: 16384}}
  uplinkd-postgres: {ulimits: {nofile: 16384}}
  uplinkd-cyberwave: {ulimits: {nofile: 16384}}
  grafana:
    profiles: [without-its-image]
  alertmanager:
    extra_hosts: ["receiver:host-gateway"]
"""
WEBHOOK = f"""
    webhook_configs:
      - url: http://receiver:{RECEIVER_PORT}/
"""


class Compose(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.docker = Docker()
        cls.addClassCleanup(cls.docker.close)
        cls.docker.load_images()

    def setUp(self):
        self.folder = WORK / "compose"
        shutil.rmtree(self.folder, ignore_errors=True)
        for name in FOLDERS:
            shutil.copytree(SOURCE / "deploy" / name, self.folder / name)
        self.compose_folder = self.folder / "compose"
        for path in (self.compose_folder / "secrets").glob("*.password"):
            path.unlink()
        (self.compose_folder / "compose.override.yaml").write_text(OVERRIDE, encoding="utf-8")
        alerts = self.compose_folder / "alertmanager.yml"
        text = alerts.read_text(encoding="utf-8")
        self.assertIn("- name: page\n", text)
        alerts.write_text(text.replace("- name: page\n", "- name: page" + WEBHOOK), encoding="utf-8")
        scrapes = self.compose_folder / "prometheus.yml"
        text = scrapes.read_text(encoding="utf-8")
        scrapes.write_text(text.replace("_interval: 15s", "_interval: 2s").replace("_interval: 30s", "_interval: 2s"),
                           encoding="utf-8")  # fmt: skip
        run(self.compose_folder / "make-secrets.sh")
        self.addCleanup(shutil.rmtree, self.folder)

    def use(self, profile):
        """Starts a profile as a user does, and waits until its server is healthy."""
        settings = self.compose_folder / ".env"
        text = settings.read_text(encoding="utf-8")
        self.assertIn("COMPOSE_PROFILES=sqlite\n", text)
        settings.write_text(text.replace("PROFILES=sqlite", f"PROFILES={profile}"), encoding="utf-8")
        began = time.monotonic()
        self.addCleanup(self.compose, "down", "--volumes", "--timeout", "30")
        try:
            self.compose("up", "--detach")
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.compose('logs', '--tail', '20').stdout}") from None
        self.service = "uplinkd" if profile == "sqlite" else f"uplinkd-{profile}"
        self.wait_until_healthy()
        print(f"\n{profile}: healthy after {time.monotonic() - began:.0f} s")

    def compose(self, *arguments, code=0):
        return run("docker-compose", "--project-directory", self.compose_folder,
                   "--file", self.compose_folder / "compose.yaml",
                   "--file", self.compose_folder / "compose.override.yaml", *arguments,
                   code=code, timeout=5 * MINUTES, env=self.docker.environment)  # fmt: skip

    def container(self, service):
        return self.compose("ps", "--quiet", service).stdout.strip()

    def state(self, service):
        return json.loads(self.docker("inspect", self.container(service)).stdout)[0]["State"]

    def wait_for(self, condition, seconds, what):
        return wait_for(condition, seconds, what, [self.docker.process.pid], every=1)

    def wait_until_healthy(self):
        def healthy():
            return self.state(self.service)["Health"]["Status"] == "healthy"

        try:
            self.wait_for(healthy, 60, f"{self.service} is healthy")
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.compose('logs', '--tail', '30').stdout}") from None

    def send_robots(self):
        done = self.compose("run", "--rm", "robots", "--robots", "5", "--for", "5s", "--pace", "10")
        self.assertIn("verification: all agree", done.stdout)

    def api(self, path):
        """The answer of the server's loopback."""
        pid = self.state(self.service)["Pid"]
        return json.loads(run("nsenter", "-n", "-t", pid, "curl", "-sf", f"http://127.0.0.1:7480{path}").stdout)

    def query(self, expression):
        """The samples of Prometheus, by job."""
        url = "http://127.0.0.1:9090/api/v1/query?" + urllib.parse.urlencode({"query": expression})
        try:
            answer = self.docker.inside("curl", "-sf", url).stdout
        except AssertionError:
            return {}
        return {sample["metric"].get("job", ""): sample["value"][1] for sample in json.loads(answer)["data"]["result"]}

    def wait_for_scrapes(self):
        both = {"uplinkd": "1", "uplinkd-robots": "1"}
        self.wait_for(lambda: self.query("up") == both, 60, "Prometheus scrapes both paths")

    def test_sqlite_is_watched_and_its_end_reaches_the_webhook(self):
        self.use("sqlite")
        self.wait_for_scrapes()
        self.send_robots()
        self.wait_for(lambda: self.query("sum(rcan_robot_online)"), 30, "the robots' series are there")
        # What is there stays: a second `up` changes nothing.
        before = self.container(self.service)
        self.compose("up", "--detach")
        self.wait_until_healthy()
        self.assertEqual(self.container(self.service), before)
        received = self.folder / "alerts"
        receiver = subprocess.Popen(
            ["nsenter", "-n", "-t", str(self.docker.process.pid), sys.executable,
             SOURCE / "tests/deploy/receiver.py", str(RECEIVER_PORT), received],
        )  # fmt: skip
        self.addCleanup(receiver.wait, 30)
        self.addCleanup(receiver.kill)
        self.compose("stop", self.service)
        self.assertEqual(self.state_of_stopped()["ExitCode"], 0)

        def delivered():
            return received.exists() and "UplinkdDown" in received.read_text(encoding="utf-8")

        self.wait_for(delivered, 3 * MINUTES, "UplinkdDown reaches the webhook")

    def state_of_stopped(self):
        container = self.compose("ps", "--quiet", "--all", self.service).stdout.strip()
        return json.loads(self.docker("inspect", container).stdout)[0]["State"]

    def test_postgres_is_migrated_and_takes_robots(self):
        self.use("postgres")
        self.send_robots()
        self.assertEqual(self.api("/api/v1/status")["degraded"], [])
        counted = self.docker("exec", "--user", "postgres", self.container("postgres"), "psql", "-X", "-A", "-t",
                              "-U", "uplinkd_owner", "-d", "uplinkd", "-c", "SELECT count(*) FROM uplinkd.robots")  # fmt: skip
        self.assertEqual(counted.stdout.strip(), "5")

    def test_cyberwave_reads_its_broker(self):
        self.use("cyberwave")
        self.wait_for(lambda: "mqtt_away" not in self.api("/api/v1/status")["degraded"], 30, "the broker is read")
        self.send_robots()


if __name__ == "__main__":
    unittest.main()
