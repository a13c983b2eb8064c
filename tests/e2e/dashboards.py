"""The dashboards that are deployed, as their JSON says."""

import json
import re

from harness import SOURCE

FILES = sorted((SOURCE / "deploy/grafana").glob("*.json"))
# $instance, ${instance}, $__rate_interval.
VARIABLE = re.compile(r"\$(?:\{(\w+)[^}]*\}|(\w+))")
INTERVALS = {"__rate_interval", "__interval", "__range"}


def dashboards():
    assert FILES, "deploy/grafana has no dashboard"
    return {path.name: json.loads(path.read_text(encoding="utf-8")) for path in FILES}


def panels_of(dashboard):
    """All panels, also those that lie in a row that is folded up."""
    for panel in dashboard["panels"]:
        yield panel
        yield from panel.get("panels", [])


def with_all_chosen(expression):
    """The expression as Grafana sends it while each variable has `All`."""

    def value(found):
        return "5m" if (found[1] or found[2]) in INTERVALS else ".*"

    return VARIABLE.sub(value, expression)


def expressions():
    """Of all panels of all dashboards."""
    return [
        with_all_chosen(target["expr"])
        for dashboard in dashboards().values()
        for panel in panels_of(dashboard)
        for target in panel.get("targets", [])
    ]


def series_of_variables():
    """The series of whose labels a variable takes its values: series and label, while the variables before it have
    `All`."""
    return [
        re.fullmatch(r"label_values\((.+), *(\w+)\)", with_all_chosen(variable["query"])).groups()
        for dashboard in dashboards().values()
        for variable in dashboard["templating"]["list"]
        if variable["type"] == "query"
    ]
