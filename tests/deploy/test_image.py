"""The image: small, without a shell, and confined; a fleet's verification agrees, also after a restart."""

import json
import shutil
import time
import unittest

from images import SOURCE, TOOLS, Podman, run
from waiting import wait_for

SIZE_MAX = 60_000_000
MEMORY = 512 * 1024 * 1024
CONFINED = ("--read-only", "--cap-drop=all", "--security-opt=no-new-privileges", f"--memory={MEMORY}")
FLEET_RUNS = ("--robots", "20", "--for", "5s", "--pace", "10", "--report", "json")


class Image(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        began = time.monotonic()
        cls.podman = Podman()
        cls.addClassCleanup(cls.podman.close)
        cls.image = cls.podman.build()
        print(f"\nimage built in {time.monotonic() - began:.0f} s")

    def setUp(self):
        self.names = []
        self.addCleanup(self.remove)

    def remove(self):
        for name in self.names:
            self.podman("rm", "--force", "--time", "0", "--volumes", name)

    def certificates(self):
        """The certificates that a server needs, in the volume tls; the authority's own in another."""
        authority = ("-v", "authority:/etc/uplinkd/authority")
        for arguments in (
            ("init", "--keep", "--dir", "/etc/uplinkd/authority"),
            ("server", "--keep", "--dir", "/etc/uplinkd/authority", "--copy-to", "/etc/uplinkd/tls",
             "--host", "localhost"),
        ):  # fmt: skip
            self.once("/usr/bin/uplinkctl", *authority, "-v", "tls:/etc/uplinkd/tls", command=("pki", *arguments))

    def once(self, program, *flags, command=(), code=0, network="none"):
        return self.podman("run", "--rm", "--no-healthcheck", "--network", network, *CONFINED, *flags,
                           "--entrypoint", program, self.image, *command, code=code)  # fmt: skip

    def start(self, name):
        self.names.append(name)
        # Without a network: the fleet is on the loopback of this container.
        self.podman("run", "--detach", "--name", name, "--network", "none", *CONFINED, "-v", "tls:/etc/uplinkd/tls:ro",
                    "-v", "data:/var/lib/uplinkd", self.image)  # fmt: skip
        self.wait_until_ready(name)

    def wait_until_ready(self, name):
        def ready():
            return self.curl(name, "/readyz") is not None

        try:
            wait_for(ready, 30, f"{name} is ready", [int(self.pid(name))])
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.log(name)}") from None

    def log(self, name):
        done = self.podman("logs", name)
        return done.stdout + done.stderr

    def pid(self, name):
        return self.podman("inspect", name, "--format", "{{.State.Pid}}").stdout.strip()

    def curl(self, name, path, port=7480, flags=()):
        """What a path on the loopback of the container answers; None if it does not answer 200."""
        try:
            return run("nsenter", "-n", "-t", self.pid(name), "curl", "-sf", "-m", "10", *flags,
                       f"http://127.0.0.1:{port}{path}").stdout  # fmt: skip
        except AssertionError:
            return None

    def fleet(self, name, *flags):
        """A fleet on the network of the server's container, which compares all of it over HTTP."""
        report = json.loads(
            self.once("/usr/bin/uplink-fleet", "-v", "authority:/etc/uplinkd/authority:ro",
                      network=f"container:{name}", command=("--pki", "/etc/uplinkd/authority", *FLEET_RUNS, *flags)).stdout
        )  # fmt: skip
        self.assertTrue(report["ok"], [check for check in report["checks"] if not check["ok"]])
        return report

    def test_it_is_small_and_holds_no_shell(self):
        (image,) = json.loads(self.podman("image", "inspect", self.image).stdout)
        print(f"\nimage: {image['Size'] / 1e6:.1f} MB")
        self.assertLessEqual(image["Size"], SIZE_MAX)
        self.assertEqual(image["Config"]["User"], "10001:10001")
        self.assertIn("health", image["Healthcheck"]["Test"])
        self.podman("create", "--name", "looked-at", self.image)
        self.names.append("looked-at")
        listed = self.podman("export", "looked-at", "--output", self.podman.folder / "root.tar")
        listed = run("tar", "-tvf", self.podman.folder / "root.tar").stdout.splitlines()
        programs = [line for line in listed if " usr/bin/" in line and not line.endswith("/")]
        self.assertEqual(len(programs), 3, programs)
        self.assertEqual([line for line in listed if "s" in line.split()[0][1:]], [], "set-user-id")

    def test_a_confined_server_takes_a_fleet_and_keeps_its_volume(self):
        self.certificates()
        self.start("server")
        self.fleet("server")
        self.podman("healthcheck", "run", "server")
        self.assertIsNotNone(self.curl("server", "/metrics", 7481, ("-H", "Host: uplinkd.example.org")))
        self.assertIn(f" memory_bytes_max={MEMORY} ", self.log("server").replace("\n", " \n"))
        self.assertTrue(self.curl("server", "/api/v1/openapi.yaml").startswith("openapi: 3.1"))
        before = json.loads(self.curl("server", "/api/v1/robots?pageSize=100"))["robots"]
        self.podman("stop", "--time", "30", "server")
        self.assertEqual(self.podman("inspect", "server", "--format", "{{.State.ExitCode}}").stdout.strip(), "0")
        self.podman("rm", "--force", "server")
        self.start("server")
        after = json.loads(self.curl("server", "/api/v1/robots?pageSize=100"))["robots"]
        self.assertEqual(sorted(r["ruri"] for r in after), sorted(r["ruri"] for r in before))
        self.assertEqual(len(after), 20)
        self.fleet("server", "--seed", "2")

    def test_without_certificates_it_ends_and_names_the_file(self):
        done = self.podman("run", "--rm", "--network", "none", *CONFINED, self.image, code=2)
        self.assertIn("/etc/uplinkd/tls/server.crt", done.stdout + done.stderr)

    def test_the_health_check_fails_where_no_server_answers(self):
        self.once("/usr/bin/uplinkctl", command=("health", "--config", "/etc/uplinkd/uplinkd.toml"), code=1)

    def test_hadolint_finds_nothing(self):
        program = shutil.which("hadolint") or shutil.which("hadolint", path=str(TOOLS / "venv/bin"))
        if program is None:
            print("\nhadolint is not at hand: its check is left out")
            return
        run(program, SOURCE / "deploy/container/Dockerfile")


if __name__ == "__main__":
    unittest.main()
