"""What Grafana takes of the dashboards' JSON; test_metrics.py asks a real Prometheus for what they show."""

import re
import unittest

import dashboards

DATASOURCE = {"type": "prometheus", "uid": "${datasource}"}


class Dashboards(unittest.TestCase):
    def panels(self):
        """Each panel with what a failure says of it; rows show nothing."""
        for file, dashboard in dashboards.dashboards().items():
            for panel in dashboards.panels_of(dashboard):
                if panel["type"] != "row":
                    yield f"{file}: {panel.get('title')}", panel

    def test_ids_are_unique(self):
        every = dashboards.dashboards()
        self.assertEqual(len({dashboard["uid"] for dashboard in every.values()}), len(every))
        for file, dashboard in every.items():
            ids = [panel["id"] for panel in dashboards.panels_of(dashboard)]
            self.assertEqual(sorted(set(ids)), sorted(ids), file)

    def test_each_panel_has_a_title_a_unit_and_targets_of_its_own(self):
        for where, panel in self.panels():
            self.assertTrue(panel["title"], where)
            self.assertTrue(panel["fieldConfig"]["defaults"].get("unit"), where)
            targets = [target["refId"] for target in panel["targets"]]
            self.assertTrue(targets, where)
            self.assertEqual(sorted(set(targets)), sorted(targets), where)

    def test_what_is_asked_is_the_datasource_that_a_reader_chooses(self):
        for file, dashboard in dashboards.dashboards().items():
            variables = {variable["name"]: variable for variable in dashboard["templating"]["list"]}
            self.assertEqual(variables["datasource"]["query"], "prometheus", file)
            for variable in variables.values():
                if variable["type"] == "query":
                    self.assertEqual(variable["datasource"], DATASOURCE, file)
        for where, panel in self.panels():
            self.assertEqual(panel["datasource"], DATASOURCE, where)
            for target in panel["targets"]:
                self.assertEqual(target.get("datasource", DATASOURCE), DATASOURCE, where)

    def test_each_variable_of_an_expression_exists_and_servers_can_be_chosen(self):
        for file, dashboard in dashboards.dashboards().items():
            known = {variable["name"] for variable in dashboard["templating"]["list"]} | dashboards.INTERVALS
            for panel in dashboards.panels_of(dashboard):
                for target in panel.get("targets", []):
                    used = {one or other for one, other in dashboards.VARIABLE.findall(target["expr"])}
                    self.assertLessEqual(used, known, (file, target["expr"]))
                    self.assertIn("instance", used, (file, target["expr"]))

    def test_fleets_and_a_robot_have_a_page_with_a_map_and_can_be_chosen(self):
        every = dashboards.dashboards()
        for file, chosen in (("uplinkd-fleet.json", {"fleet"}), ("uplinkd-robot.json", {"fleet", "robot"})):
            variables = {variable["name"] for variable in every[file]["templating"]["list"]}
            self.assertLessEqual(chosen, variables, file)
            self.assertIn("geomap", {panel["type"] for panel in every[file]["panels"]}, file)
            used = " ".join(target["expr"] for panel in every[file]["panels"] for target in panel.get("targets", []))
            for name in chosen & {"robot"} or chosen:
                self.assertRegex(used, rf"\$\{{?{name}\b", file)

    def test_what_is_lost_or_grows_without_an_error_is_shown(self):
        shown = " ".join(dashboards.expressions())
        for name in ("live_bytes", "live_bytes_limit", "telemetry_over_rate_total", "store_wal_bytes",
                     "log_lines_waiting", "log_lines_dropped_total"):  # fmt: skip
            self.assertRegex(shown, rf"\buplinkd_{name}\{{")

    def test_no_panel_lies_on_another(self):
        for file, dashboard in dashboards.dashboards().items():
            taken = {}
            for panel in dashboard["panels"]:
                place = panel["gridPos"]
                self.assertLessEqual(place["x"] + place["w"], 24, (file, panel["title"]))
                for x in range(place["x"], place["x"] + place["w"]):
                    for y in range(place["y"], place["y"] + place["h"]):
                        self.assertNotIn((x, y), taken, (file, panel["title"]))
                        taken[x, y] = panel["title"]

    def test_a_variable_is_read_however_it_is_written(self):
        asked = 'rate(a{instance=~"$instance",b=~"${b:regex}"}[$__rate_interval])'
        self.assertEqual(dashboards.with_all_chosen(asked), 'rate(a{instance=~".*",b=~".*"}[5m])')
        self.assertFalse(re.search(r"\$", " ".join(dashboards.expressions())))


if __name__ == "__main__":
    unittest.main()
