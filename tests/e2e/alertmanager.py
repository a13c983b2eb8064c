"""A real Alertmanager, and the webhook that it delivers to."""

import http.server
import json
import subprocess
import threading
import urllib.request

from harness import wait_until
from ports import free_port

START_SECONDS = 60
DELIVERY_SECONDS = 60

CONFIGURATION = """
route:
  receiver: webhook
  group_by: [alertname, instance]
  group_wait: 0s
  group_interval: 1s
receivers:
  - name: webhook
    webhook_configs:
      - url: http://{webhook}/
        send_resolved: true
"""


class Webhook:
    """Keeps what is posted to it."""

    def __init__(self):
        kept = self.kept = []

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                kept.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
                self.send_response(200)
                self.end_headers()

            def log_message(self, *arguments):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.address = f"127.0.0.1:{self.server.server_port}"
        self.thread = threading.Thread(target=self.server.serve_forever)
        self.thread.start()

    def close(self):
        self.server.shutdown()
        self.thread.join()
        self.server.server_close()


class Alertmanager:
    def __init__(self, folder):
        self.webhook = Webhook()
        self.folder = folder / "alertmanager"
        self.folder.mkdir()
        self.address = f"127.0.0.1:{free_port()}"
        path = self.folder / "alertmanager.yml"
        path.write_text(CONFIGURATION.format(webhook=self.webhook.address), encoding="utf-8")
        self.log = (self.folder / "log").open("wb")
        self.process = subprocess.Popen(
            ["prometheus-alertmanager", f"--config.file={path}", f"--storage.path={self.folder / 'data'}",
             f"--web.listen-address={self.address}", "--cluster.listen-address="],
            stdout=self.log, stderr=subprocess.STDOUT,
        )  # fmt: skip
        wait_until(self.process, self.ready, START_SECONDS, "Alertmanager is ready")

    def ready(self):
        try:
            with urllib.request.urlopen(f"http://{self.address}/-/ready", timeout=5) as answer:
                return answer.status == 200
        except OSError:
            return False

    def wait_for(self, name, status):
        """What the webhook got of this alert in this status: `firing` or `resolved`."""

        def look():
            alerts = [alert for group in list(self.webhook.kept) for alert in group["alerts"]]
            return [alert for alert in alerts if (alert["labels"]["alertname"], alert["status"]) == (name, status)]

        return wait_until(self.process, look, DELIVERY_SECONDS, f"{name} is delivered as {status}")[0]

    def close(self):
        self.process.terminate()
        self.process.wait(30)
        self.log.close()
        self.webhook.close()
