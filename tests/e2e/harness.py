"""What the end-to-end tests share: the real programs, started in a folder of their own.

Nothing here sleeps: waiting is done on a process, with a deadline, and a server that dies while it
is waited for is a failure with its log.
"""

import datetime
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

BIN = pathlib.Path(os.environ["UPLINK_BIN_DIR"])
SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests/support"))
from waiting import wait_until  # noqa: E402

POSTGRES = SOURCE / "tools/dev/postgres.sh"
START_SECONDS = 30
LINE_SECONDS = 10
BREAKS = re.compile(r"(\d+) breaks")
LISTENING = re.compile(r" listening .*?relay=\"?([^ \"]+)\"? http=\"?([^ \"]+)\"?")


def run(*arguments, code=0, timeout=60, env=None):
    """Runs a program to its end; anything but the expected exit code fails, with its output."""
    done = subprocess.run(
        [str(argument) for argument in arguments],
        capture_output=True, text=True, timeout=timeout, env=env, check=False,
    )  # fmt: skip
    if done.returncode != code:
        raise AssertionError(
            f"{arguments} ended with {done.returncode}, not {code}\n{done.stdout}\n{done.stderr}"
        )
    return done


def uplinkctl(*arguments, code=0, env=None):
    return run(BIN / "uplinkctl", *arguments, code=code, env=env)


def unix_us(text):
    """The Unix microseconds of a time in an answer."""
    since = datetime.datetime.fromisoformat(text) - datetime.datetime.fromtimestamp(0, datetime.timezone.utc)
    return since // datetime.timedelta(microseconds=1)


class Server:
    """An uplinkd with its store in `folder`. The ports of the first start are kept."""

    def __init__(self, folder, settings="", store_url=None, environment=None):
        self.store_url = store_url or f"sqlite://{folder}/uplinkd.db"
        self.folder = pathlib.Path(folder)
        self.pki = self.folder / "pki"
        self.relay = self.http = "127.0.0.1:0"
        self.settings = settings
        self.program = BIN / "uplinkd"
        # What runs it in its own place (unshare, prlimit).
        self.wrapper = []
        self.environment = environment or {}
        self.starts = 0
        self.process = None
        if not self.pki.exists():
            self.uplinkctl("pki", "init", "--dir", self.pki)
            self.uplinkctl("pki", "server", "--dir", self.pki, "--host", "localhost", "--host", "127.0.0.1")

    def uplinkctl(self, *arguments):
        """In the server's environment."""
        return uplinkctl(*arguments, env={**os.environ, **self.environment})

    def configuration(self):
        path = self.folder / "uplinkd.toml"
        path.write_text(
            f"""
[listen]
relay = "{self.relay}"
http = "{self.http}"
[tls]
certificate_file = "{self.pki}/server.crt"
key_file = "{self.pki}/server.key"
client_ca_file = "{self.pki}/ca.crt"
[store]
url = "{self.store_url}"
{self.settings}
""",
            encoding="utf-8",
        )
        return path

    def start(self):
        self.starts += 1
        self.log = self.folder / f"uplinkd-{self.starts}.log"
        with self.log.open("wb") as log:
            self.process = subprocess.Popen(
                [*self.wrapper, str(self.program), "--config", str(self.configuration())],
                stdout=log, stderr=subprocess.STDOUT, env={**os.environ, **self.environment},
            )  # fmt: skip
        try:
            found = wait_until(
                self.process, lambda: LISTENING.search(self.text()), START_SECONDS, "uplinkd listens"
            )
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.text()}") from None
        self.relay, self.http = found.group(1), found.group(2)
        return self

    def text(self):
        return self.log.read_text(encoding="utf-8", errors="replace")

    def wait_for_line(self, part):
        """Waits until the log has this: a thread of its own writes it, after what it is about."""
        wait_until(self.process, lambda: part in self.text(), LINE_SECONDS, f"a line with {part}")

    def get(self, path):
        """The JSON of a path; None while the server cannot be reached."""
        try:
            with urllib.request.urlopen(f"http://{self.http}{path}", timeout=10) as answer:
                return json.load(answer)
        except (urllib.error.URLError, ConnectionError, TimeoutError):
            return None

    def metric(self, name):
        """The value of a metric without labels."""
        with urllib.request.urlopen(f"http://{self.http}/metrics", timeout=10) as page:
            return float(re.search(rf"^{name} (.*)$", page.read().decode(), re.MULTILINE).group(1))

    def wait_for_status(self, condition, seconds, what):
        """Waits until the status meets the condition; 64-bit numbers come as texts in JSON."""

        def look():
            status = self.get("/api/v1/status")
            return status if status and condition(status) else None

        return wait_until(self.process, look, seconds, what)

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait(30)

    def terminate(self, seconds):
        """Asks it to drain; gives its exit code."""
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(seconds)

    def close(self):
        if self.process is not None and self.process.poll() is None:
            self.kill()


