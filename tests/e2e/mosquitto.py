"""A mosquitto with a folder of its own, which loses nothing as long as it is ended in order."""

import signal
import socket
import subprocess

from harness import START_SECONDS, wait_until
from ports import free_port

PROGRAM = "/usr/sbin/mosquitto"
STOP_SECONDS = 30
# Its queue is far above what the tests publish while uplinkd does not read, its window above uplinkd's.
CONFIGURATION = """user root
listener {port} 127.0.0.1
allow_anonymous true
persistence true
persistence_location {folder}/
max_queued_messages 1000000
max_inflight_messages 4096
set_tcp_nodelay true
log_dest file {folder}/mosquitto.log
log_type error
log_type warning
log_type notice
connection_messages true
"""


class Mosquitto:
    """`lines` are added to its configuration."""

    def __init__(self, folder, lines=""):
        self.folder = folder / "mosquitto"
        self.folder.mkdir()
        self.port = free_port()
        self.configuration = self.folder / "mosquitto.conf"
        self.configuration.write_text(
            CONFIGURATION.format(port=self.port, folder=self.folder) + lines, encoding="utf-8"
        )
        self.process = None

    def start(self):
        with (self.folder / "output.log").open("ab") as output:
            self.process = subprocess.Popen(
                [PROGRAM, "-c", str(self.configuration)], stdout=output, stderr=output
            )
        wait_until(self.process, self.answers, START_SECONDS, "mosquitto listens")
        return self

    def answers(self):
        try:
            socket.create_connection(("127.0.0.1", self.port), 1).close()
        except OSError:
            return False
        return True

    def stop(self):
        """In order: it saves its sessions and what it keeps for them."""
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(STOP_SECONDS)

    def restart(self):
        self.stop()
        self.start()

    def restart_without_memory(self):
        """Every session, and what waited in it, is gone."""
        self.stop()
        (self.folder / "mosquitto.db").unlink()
        self.start()

    def close(self):
        if self.process is not None and self.process.poll() is None:
            self.process.kill()
            self.process.wait(STOP_SECONDS)
