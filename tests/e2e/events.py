"""A client of /api/v1/watch: server-sent events as they come."""

import http.client
import json

READ_SECONDS = 60


class Events:
    """One watch; a context manager."""

    def __init__(self, address, path="/api/v1/watch", token=None, last_id=None):
        headers = {"Accept": "text/event-stream"}
        if token:
            headers["Authorization"] = f"Bearer {token}"
        if last_id:
            headers["Last-Event-ID"] = last_id
        self.connection = http.client.HTTPConnection(address, timeout=READ_SECONDS)
        self.connection.request("GET", path, headers=headers)
        self.answer = self.connection.getresponse()
        self.last_id = None
        self.comments = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.answer.close()
        self.connection.close()

    def __iter__(self):
        """Name and data of each event; comments are counted alone."""
        name, data = None, []
        for line in self.answer:
            text = line.decode().rstrip("\n")
            if text.startswith("event: "):
                name = text.removeprefix("event: ")
            elif text.startswith("data: "):
                data.append(text.removeprefix("data: "))
            elif text.startswith("id: "):
                self.last_id = text.removeprefix("id: ")
            elif text.startswith(":"):
                self.comments += 1
            elif not text and name:
                yield name, json.loads("\n".join(data))
                name, data = None, []

    def until(self, condition):
        """The data of the first event that meets it, by name and data; None if the watch ends first."""
        return next((data for name, data in self if condition(name, data)), None)

    def snapshot(self):
        """The robots of the snapshot by RURI."""
        robots = {}
        for name, data in self:
            if name == "snapshotEnd":
                assert int(data["snapshotEnd"]["robots"]) == len(robots), data
                break
            robots[data["robot"]["ruri"]] = data["robot"]
        return robots
