"""The Debian root from which machines begin, and the packages that ours depend on; both are kept."""

import contextlib
import fcntl
import os
import pathlib
import shutil

from machine import run, unpack

SUITE = "bookworm"
MIRROR = os.environ.get("UPLINK_MIRROR", "http://deb.debian.org/debian")
BASE_SECONDS = 600
ARCHIVES = "var/cache/apt/archives"


class Base:
    """`cache` is a folder that outlives the test."""

    def __init__(self, cache):
        self.cache = pathlib.Path(cache)
        self.tar = self.cache / f"{SUITE}.tar.gz"
        self.archives = self.cache / "archives"

    @contextlib.contextmanager
    def _locked(self, how):
        """Other runs share the cache. The lock lies beside it, since _make deletes it."""
        self.cache.parent.mkdir(parents=True, exist_ok=True)
        with self.cache.with_name(f"{self.cache.name}.lock").open("w") as lock:
            fcntl.flock(lock, how)
            yield

    def _make(self):
        if self.cache.exists():
            shutil.rmtree(self.cache)
        self.archives.mkdir(parents=True)
        part = self.cache / "part.tar"
        # With the lists of packages, since a machine without a network installs by them.
        run("mmdebstrap", "-q", "--variant=minbase", "--include=systemd,systemd-sysv", "--dpkgopt=force-unsafe-io",
            '--aptopt=Acquire::Languages "none"', '--aptopt=APT::Install-Recommends "false"',
            "--skip=cleanup/apt/lists", SUITE, part, MIRROR, timeout=BASE_SECONDS)  # fmt: skip
        run("gzip", "-1", part)
        part.with_suffix(".tar.gz").rename(self.tar)

    def make_if_missing(self):
        """True if it had to be made."""
        with self._locked(fcntl.LOCK_EX):
            if self.tar.exists():
                return False
            self._make()
            return True

    def _fill(self, root, packages):
        """A new root that holds our packages in /srv, and in apt's cache what they need; apt's text if that fails."""
        shutil.rmtree(root, ignore_errors=True)
        unpack(self.tar, root)
        for package in packages:
            shutil.copy(package, root / "srv")
        for archive in self.archives.glob("*.deb"):
            shutil.copy(archive, root / ARCHIVES)
        names = [f"/srv/{package.name}" for package in packages]
        shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")
        done = run("chroot", root, "apt-get", "-q", "-y", "--download-only", "install", *names, code=None)
        if done.returncode != 0:
            return done.stdout
        for archive in (root / ARCHIVES).glob("*.deb"):
            if not (self.archives / archive.name).exists():
                shutil.copy(archive, self.archives)
        return ""

    def root(self, folder, packages):
        """A root in `folder`. Lists of an old base may name what the mirror no longer has: then anew."""
        made = self.make_if_missing()
        with self._locked(fcntl.LOCK_SH):
            trouble = self._fill(folder, packages)
        if trouble and not made:
            with self._locked(fcntl.LOCK_EX):
                self._make()
            with self._locked(fcntl.LOCK_SH):
                trouble = self._fill(folder, packages)
        if trouble:
            raise AssertionError(f"the packages' dependencies cannot be downloaded:\n{trouble}")
