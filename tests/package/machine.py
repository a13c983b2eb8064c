"""A Debian root that a real systemd boots (systemd-nspawn), with no network but its own loopback."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from waiting import wait_until  # noqa: E402

BOOT_SECONDS = 60
STOP_SECONDS = 30
RUN_SECONDS = 120
LOOK_SECONDS = 0.1


def run(*arguments, code=0, timeout=RUN_SECONDS, env=None):
    """Runs a program to its end; another exit code than `code` fails, with its output."""
    done = subprocess.run(
        [str(argument) for argument in arguments],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
        text=True, timeout=timeout, env=env, check=False,
    )  # fmt: skip
    if code is not None and done.returncode != code:
        raise AssertionError(f"{arguments} ended with {done.returncode}, not {code}\n{done.stdout}")
    return done


def unpack(tar, root):
    """The root from its archive. systemd-nspawn makes /dev itself."""
    root.mkdir(parents=True)
    run("tar", "-C", root, "--exclude", "./dev/*", "-xf", tar)
    # A minimal root resolves no localhost; netbase brings this file on a real machine.
    (root / "etc/hosts").write_text("127.0.0.1 localhost\n", encoding="utf-8")


class Machine:
    """One booted root. Made, used and stopped by one thread."""

    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.nspawn = None
        self.leader = 0

    def boot(self):
        with open(self.root.with_suffix(".console"), "wb") as console:
            self.nspawn = subprocess.Popen(
                ["systemd-nspawn", "-q", "-b", "-D", self.root, "--register=no", "--keep-unit",
                 "--private-network", "--console=pipe"],
                stdin=subprocess.DEVNULL, stdout=console, stderr=console,
            )  # fmt: skip
        wait_until(self.nspawn, self._find_leader, BOOT_SECONDS, "systemd is process 1", LOOK_SECONDS)
        wait_until(self.nspawn, self._is_running, BOOT_SECONDS, "the system is running", LOOK_SECONDS)

    def _find_leader(self):
        """The container's first process is the only child of systemd-nspawn."""
        children = pathlib.Path(f"/proc/{self.nspawn.pid}/task/{self.nspawn.pid}/children").read_text("ascii")
        if not children.split():
            return False
        self.leader = int(children.split()[0])
        try:
            return os.readlink(f"/proc/{self.leader}/exe").endswith("/systemd")
        except FileNotFoundError:
            return False

    def _is_running(self):
        return self.run("systemctl", "is-system-running", code=None).stdout.strip() == "running"

    def command(self, *arguments):
        inside = ("nsenter", "-t", self.leader, "-m", "-u", "-i", "-n", "-p", "-C", "-r", "-w", "--")
        return [str(argument) for argument in (*inside, *arguments)]

    def run(self, *arguments, code=0, timeout=RUN_SECONDS):
        env = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL": "C.UTF-8", "DEBIAN_FRONTEND": "noninteractive"}
        return run(*self.command(*arguments), code=code, timeout=timeout, env=env)

    def start(self, *arguments, output):
        """A program that goes on beside the test; its output goes to a file."""
        with open(output, "wb") as file:
            return subprocess.Popen(
                self.command(*arguments), stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT
            )

    def get(self, path):
        """What the server answers; nothing, while none does. The root has no curl: this machine's has."""
        done = run("nsenter", "-t", self.leader, "-n", "curl", "-s", "-f", "-m", "5",
                   f"http://127.0.0.1:7480{path}", code=None)  # fmt: skip
        return done.stdout if done.returncode == 0 else ""

    def show(self, unit, name):
        return self.run("systemctl", "show", "-P", name, unit).stdout.strip()

    def wait_until(self, condition, seconds, what):
        return wait_until(self.nspawn, condition, seconds, what, LOOK_SECONDS)

    def stop(self):
        if self.nspawn and self.nspawn.poll() is None:
            self.nspawn.send_signal(signal.SIGTERM)
            try:
                self.nspawn.wait(STOP_SECONDS)
            except subprocess.TimeoutExpired:
                self.nspawn.kill()
                self.nspawn.wait()

    def remove(self):
        self.stop()
        shutil.rmtree(self.root, ignore_errors=True)
        self.root.with_suffix(".console").unlink(missing_ok=True)
