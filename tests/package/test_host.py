"""The packages on a machine with a real systemd, in the order in which an operator meets it: installed,
configured, started, in trouble, upgraded, removed, purged."""

import os
import pathlib
import re
import shutil
import signal
import tempfile
import time
import unittest

from base import Base
from machine import Machine
from repacked import repacked

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PACKAGES = pathlib.Path(os.environ["UPLINK_PACKAGES"])
CACHE = pathlib.Path(os.environ["UPLINK_PACKAGE_CACHE"])
UNIT = "uplinkd.service"
ROBOTS = 50
START_SECONDS = 30
# WatchdogSec, RestartSec, and time to spare on a busy machine.
WATCHDOG_SECONDS = 30 + 5 + 60
FLEET_SECONDS = 180
KEYS = ("server.crt", "server.key", "ca.crt")
INSTALL_PAGE = SOURCE / "docs/operate/install.md"
BLOCK = re.compile(r"^```\n(.*?)^```$", re.MULTILINE | re.DOTALL)
EXPOSURE_MAX_TENTHS = 15


def block(beginning):
    """The commands of the page that begin so, with this machine's places."""
    text = next(each for each in BLOCK.findall(INSTALL_PAGE.read_text(encoding="utf-8")) if each.startswith(beginning))
    for there, here in (("uplink.example.org", "127.0.0.1"), ("apt-get install ./", "apt-get -q -y install ./")):
        text = text.replace(there, here)
    return text


def package(name):
    found = sorted(PACKAGES.glob(f"{name}_*.deb"))
    if len(found) != 1:
        raise AssertionError(f"{PACKAGES} has {len(found)} packages {name}: ./dev package")
    return found[0]


