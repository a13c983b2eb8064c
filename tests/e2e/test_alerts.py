"""An alert from a real server by way of a real Prometheus and Alertmanager to a webhook."""

import unittest

from alertmanager import Alertmanager
from harness import SOURCE, EndToEnd, run
from prometheus import Prometheus, deployed


class Alerts(EndToEnd):
    def test_one_is_delivered_and_resolved(self):
        server = self.server().start()
        alertmanager = Alertmanager(self.folder)
        self.open_things.append(alertmanager)
        prometheus = Prometheus(self.folder, server, alertmanager=alertmanager.address)
        self.open_things.append(prometheus)
        prometheus.wait_for_value("sum(up)", 2)
        server.kill()
        told = alertmanager.wait_for("UplinkdDown", "firing")
        self.assertEqual(told["labels"]["severity"], "page")
        self.assertEqual(told["labels"]["instance"], server.http)
        self.assertIn(server.http, told["annotations"]["summary"])
        page, anchor = told["annotations"]["runbook"].split("#")
        headings = (SOURCE / page).read_text(encoding="utf-8").lower()
        self.assertIn(f"\n### {anchor}\n", headings)
        server.start()
        alertmanager.wait_for("UplinkdDown", "resolved")

    def test_promtool_takes_the_deployed_configuration_with_an_alertmanager(self):
        for rules in (SOURCE / "deploy/prometheus").glob("*.rules.yml"):
            (self.folder / rules.name).write_bytes(rules.read_bytes())
        path = self.folder / "prometheus.yml"
        path.write_text(deployed("127.0.0.1:1", alertmanager="127.0.0.1:2"), encoding="utf-8")
        self.assertIn("127.0.0.1:2", path.read_text(encoding="utf-8"))
        run("promtool", "check", "config", path)


if __name__ == "__main__":
    unittest.main()
