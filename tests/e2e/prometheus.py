"""A real Prometheus that scrapes a server with the deployed configuration, faster."""

import json
import math
import re
import subprocess
import urllib.parse
import urllib.request

from harness import SOURCE, wait_until
from ports import free_port

START_SECONDS = 60
DEPLOY = SOURCE / "deploy/prometheus"


def deployed(target, alertmanager=None, through=None):
    """The deployed configuration, but for the addresses and faster. `through`: the proxy that it asks."""
    config = (DEPLOY / "prometheus.yml").read_text(encoding="utf-8")
    assert "127.0.0.1:7480" in config
    config = config.replace("127.0.0.1:7480", target)
    config = re.sub(r"(scrape_interval|evaluation_interval|scrape_timeout): \w+", r"\1: 1s", config)
    if alertmanager:
        commented = re.search(r"(?m)^# alerting:\n(#  .*\n)+", config).group()
        config = config.replace(commented, re.sub(r"(?m)^# ", "", commented))
        assert "127.0.0.1:9093" in config
        config = config.replace("127.0.0.1:9093", alertmanager)
    if through:
        config = re.sub(r"(?m)^( +)static_configs:", rf"\1proxy_url: http://{through}\n\1static_configs:", config)
    return config


class Prometheus:
    """`target`: what it scrapes, if not listen.http. With an Alertmanager alerts fire at once."""

    def __init__(self, folder, server, target=None, alertmanager=None, through=None):
        self.folder = folder / "prometheus"
        self.folder.mkdir()
        self.address = f"127.0.0.1:{free_port()}"
        config = deployed(target or server.http, alertmanager, through)
        for rules in DEPLOY.glob("*.rules.yml"):
            text = rules.read_text(encoding="utf-8")
            if alertmanager:
                text = re.sub(r"(?m)^( +for): \w+$", r"\1: 0s", text)
            (self.folder / rules.name).write_text(text, encoding="utf-8")
        path = self.folder / "prometheus.yml"
        path.write_text(config, encoding="utf-8")
        self.log = (self.folder / "log").open("wb")
        self.process = subprocess.Popen(
            ["prometheus", f"--config.file={path}", f"--storage.tsdb.path={self.folder / 'data'}",
             f"--web.listen-address={self.address}"],
            stdout=self.log, stderr=subprocess.STDOUT,
        )  # fmt: skip
        wait_until(self.process, self.ready, START_SECONDS, "Prometheus is ready")

    def ready(self):
        try:
            with urllib.request.urlopen(f"http://{self.address}/-/ready", timeout=5) as answer:
                return answer.status == 200
        except OSError:
            return False

    def get(self, path, **parameters):
        url = f"http://{self.address}{path}?{urllib.parse.urlencode(parameters)}"
        with urllib.request.urlopen(url, timeout=10) as answer:
            return json.loads(answer.read())["data"]

    def query(self, expression):
        """The samples of an instant query: labels and value."""
        data = self.get("/api/v1/query", query=expression)
        assert data["resultType"] == "vector", (expression, data["resultType"])
        return [(sample["metric"], float(sample["value"][1])) for sample in data["result"]]

    def wait_for(self, expression, seconds=60):
        """The first answer with a number in it."""
        return wait_until(
            self.process,
            lambda: [sample for sample in self.query(expression) if not math.isnan(sample[1])],
            seconds, f"an answer to {expression}",
        )  # fmt: skip

    def wait_for_value(self, expression, value, seconds=60):
        return wait_until(
            self.process,
            lambda: [sample for sample in self.query(expression) if sample[1] == value],
            seconds, f"{expression} is {value}",
        )  # fmt: skip

    def close(self):
        self.process.terminate()
        self.process.wait(30)
        self.log.close()