class Host(unittest.TestCase):
    """Each test goes on where the one before it ended."""

    broken = False

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="uplinkd-host-"))
        cls.machine = Machine(cls.folder / "root")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.addClassCleanup(cls.machine.remove)
        packages = [package("uplinkd"), package("uplinkd-tools")]
        cls.began = time.monotonic()
        Base(CACHE).root(cls.machine.root, packages)
        changes = [("etc/uplinkd/uplinkd.toml", "# A later version's line.\n")]
        nexts = [repacked(packages[0], cls.folder, "99.0.0", changes),
                 repacked(packages[1], cls.folder, "99.0.0")]  # fmt: skip
        for each in nexts:
            each.rename(cls.machine.root / "srv" / each.name)
        cls.next_names = [f"/srv/{each.name}" for each in nexts]
        cls.machine.boot()

    def setUp(self):
        if Host.broken:
            self.fail("an earlier step failed")

    def run(self, result=None):
        before = len(result.failures) + len(result.errors)
        done = super().run(result)
        if not Host.broken and len(result.failures) + len(result.errors) > before:
            Host.broken = True
            print(self.machine.run("systemctl", "status", "-n", "40", "--no-pager", UNIT, code=None).stdout)
        return done

    def apt(self, *arguments):
        return self.machine.run("apt-get", "-q", "-y", *arguments).stdout

    def follow(self, beginning):
        """What the commands of the page say; they run in /srv, where the packages lie."""
        return self.machine.run("sh", "-euc", "cd /srv\n" + block(beginning)).stdout

    def pid(self):
        return int(self.machine.show(UNIT, "MainPID"))

    def ready(self):
        return '"degraded"' in self.machine.get("/readyz")

    def wait_ready(self):
        self.machine.wait_until(self.ready, START_SECONDS, "the server is ready")

    def fleet(self, seconds, name):
        """A fleet that streams for so long, beside the test; and where its report goes."""
        report = self.folder / f"{name}.txt"
        process = self.machine.start(
            "uplink-fleet", "--pki", "/srv/pki", "--target", "127.0.0.1:7443", "--http", "127.0.0.1:7480",
            "--robots", ROBOTS, "--for", f"{seconds}s", "--seed", len(name), output=report,
        )  # fmt: skip
        return process, report

    def all_agree(self, process, report):
        code = process.wait(FLEET_SECONDS)
        text = report.read_text(encoding="utf-8")
        self.assertEqual(code, 0, text)
        self.assertIn("all agree", text)

    def streams(self):
        found = re.search(r'"streams":\s*"?(\d+)', self.machine.get("/api/v1/status"))
        return int(found.group(1)) if found else 0

    def modes(self, path):
        return self.machine.run("stat", "-c", "%U:%G %a", path).stdout.strip()

    def test_installing_starts_and_enables_nothing(self):
        self.follow("apt-get install")
        self.assertEqual(self.machine.run("systemctl", "is-active", UNIT, code=3).stdout.strip(), "inactive")
        self.assertEqual(self.machine.run("systemctl", "is-enabled", UNIT, code=1).stdout.strip(), "disabled")
        self.assertEqual(self.machine.show(UNIT, "NRestarts"), "0")

    def test_users_and_modes_are_the_policy(self):
        self.assertRegex(self.machine.run("getent", "passwd", "uplinkd").stdout,
                         r"^uplinkd:[^:]*:\d{3}:\d+:uplinkd:/var/lib/uplinkd:/usr/sbin/nologin$")  # fmt: skip
        for path, modes in {
            "/usr/bin/uplinkd": "root:root 755",
            "/etc/uplinkd": "root:root 755",
            "/etc/uplinkd/uplinkd.toml": "root:root 644",
            "/etc/uplinkd/keys": "root:uplinkd 750",
            "/var/lib/uplinkd": "uplinkd:uplinkd 750",
        }.items():
            self.assertEqual(self.modes(path), modes, path)

    def test_the_unit_is_good_and_confined(self):
        done = self.machine.run("systemd-analyze", "verify", "--man=no", UNIT)
        self.assertEqual(done.stdout, "")
        done = self.machine.run("systemd-analyze", "security", f"--threshold={EXPOSURE_MAX_TENTHS}", UNIT)
        print(done.stdout.strip().splitlines()[-1])

    def test_keys_made_by_uplinkctl_are_a_good_configuration(self):
        self.follow("uplinkctl pki init")
        self.assertEqual(self.follow("sed -i").strip(), "/etc/uplinkd/uplinkd.toml: good")

    def test_a_robot_is_online_ten_minutes_after_the_empty_root(self):
        self.follow("systemctl enable --now uplinkd")
        self.wait_ready()
        process, report = self.fleet(10, "first")
        online = lambda: '"online"' in self.machine.get("/api/v1/robots?presence=online")  # noqa: E731
        self.machine.wait_until(online, START_SECONDS, "a robot is online")
        self.assertIn("openapi: 3.1", self.machine.get("/api/v1/openapi.yaml"))
        seconds = time.monotonic() - Host.began
        print(f"from the empty root to the first robot online: {seconds:.1f} s")
        self.all_agree(process, report)

    def test_the_robot_of_the_page_agrees(self):
        self.assertIn("all agree", self.follow("uplink-fleet"))

    def test_doctor_finds_no_reason_not_to_serve(self):
        done = self.machine.run("uplinkctl", "doctor", "--config", "/etc/uplinkd/uplinkd.toml", code=None)
        self.assertIn(done.returncode, (0, 1), done.stdout)

    def test_keys_may_be_credentials_of_systemd(self):
        drop_in = "/etc/systemd/system/uplinkd.service.d"
        self.machine.run("install", "-D", "-m", "644", "/usr/share/doc/uplinkd/examples/credentials.conf",
                         f"{drop_in}/credentials.conf")  # fmt: skip
        for name in KEYS:
            self.machine.run("chmod", "600", f"/etc/uplinkd/keys/{name}")
        self.machine.run("systemctl", "daemon-reload")
        self.machine.run("systemctl", "restart", UNIT)
        self.wait_ready()
        environment = self.machine.run("cat", f"/proc/{self.pid()}/environ").stdout
        self.assertIn("UPLINKD_TLS_KEY_FILE=/run/credentials/uplinkd.service/server.key", environment)
        self.machine.run("rm", "-r", drop_in)
        for name in KEYS:
            self.machine.run("chmod", "640", f"/etc/uplinkd/keys/{name}")
        self.machine.run("systemctl", "daemon-reload")
        self.machine.run("systemctl", "restart", UNIT)
        self.wait_ready()

    def started_anew(self, before, restarts):
        return int(self.machine.show(UNIT, "NRestarts")) > restarts and self.pid() not in (0, before)

    def test_a_server_that_hangs_is_started_anew(self):
        before, restarts = self.pid(), int(self.machine.show(UNIT, "NRestarts"))
        self.machine.run("kill", f"-{int(signal.SIGSTOP)}", before)
        self.machine.wait_until(lambda: self.started_anew(before, restarts), WATCHDOG_SECONDS, "the watchdog")
        self.wait_ready()

    def test_a_server_that_was_killed_is_started_anew(self):
        before, restarts = self.pid(), int(self.machine.show(UNIT, "NRestarts"))
        self.machine.run("kill", f"-{int(signal.SIGKILL)}", before)
        self.machine.wait_until(lambda: self.started_anew(before, restarts), WATCHDOG_SECONDS, "a new process")
        self.wait_ready()

    def test_an_upgrade_loses_nothing_of_a_fleet_that_streams(self):
        process, report = self.fleet(25, "upgraded")
        self.machine.wait_until(lambda: self.streams() == ROBOTS, START_SECONDS, "the fleet streams")
        before = self.pid()
        self.apt("-o", "Dpkg::Options::=--force-confold", "install", *self.next_names)
        self.assertIsNone(process.poll(), "the fleet still streams")
        self.wait_ready()
        self.assertNotEqual(self.pid(), before)
        self.all_agree(process, report)
        journal = self.machine.run("journalctl", "-u", UNIT, "-o", "cat").stdout
        print("\n".join(line for line in journal.splitlines() if "drain" in line or "stopped" in line))
        self.assertNotIn("stopped_unsettled", journal)

    def test_an_edited_configuration_is_kept_by_an_upgrade(self):
        kept = self.machine.run("cat", "/etc/uplinkd/uplinkd.toml").stdout
        self.assertIn('\nkey_file = "/etc/uplinkd/keys/server.key"\n', kept)
        self.assertNotIn("A later version's line.", kept)
        offered = self.machine.run("cat", "/etc/uplinkd/uplinkd.toml.dpkg-dist").stdout
        self.assertIn("A later version's line.", offered)

    def test_removing_stops_the_server_and_keeps_what_is_the_operators(self):
        self.apt("remove", "uplinkd")
        self.machine.run("pgrep", "-x", "uplinkd", code=1)
        units = self.machine.run("systemctl", "list-unit-files", "--no-legend", "uplinkd*", code=None).stdout
        self.assertNotIn("enabled", units.replace(" disabled", ""), units)
        for path in ("/var/lib/uplinkd/uplinkd.db", "/etc/uplinkd/uplinkd.toml", "/etc/uplinkd/keys/ca.crt"):
            self.machine.run("test", "-e", path)

    def test_purging_removes_the_store_and_names_the_keys_that_stay(self):
        said = self.apt("purge", "uplinkd", "uplinkd-tools")
        for name in KEYS:
            self.assertIn(f"uplinkd: left in place: /etc/uplinkd/keys/{name}", said)
            self.machine.run("test", "-e", f"/etc/uplinkd/keys/{name}")
        for path in ("/var/lib/uplinkd", "/etc/uplinkd/uplinkd.toml", "/usr/bin/uplinkd", "/usr/bin/uplinkctl",
                     "/etc/systemd/system/multi-user.target.wants/uplinkd.service"):  # fmt: skip
            self.machine.run("test", "!", "-e", path)
        self.assertEqual(self.machine.run("systemctl", "--failed", "--no-legend").stdout.strip(), "")


def load_tests(_loader, _tests, _pattern):
    """In the order in which they stand here."""
    return unittest.TestSuite(Host(name) for name in vars(Host) if name.startswith("test_"))
