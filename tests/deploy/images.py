"""Images without a registry: podman with a store of its own, and roots of Debian's packages under the names
that Dockerfile and compose files use."""

import fcntl
import os
import pathlib
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests/e2e"))
from harness import BIN, run  # noqa: E402

TOOLS = pathlib.Path(os.environ.get("UPLINK_TOOLS_DIR") or pathlib.Path.home() / ".cache/uplinkd-tools")
WORK = SOURCE / "build/deploy"
BASE = "docker.io/library/debian:12-slim"
MIRROR = "http://deb.debian.org/debian"
MINUTES = 60
# Without these podman asks for more descriptors than a small machine grants, and for a systemd.
CONTAINERS_CONF = """
[containers]
default_ulimits = ["nofile=20000:20000", "nproc=32768:32768"]
[engine]
runtime = "runc"
cgroup_manager = "cgroupfs"
events_logger = "file"
"""


def version():
    """The image's tag, which is the version of the programs."""
    return run(BIN / "uplinkd", "--version").stdout.split()[1]


def debian_root(name, *packages):
    """A tarball of a small Debian 12 with these packages, made once."""
    path = TOOLS / f"{name}.tar"
    TOOLS.mkdir(parents=True, exist_ok=True)
    with (TOOLS / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            options = ["--format=tar", "--variant=minbase", "--dpkgopt=force-unsafe-io"]
            options += [f"--dpkgopt=path-exclude=/usr/share/{part}/*" for part in ("doc", "man", "locale")]
            options += [f"--include={','.join(packages)}"] if packages else []
            run("mmdebstrap", *options, "bookworm", f"{path}.new", MIRROR, timeout=10 * MINUTES)
            os.rename(f"{path}.new", path)
    return path


class Podman:
    """podman with a store of its own below build/. Containers and volumes are gone with it; layers of images stay,
    so that the next build is quick."""

    def __init__(self):
        self.folder = WORK / "podman"
        self.command = ["podman", "--root", str(self.folder / "storage"), "--runroot", str(self.folder / "run")]
        self.folder.mkdir(parents=True, exist_ok=True)
        configuration = self.folder / "containers.conf"
        configuration.write_text(CONTAINERS_CONF, encoding="utf-8")
        self.environment = {**os.environ, "CONTAINERS_CONF": str(configuration)}
        # What a test that was killed left.
        self.clean()

    def __call__(self, *arguments, code=0, timeout=2 * MINUTES):
        return run(*self.command, *arguments, code=code, timeout=timeout, env=self.environment)

    def build(self):
        """The image of uplinkd; gives its name."""
        self.provide(BASE, "debian-12-slim")
        # On the machine's own network, so that podman makes no bridge and no rules.
        environment = {**self.environment, "UPLINK_BIN_DIR": str(BIN), "UPLINK_IMAGE_FLAGS": "--pull-never --network host"}
        run(SOURCE / "tools/dev/image.sh", *self.command, timeout=10 * MINUTES, env=environment)
        return f"localhost/uplinkd:{version()}"

    def provide(self, image, root, *packages):
        """The image, made of a small Debian with these packages, if it is not there."""
        if subprocess.run([*self.command, "image", "exists", image], env=self.environment, check=False).returncode != 0:
            self("import", debian_root(root, *packages), image, timeout=10 * MINUTES)

    def clean(self):
        self("rm", "--all", "--force", "--time", "0")
        self("volume", "prune", "--force")

    def close(self):
        self.clean()
        # podman leaves its own mount behind.
        subprocess.run(["umount", "--lazy", self.folder / "storage/overlay"], capture_output=True, check=False)
