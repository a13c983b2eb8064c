"""The chart, the image and the compose files agree with the program and with each other.

What helm makes of the chart is looked at by tests/deploy/test_chart.py.
"""

import json
import pathlib
import re
import sys

from tree import Finding

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools/dev"))

import chart_readme  # noqa: E402

CHART = "deploy/helm/uplinkd/"
SCHEMA, VALUES, README, YAML = (
    CHART + name for name in ("values.schema.json", "values.yaml", "README.md", "Chart.yaml")
)
HELPERS = CHART + "templates/_helpers.tpl"
EXAMPLE = "deploy/uplinkd.toml"
COMPOSE = "deploy/compose/compose.yaml"
# Sections that the chart writes itself.
OWN_SECTIONS = {"listen", "tls"}
SECTION = re.compile(r"^\[([a-z0-9_]+)\]", re.MULTILINE)
VERSION = re.compile(r"^project\(uplinkd VERSION ([0-9.]+)", re.MULTILINE)
# (file, pattern of a version in it)
VERSIONS = (
    (YAML, re.compile(r'^(?:version|appVersion): "?([^"\n]+)', re.MULTILINE)),
    (COMPOSE, re.compile(r"image: uplinkd:(\S+)")),
)
METRICS = re.compile(r'metrics"? =? ?"\[::\]:(\d+)"')
# (file, pattern of the port of listen.metrics in it), the first as uplinkd of the chart has it
PORTS = (
    (HELPERS, METRICS),
    (CHART + "templates/statefulset.yaml", re.compile(r"name: metrics\n +containerPort: (\d+)")),
    (CHART + "templates/service.yaml", re.compile(r"name: metrics\n +port: (\d+)")),
    ("deploy/container/uplinkd.toml", METRICS),
    ("deploy/container/Dockerfile", re.compile(r"^EXPOSE 7443 (\d+)$", re.MULTILINE)),
    ("deploy/compose/prometheus.yml", re.compile(r'"uplinkd:(\d+)"')),
)


def _same(tree, rule, wanted, places):
    """Each pattern finds something in its file, and only what is wanted."""
    for path, pattern in places:
        found = set(pattern.findall(tree.text(path)))
        if found != {wanted}:
            yield Finding(path, 1, rule, f"it has {', '.join(sorted(found)) or 'none'}, not {wanted}")


def versions(tree):
    """Chart and compose files name the version of CMakeLists.txt."""
    found = VERSION.findall(tree.text("CMakeLists.txt"))
    if len(found) != 1:
        yield Finding("CMakeLists.txt", 1, "version", "project(uplinkd VERSION ...) names none")
    else:
        yield from _same(tree, "version", found[0], VERSIONS)


def ports(tree):
    """Who reaches listen.metrics reaches it at one port."""
    path, pattern = PORTS[0]
    found = pattern.findall(tree.text(path))
    if len(found) != 1:
        yield Finding(path, 1, "port", "listen.metrics has no port here: the pattern is out of date")
    else:
        yield from _same(tree, "port", found[0], PORTS[1:])


def sections(tree):
    """The chart's values take every section of the configuration, and no other."""
    known = set(SECTION.findall(tree.text(EXAMPLE)))
    taken = json.loads(tree.text(SCHEMA))["properties"]["config"]["properties"].keys() | OWN_SECTIONS
    for section in sorted(known - taken):
        yield Finding(SCHEMA, 1, "chart-section", f"config lacks [{section}] of {EXAMPLE}")
    for section in sorted(taken - known):
        yield Finding(SCHEMA, 1, "chart-section", f"[{section}] is not in {EXAMPLE}")


def readme(tree):
    """The chart's page has what the comments of values.yaml say."""
    try:
        made = chart_readme.page(tree.text(README), tree.text(VALUES))
    except chart_readme.Wrong as wrong:
        yield Finding(VALUES, 1, "chart-readme", str(wrong))
        return
    if made != tree.text(README):
        yield Finding(README, 1, "chart-readme", "not what values.yaml says: run tools/dev/chart_readme.py")
