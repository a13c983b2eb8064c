"""A dockerd of the test's own, in a network namespace of its own, with the images that the compose files name."""

import contextlib
import os
import shutil
import subprocess

from images import MINUTES, WORK, Podman, debian_root, run
from waiting import wait_for

DEBIAN_PACKAGES = ("prometheus", "prometheus-alertmanager", "mosquitto", "postgresql-15")
# What stands in for other projects' images: Debian's programs, started as those images start theirs.
STAND_INS = {
    "prom/prometheus:v2.55.1": ("/usr/bin/prometheus",),
    "prom/alertmanager:v0.27.0": ("/usr/bin/prometheus-alertmanager",),
    "eclipse-mosquitto:2.0.20": (),
    "postgres:15": ("/stand-in-postgres.sh",),
}
POSTGRES = """#!/bin/sh
set -eu
PATH="/usr/lib/postgresql/15/bin:$PATH" PGDATA=/var/lib/postgresql/data
export PATH PGDATA
if [ "$(id -u)" = 0 ]; then
  mkdir -p "$PGDATA" && chown postgres "$PGDATA" && chmod 700 "$PGDATA"
  # Debian makes it at boot.
  install -d -o postgres -g postgres -m 775 /var/run/postgresql
  exec setpriv --reuid=postgres --regid=postgres --init-groups "$0"
fi
if [ ! -s "$PGDATA/PG_VERSION" ]; then
  initdb -U "$POSTGRES_USER" --pwfile="$POSTGRES_PASSWORD_FILE" -E UTF8 --auth-local=trust
  echo 'host all all all scram-sha-256' >>"$PGDATA/pg_hba.conf"
  pg_ctl -o "-c listen_addresses=''" -w start
  createdb -U "$POSTGRES_USER" "$POSTGRES_DB"
  for script in /docker-entrypoint-initdb.d/*.sh; do "$script"; done
  pg_ctl -m fast -w stop
fi
exec postgres -c listen_addresses='*'
"""


class Docker:
    def __init__(self):
        self.folder = WORK / "docker"
        if self.folder.exists():
            shutil.rmtree(self.folder)
        self.folder.mkdir(parents=True)
        self.environment = {**os.environ, "DOCKER_HOST": f"unix://{self.folder}/docker.sock",
                            "DOCKER_BUILDKIT": "0"}  # fmt: skip
        self.log = (self.folder / "dockerd.log").open("wb")
        # Its bridges, rules and sysctls of the network end with the namespace.
        daemon = ["dockerd", "--data-root", self.folder / "data", "--exec-root", self.folder / "run",
                  "--pidfile", self.folder / "pid", "--host", self.environment["DOCKER_HOST"],
                  "--default-ulimit", "nofile=20000:20000"]  # fmt: skip
        self.process = subprocess.Popen(
            ["unshare", "--net", "sh", "-c", 'ip link set lo up && exec "$@"', "sh", *map(str, daemon)],
            stdout=self.log, stderr=subprocess.STDOUT,
        )  # fmt: skip
        try:
            wait_for(self.answers, 60, "dockerd answers", [self.process.pid])
        except AssertionError as error:
            log = (self.folder / "dockerd.log").read_text(encoding="utf-8")
            self.close()
            raise AssertionError(f"{error}\n{log[-3000:]}") from None

    def answers(self):
        with contextlib.suppress(AssertionError):
            return self("version", "--format", "{{.Server.Version}}")
        return None

    def __call__(self, *arguments, code=0, timeout=5 * MINUTES):
        return run("docker", *arguments, code=code, timeout=timeout, env=self.environment)

    def inside(self, *command, timeout=30):
        """Runs a program of this machine in the daemon's network."""
        return run("nsenter", "-n", "-t", self.process.pid, *command, timeout=timeout)

    def load_images(self):
        podman = Podman()
        try:
            image = podman.build()
            archive = self.folder / "uplinkd.tar"
            podman("save", "--format", "docker-archive", "--output", archive, image)
        finally:
            podman.close()
        self("load", "--input", archive)
        self("tag", image, image.removeprefix("localhost/"))
        self("import", debian_root("compose-stand-ins", *DEBIAN_PACKAGES), "stand-ins")
        context = self.folder / "stand-in"
        context.mkdir()
        script = context / "stand-in-postgres.sh"
        script.write_text(POSTGRES, encoding="utf-8")
        script.chmod(0o755)
        for name, entry in STAND_INS.items():
            entry = ", ".join(f'"{word}"' for word in entry)
            (context / "Dockerfile").write_text(
                f"FROM stand-ins\nCOPY stand-in-postgres.sh /\nENTRYPOINT [{entry}]\n", encoding="utf-8"
            )
            self("build", "--tag", name, context)

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(60)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait(30)
        self.log.close()
        for kind in ("data", "run"):
            mounts = run("findmnt", "--noheadings", "--list", "--output", "TARGET").stdout.splitlines()
            for mount in sorted((m for m in mounts if m.startswith(str(self.folder / kind))), reverse=True):
                subprocess.run(["umount", "--lazy", mount], capture_output=True, check=False)
        shutil.rmtree(self.folder, ignore_errors=True)
