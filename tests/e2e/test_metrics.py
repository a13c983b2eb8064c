"""Both scrapes, by Prometheus' own programs."""

import gzip
import pathlib
import re
import socket
import subprocess
import tempfile
import unittest
import urllib.request

import dashboards
from broker_messages import A, SETTINGS, event, topic
from harness import BIN, SOURCE, EndToEnd, Server, run, wait_until
from mosquitto import Mosquitto
from drones import SETTINGS as UNCREW
from mqtt_client import Client
from prometheus import Prometheus

ROBOTS = 6
WAIT_SECONDS = 60
OPEN_METRICS = "application/openmetrics-text;version=1.0.0"
# What promtool says of RCAN's own names, which we cannot change.
OF_RCANS_UNITS = re.compile(r"^rcan_\w+ metric names should not contain abbreviated units$")
TYPE_LINE = re.compile(rb"^# TYPE (\S+)", re.MULTILINE)
# Debian's own interpreter, for which its packages are.
PYTHON = "/usr/bin/python3"
# Another reader of the form than Prometheus itself: it takes no name twice.
READ_OPEN_METRICS = """
import sys
try:
    from prometheus_client.openmetrics.parser import text_string_to_metric_families
except ImportError:
    sys.exit("install python3-prometheus-client, or run ./dev setup")
for family in text_string_to_metric_families(sys.stdin.read()):
    print(family.name)
"""
OF_A_BROKER = "uplinkd_mqtt_"
OF_DRONES = ("uplinkd_avatar_", "uplinkd_operator_request")
DRONES = 2
GUIDE = SOURCE / "docs/operate/metrics.md"
ALERTS = SOURCE / "docs/operate/alerts.md"


def scrape(server, path, **headers):
    request = urllib.request.Request(
        f"http://{server.http}{path}", headers={name.replace("_", "-"): text for name, text in headers.items()}
    )
    with urllib.request.urlopen(request, timeout=10) as answer:
        return answer.headers, answer.read()