def place_in(state):
    """Where a cluster is, by its state file."""
    return dict(line.split("=", 1) for line in state.read_text(encoding="utf-8").splitlines())


class Cluster:
    """A private PostgreSQL cluster; `configuration` is added to its postgresql.conf."""

    def __init__(self, folder, configuration=""):
        self.state = folder / "postgres.state"
        run(POSTGRES, "start", self.state, timeout=120,
            env=dict(os.environ, UPLINK_POSTGRES_CONF=configuration))  # fmt: skip
        self.place = place_in(self.state)

    def url(self, role, database="uplinkd"):
        return f"postgresql://{role}@/{database}?host={self.place['folder']}&port={self.place['port']}"

    def sql(self, text, database="uplinkd"):
        return run("psql", "-X", "-q", "-A", "-t", "-v", "ON_ERROR_STOP=1", "-c", text,
                   self.url("postgres", database)).stdout.strip()  # fmt: skip

    def create(self):
        """The database, without a schema."""
        self.sql("CREATE DATABASE uplinkd OWNER uplinkd_owner", "postgres")
        return self

    def migrate(self, programs=BIN):
        run(programs / "uplinkctl", "store", "migrate", "--url", self.url("uplinkd_owner"), "--grant-to", "uplinkd")
        return self

    def crash(self):
        """Stops it at once, as a crash does, and starts it again."""
        run(POSTGRES, "crash", self.state)

    def halt(self):
        """Stops it at once and leaves it so."""
        run(POSTGRES, "halt", self.state)

    def close(self):
        run(POSTGRES, "stop", self.state)


class Standby(Cluster):
    """A copy that follows another cluster until it is promoted."""

    def __init__(self, folder, primary):
        self.state = folder / "standby.state"
        run(POSTGRES, "standby", self.state, primary.state, timeout=120)
        self.place = place_in(self.state)

    def promote(self):
        run(POSTGRES, "promote", self.state)


class Fleet:
    """An uplink-fleet that runs until it is told to finish; `target` is what leads to the server's relay, and
    `environment` is added to its own."""

    def __init__(self, server, *flags, target=None, environment=None):
        self.folder = server.folder
        self.progress = (self.folder / "fleet.log").open("wb")
        self.process = subprocess.Popen(
            [str(BIN / "uplink-fleet"), "--target", target or server.relay, "--http", server.http,
             "--pki", str(server.pki), "--report", "json", "--for", "1h", *map(str, flags)],
            stdout=subprocess.PIPE, stderr=self.progress, env={**os.environ, **(environment or {})},
        )  # fmt: skip

    def log(self):
        return (self.folder / "fleet.log").read_text(encoding="utf-8", errors="replace")

    def breaks(self):
        """Streams that it broke off, by its last line of progress."""
        found = BREAKS.findall(self.log())
        return int(found[-1]) if found else 0

    def finish(self, seconds=120):
        """Ends the run, lets it settle and verify; gives exit code and report."""
        self.process.send_signal(signal.SIGINT)
        output, _ = self.process.communicate(timeout=seconds)
        try:
            return self.process.returncode, json.loads(output)
        except ValueError:
            raise AssertionError(
                f"uplink-fleet ended with {self.process.returncode}: {self.log()[-2000:]}"
            ) from None

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate(timeout=30)
        self.process.stdout.close()
        self.progress.close()


def mismatches(report):
    return [check for check in report["checks"] if not check["ok"]]


class EndToEnd(unittest.TestCase):
    """A folder of its own, kept if the test fails."""

    maxDiff = None

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="uplink-e2e-"))
        self.open_things = []
        # Also when a setUp fails.
        self.addCleanup(self.clean_up)

    def clean_up(self):
        for thing in reversed(self.open_things):
            thing.close()
        # Errors of this test alone: unittest keeps them by test.
        result = self._outcome.result
        if any(test is self for test, _ in (*result.errors, *result.failures)):
            print(f"kept: {self.folder}")
        else:
            shutil.rmtree(self.folder)

    def server(self, settings=""):
        server = Server(self.folder, settings)
        self.open_things.append(server)
        return server

    def fleet(self, server, *flags, **given):
        fleet = Fleet(server, *flags, **given)
        self.open_things.append(fleet)
        return fleet

    def assert_agrees(self, fleet):
        code, report = fleet.finish()
        self.assertEqual(mismatches(report), [], report["run"])
        self.assertEqual(code, 0)
        self.assertTrue(report["ok"])
        return report
