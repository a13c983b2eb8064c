"""Scrapes the servers of the crash campaign with a broker (broker_chaos.py) all the time, and holds
them to the law of messages: received = what they became + in flight."""

import http.client
import re
import threading
import urllib.error
import urllib.request

EVERY_SECONDS = 0.2
ANSWER_SECONDS = 5
NUMBERS = re.compile(
    r"^uplinkd_mqtt_(messages_[a-z_]+|lease_held|connected)(?:\{[^}]*\})? (\S+)$", re.MULTILINE
)


def scrape(server):
    """Sums over labels, by what follows `uplinkd_mqtt_`; nothing while the server cannot be reached."""
    try:
        with urllib.request.urlopen(f"http://{server.http}/metrics", timeout=ANSWER_SECONDS) as page:
            text = page.read().decode()
    except (OSError, urllib.error.URLError, http.client.HTTPException):
        return None
    sums = {}
    for name, value in NUMBERS.findall(text):
        sums[name] = sums.get(name, 0) + float(value)
    return sums if "messages_received_total" in sums else None


def breach(sums):
    """What is wrong of one scrape; empty if nothing is."""
    received, settled = sums["messages_received_total"], sums["messages_settled_total"]
    in_flight = sums["messages_in_flight"]
    if in_flight >= 0 and received == settled + in_flight:
        return ""
    return f"received {received:.0f}, settled {settled:.0f}, in flight {in_flight:.0f}"


class Watch:
    def __init__(self, servers):
        self.servers = servers
        self.scrapes = 0
        self.breaches = []
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)

    def start(self):
        self.thread.start()

    def run(self):
        while not self.ended.wait(EVERY_SECONDS):
            for server in self.servers:
                sums = scrape(server)
                if sums is None:
                    continue
                self.scrapes += 1
                if wrong := breach(sums):
                    self.breaches.append(f"{server.folder.name}: {wrong}")

    def close(self):
        self.ended.set()
        if self.thread.is_alive():
            self.thread.join(4 * ANSWER_SECONDS)