def expressions_of_the_guide():
    blocks = re.findall(r"```promql\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    return [line for block in blocks for line in block.splitlines()]


class Scrapes(EndToEnd):
    def setUp(self):
        super().setUp()
        self.running = self.server().start()

    def at_work(self, *flags):
        fleet = self.fleet(
            self.running, "--robots", ROBOTS, "--rcan-share", 1, "--pace", 10, "--faults", 2, *flags
        )
        wait_until(fleet.process, lambda: b"rcan_acb_position_rad{" in self.robots(), WAIT_SECONDS, "joints are seen")
        return fleet

    def robots(self):
        return scrape(self.running, "/metrics/robots")[1]

    def check(self, text):
        return subprocess.run(
            ["promtool", "check", "metrics"], input=text, capture_output=True, timeout=60, check=False
        )

    def test_promtool_has_nothing_against_ours(self):
        self.at_work()
        done = self.check(scrape(self.running, "/metrics")[1])
        self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_promtool_has_nothing_but_units_against_the_robots(self):
        self.at_work()
        done = self.check(self.robots())
        self.assertIn(done.returncode, (0, 3), done.stderr)
        lines = [line for line in done.stderr.decode().splitlines() if line]
        self.assertTrue(lines)
        self.assertEqual([line for line in lines if not OF_RCANS_UNITS.match(line)], [])

    def test_formats_and_codings_hold_the_same(self):
        fleet = self.at_work()
        for path in ("/metrics", "/metrics/robots"):
            # Two scrapes: what one robot tells for the first time between them is in the second alone.
            wait_until(
                fleet.process, lambda path=path: self.families(path) == self.families_zipped(path),
                WAIT_SECONDS, f"{path} holds the same families in both formats",
            )  # fmt: skip

    def families(self, path):
        headers, plain = scrape(self.running, path)
        self.assertEqual(headers["Content-Type"], "text/plain; version=0.0.4; charset=utf-8")
        names = {name.removesuffix(b"_total") for name in TYPE_LINE.findall(plain)}
        self.assertTrue(names)
        return names

    def families_zipped(self, path):
        headers, zipped = scrape(self.running, path, Accept_Encoding="gzip", Accept=OPEN_METRICS)
        self.assertEqual(headers["Content-Encoding"], "gzip")
        self.assertEqual(headers["Content-Type"], "application/openmetrics-text; version=1.0.0; charset=utf-8")
        text = gzip.decompress(zipped)
        self.assertTrue(text.endswith(b"# EOF\n"))
        return set(TYPE_LINE.findall(text))

    def read_open_metrics(self, text):
        """The families' names, by a reader that is not ours; or its words on what is wrong."""
        done = subprocess.run(
            [PYTHON, "-c", READ_OPEN_METRICS], input=text, capture_output=True, timeout=60, check=False
        )
        return done.stdout.split() if done.returncode == 0 else done.stderr.decode()

    def test_another_reader_takes_the_open_metrics(self):
        self.read_a_broker()
        self.at_work()
        for path in ("/metrics", "/metrics/robots"):
            text = scrape(self.running, path, Accept=OPEN_METRICS)[1]
            self.assertEqual(self.read_open_metrics(text), TYPE_LINE.findall(text), path)

    def test_that_reader_sees_a_family_that_is_there_twice(self):
        text = b"# TYPE a counter\na_total 1\n# TYPE a gauge\na 1\n# EOF\n"
        self.assertIn("ValueError", self.read_open_metrics(text))

    def test_a_real_scrape_is_the_catalogue(self):
        self.at_work()
        self.compare_with_the_catalogue(lambda name: not name.startswith((OF_A_BROKER, *OF_DRONES)))

    def test_where_a_broker_is_read_and_drones_call_their_metrics_are_there_too(self):
        # Port 1 has no listener: what is counted of a broker is shown all the same.
        self.running = Server(self.folder / "reading", '[mqtt]\nurl = "mqtt://127.0.0.1:1"\n' + UNCREW)
        self.open_things.append(self.running)
        self.running.start()
        self.at_work()
        self.compare_with_the_catalogue(lambda name: True)

    def compare_with_the_catalogue(self, expected):
        table = run(BIN / "uplinkd", "--print-metrics").stdout.split("\n\n")[0]
        catalogue = {}
        for row in table.splitlines()[2:]:
            name, kind, _, labels, text, _ = (cell.strip() for cell in row.strip("| ").split(" | "))
            if expected(name.strip("`")):
                catalogue[name.strip("`")] = (kind, set(re.findall(r"`(\w+)`", labels)), text)
        text = scrape(self.running, "/metrics")[1].decode()
        kinds = dict(re.findall(r"^# TYPE (\S+) (\S+)$", text, re.MULTILINE))
        helps = dict(re.findall(r"^# HELP (\S+) (.*)$", text, re.MULTILINE))
        self.assertEqual(kinds, {name: kind for name, (kind, _, _) in catalogue.items()})
        self.assertEqual(helps, {name: said for name, (_, _, said) in catalogue.items()})
        for name, labels in re.findall(r"^(\w+)(?:\{(.*)\})? \S+$", text, re.MULTILINE):
            family = name if name in kinds else re.sub(r"_(bucket|sum|count)$", "", name)
            found = set(re.findall(r'(\w+)="', labels)) - {"le"}
            self.assertEqual(found, catalogue[family][1], name)

    def test_the_law_holds_in_each_scrape_of_a_flood(self):
        self.at_work("--scenario", "flood", "--malformed-share", 0.2)
        seen = 0
        for _ in range(200):
            text = scrape(self.running, "/metrics")[1].decode()
            value = dict(re.findall(r"^(uplinkd_uplinks_\S+) (\S+)$", text, re.MULTILINE))
            received = float(value["uplinkd_uplinks_received_total"])
            settled = [float(number) for name, number in value.items() if "settled_total{" in name]
            self.assertEqual(received, sum(settled) + float(value["uplinkd_uplinks_in_flight"]))
            seen = max(seen, received)
        self.assertGreater(seen, 1000)

    def read_a_broker(self):
        """From here on the server is one that reads a broker and takes the calls of drones; what publishes to the
        broker."""
        broker = Mosquitto(self.folder)
        self.open_things.append(broker)
        broker.start()
        settings = SETTINGS.format(port=broker.port, prefixes='""', media="off")
        self.running = Server(self.folder / "reading", settings + UNCREW)
        self.open_things.append(self.running)
        self.running.start()
        client = Client(broker.port, "twin")
        self.open_things.append(client)
        return client

    def test_a_real_prometheus_answers_the_questions(self):
        twin = self.read_a_broker()
        fleet = self.at_work()
        drones = self.fleet(self.running, "--protocol", "uncrew", "--robots", DRONES)
        prometheus = Prometheus(self.folder, self.running)
        self.open_things.append(prometheus)
        # A rate has to see that it grows.
        prometheus.wait_for_value("uplinkd_mqtt_ack_seconds_count", 0)
        prometheus.wait_for_value('uplinkd_mqtt_connected{connection="durable"}', 1)
        twin.publish(topic(A, "event"), event(1), qos=1)
        prometheus.wait_for_value("sum(rcan_robot_online)", ROBOTS + DRONES)
        ((_, battery),) = prometheus.wait_for("avg(rcan_robot_battery_pct)")
        self.assertTrue(0 < battery <= 100, battery)
        joints = prometheus.wait_for('rcan_acb_position_rad{joint="shoulder_pan"}')
        self.assertEqual(len(joints), ROBOTS)
        self.assertEqual(
            {labels["ruri"].rsplit("/", 1)[1] for labels, _ in joints}, {f"robot-{n + 1:04}" for n in range(ROBOTS)}
        )
        for expression in expressions_of_the_guide() + dashboards.expressions():
            with self.subTest(expression):
                prometheus.wait_for(expression)
        for series, label in dashboards.series_of_variables():
            values = prometheus.get(f"/api/v1/label/{label}/values", **{"match[]": series})
            self.assertTrue(values, (series, label))
            if label == "instance":
                self.assertEqual(values, [self.running.http])
        for rule in self.rules(prometheus, "recording"):
            with self.subTest(rule):
                prometheus.wait_for(rule)
        for group in prometheus.get("/api/v1/rules")["groups"]:
            for rule in group["rules"]:
                self.assertEqual((rule["health"], rule.get("lastError")), ("ok", None), rule["name"])
        self.assert_agrees(drones)
        self.assert_agrees(fleet)

    @staticmethod
    def rules(prometheus, kind):
        groups = prometheus.get("/api/v1/rules")["groups"]
        return [rule["name"] for group in groups for rule in group["rules"] if rule["type"] == kind]

    def test_handshakes_that_fail_and_ends_of_streams_are_counted(self):
        with socket_to(self.running.relay) as plain:
            plain.sendall(b"GET / HTTP/1.1\r\n\r\n")
            while plain.recv(1024):
                pass
        wait_until(
            self.running.process, lambda: self.running.metric("uplinkd_handshakes_failed_total") == 1,
            WAIT_SECONDS, "the handshake is counted",
        )  # fmt: skip
        fleet = self.at_work()
        self.assert_agrees(fleet)
        self.assertGreaterEqual(self.running.metric('uplinkd_streams_ended_total{code="ok"}'), ROBOTS)


class Files(unittest.TestCase):
    """What is deployed beside the program."""

    def test_rules_fire_and_are_silent(self):
        run("promtool", "check", "config", SOURCE / "deploy/prometheus/prometheus.yml")
        for file in ("rules_test.yml", "usual_test.yml"):
            run("promtool", "test", "rules", SOURCE / "tests/prometheus" / file, timeout=300)

    def test_each_alert_is_tried_firing_and_silent(self):
        rules = (SOURCE / "deploy/prometheus/alerts.rules.yml").read_text(encoding="utf-8")
        tried = (SOURCE / "tests/prometheus/rules_test.yml").read_text(encoding="utf-8")
        silence, firing = tried.split("- name: everything fires", 1)
        for alert in re.findall(r"alert: (\w+)", rules):
            self.assertIn(f"alertname: {alert}}}\n", silence)
            self.assertRegex(firing, rf"alertname: {alert}\n +exp_alerts:\n +- exp_labels")

    def test_each_alert_has_its_section_of_the_page_of_alerts(self):
        rules = (SOURCE / "deploy/prometheus/alerts.rules.yml").read_text(encoding="utf-8")
        alerts = re.findall(r"alert: (\w+)", rules)
        self.assertGreater(len(alerts), 5)
        page = ALERTS.read_text(encoding="utf-8")
        for alert in alerts:
            self.assertIn(f"\n### {alert}\n", page)
            self.assertIn(f"docs/operate/alerts.md#{alert.lower()}\n", rules)

    def test_the_tables_of_the_reference_are_the_programs(self):
        table = run(BIN / "uplinkd", "--print-metrics").stdout
        ours = (SOURCE / "docs/reference/metrics.md").read_text(encoding="utf-8")
        robots = (SOURCE / "docs/reference/rcan.md").read_text(encoding="utf-8")
        first, second = table.split("\n\n", 1)
        self.assertIn(first.strip(), ours)
        self.assertIn(second.strip(), robots)

    def test_the_unit_is_clean(self):
        unit = (SOURCE / "deploy/systemd/uplinkd.service").read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "uplinkd.service"
            path.write_text(unit.replace("/usr/bin/uplinkd", str(BIN / "uplinkd")), encoding="utf-8")
            done = run("systemd-analyze", "verify", "--man=no", path)
            self.assertEqual(done.stdout + done.stderr, "")
        for bound in ("WatchdogSec=30", "MemoryMax=75%", "TasksMax=512", "LimitCORE=0", "PrivateUsers=yes",
                      "ProcSubset=pid", "Environment=UPLINK_BOOT_ID=%b"):  # fmt: skip
            self.assertIn(f"\n{bound}\n", unit)

    def test_its_user_is_made(self):
        with tempfile.TemporaryDirectory() as root:
            files = pathlib.Path(root) / "usr/lib/sysusers.d"
            files.mkdir(parents=True)
            (pathlib.Path(root) / "etc").mkdir()
            text = (SOURCE / "deploy/systemd/uplinkd.sysusers.conf").read_text(encoding="utf-8")
            (files / "uplinkd.conf").write_text(text, encoding="utf-8")
            run("systemd-sysusers", f"--root={root}")
            users = (pathlib.Path(root) / "etc/passwd").read_text(encoding="utf-8")
            self.assertRegex(users, r"(?m)^uplinkd:.*:/var/lib/uplinkd:")


def socket_to(address):
    host, port = address.rsplit(":", 1)
    return socket.create_connection((host, int(port)), timeout=WAIT_SECONDS)


if __name__ == "__main__":
    unittest.main()
