"""The scripts of deploy/compose by themselves, with paths in a folder: no program's arguments hold a password."""

import base64
import hashlib
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

from harness import POSTGRES, SOURCE, run

COMPOSE = SOURCE / "deploy/compose"
# Stands for a program: notes its arguments and becomes it.
SHIM = """#!/bin/sh
printf '%s\\n' "$*" >>{arguments}
exec {program} "$@"
"""


class Settings(unittest.TestCase):
    def test_each_variable_of_the_compose_files_is_a_key(self):
        section, keys = "", set()
        for line in (SOURCE / "deploy/uplinkd.toml").read_text(encoding="utf-8").splitlines():
            if head := re.match(r"\[([a-z]+)\]", line):
                section = head.group(1)
            elif key := re.match(r"# ([a-z0-9_.]+) = ", line):
                keys.add(f"UPLINKD_{section}_{key.group(1).replace('.', '_')}".upper())
        used = set()
        for path in sorted(COMPOSE.glob("compose*.yaml")):
            used |= set(re.findall(r"UPLINKD_[A-Z_]+(?=:)", path.read_text(encoding="utf-8")))
        self.assertLessEqual({"UPLINKD_LISTEN_FLEET", "UPLINKD_STORE_URL"}, used)
        self.assertLessEqual(used, keys)


class Scripts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="uplinkd-compose-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "secrets").mkdir()
        (self.folder / "bin").mkdir()
        self.arguments = self.folder / "arguments"

    def shim(self, name, program):
        path = self.folder / "bin" / name
        path.write_text(SHIM.format(arguments=self.arguments, program=program), encoding="utf-8")
        path.chmod(0o755)

    def run_script(self, name, paths, code=0, **environment):
        text = (COMPOSE / name).read_text(encoding="utf-8")
        for path in paths:
            self.assertIn(path, text)
            text = text.replace(path, f"{self.folder}/{pathlib.Path(path).name}")
        script = self.folder / name
        script.write_text(text, encoding="utf-8")
        environment["PATH"] = f"{self.folder}/bin:/usr/sbin:{os.environ['PATH']}"
        return run("sh", script, code=code, env={**os.environ, **environment})

    def secret(self, name, password):
        (self.folder / "secrets" / name).write_text(f"{password}\n", encoding="utf-8")

    def assert_not_in_arguments(self, password):
        said = self.arguments.read_text(encoding="utf-8")
        self.assertTrue(said)
        self.assertNotIn(password, said)

    def broker_files(self, code=0):
        paths = ("/etc/mosquitto", "/mosquitto-files", "/authority", "/run/secrets", "/var/lib/mosquitto")
        return self.run_script("broker-files.sh", paths, code=code)

    def prepare_broker(self):
        self.shim("mosquitto_passwd", "/usr/bin/mosquitto_passwd")
        # Its user is in the broker's image alone.
        self.shim("chown", "/bin/true")
        for folder, names in (("mosquitto-files", ("mosquitto.conf", "acl")), ("authority", ("broker.crt", "broker.key"))):
            (self.folder / folder).mkdir()
            for name in names:
                (self.folder / folder / name).touch()

    def test_the_brokers_password_is_hashed_and_other_accounts_stay(self):
        self.prepare_broker()
        passwords = self.folder / "mosquitto/passwords"
        for password in ("first-secret", 'another $"secret'):
            self.secret("broker_password", password)
            self.broker_files()
            ours, *others = passwords.read_text(encoding="utf-8").splitlines()
            user, _, rest = ours.partition(":")
            _, _, rounds, salt, digest = rest.split("$")
            found = hashlib.pbkdf2_hmac("sha512", password.encode(), base64.b64decode(salt), int(rounds))
            self.assertEqual((user, base64.b64decode(digest)), ("uplinkd", found))
            self.assert_not_in_arguments(password)
            self.assertEqual(passwords.stat().st_mode & 0o777, 0o600)
            if not others:
                with passwords.open("a", encoding="utf-8") as file:
                    file.write("robot:$7$101$x$y\n")
        self.assertEqual(others, ["robot:$7$101$x$y"])
        self.assertEqual(sorted(path.name for path in passwords.parent.iterdir()),
                         ["acl", "certs", "mosquitto.conf", "passwords"])  # fmt: skip

    def test_a_password_that_the_brokers_file_cannot_hold_is_refused(self):
        self.prepare_broker()
        self.secret("broker_password", "a:b")
        self.assertIn("holds a colon", self.broker_files(code=1).stderr)

    def test_the_role_of_the_database_gets_its_password(self):
        state = self.folder / "state"
        run(POSTGRES, "start-light", state)
        self.addCleanup(run, POSTGRES, "stop", state)
        at = dict(line.split("=", 1) for line in state.read_text(encoding="utf-8").splitlines())
        socket = {"PGHOST": at["folder"], "PGPORT": at["port"]}
        psql = ["psql", "-X", "-q", "-A", "-t", "-U", "postgres", "-d", "postgres", "-v", "ON_ERROR_STOP=1"]
        subprocess.run([*psql, "-c", "DROP ROLE uplinkd"], env={**os.environ, **socket}, check=True)
        self.shim("psql", "/usr/bin/psql")
        password = """it's a "secret" \\ `x` $HOME"""
        self.secret("store_password", password)
        self.run_script("postgres-roles.sh", ["/run/secrets"], POSTGRES_USER="postgres", POSTGRES_DB="postgres", **socket)
        self.assert_not_in_arguments("secret")
        url = f"host=127.0.0.1 port={at['port']} user=uplinkd dbname=postgres"
        done = run("psql", "-X", "-A", "-t", "-c", "SELECT 1", url, env={**os.environ, "PGPASSWORD": password})
        self.assertEqual(done.stdout.strip(), "1")


if __name__ == "__main__":
    unittest.main()
