"""`uplinkctl doctor` against real parts: each fault that is planted is named, and nothing is changed."""

import contextlib
import os
import re
import socket
import sqlite3
import subprocess
import unittest

from harness import BIN, Cluster, EndToEnd, Server, run, uplinkctl
from ports import free_port

LINE = re.compile(r"^(ok|warning|error) +(\S+): (.*)$")
# The machine may keep its clock by something that the kernel does not know.
OF_THE_MACHINE = ("clock", "descriptors")
FEW_ROBOTS = "[limits]\nrobots_max = 100\n"
AS_ROOT = os.geteuid() == 0
STATUS_SECONDS = 30
# Over the bounds of a database that is silent.
DOCTOR_SECONDS = 60


class Report:
    def __init__(self, done):
        self.text, self.code = done.stdout, done.returncode
        lines = done.stdout.splitlines()
        self.summary = lines.pop()
        self.findings = [LINE.match(line).groups() for line in lines]

    def worst(self):
        return max(("ok", "warning", "error").index(severity) for severity, _, _ in self.findings)

    def of(self, severity):
        return [(where, what) for found, where, what in self.findings
                if found == severity and where not in OF_THE_MACHINE]  # fmt: skip


class DoctorTest(EndToEnd):
    def doctor(self, path, user="root"):
        """As root the findings are root's own, unless another user is named."""
        whose = ("--user", user) if AS_ROOT else ()
        done = subprocess.run([BIN / "uplinkctl", "doctor", "--config", path, *whose], capture_output=True,
                              text=True, timeout=DOCTOR_SECONDS, check=False)  # fmt: skip
        self.assertEqual(done.stderr, "")
        report = Report(done)
        self.assertEqual(report.code, report.worst(), report.text)
        return report

    def assert_one_error(self, path, where, *parts):
        """That one error is named, alone."""
        errors = self.doctor(path).of("error")
        self.assertEqual([found for found, _ in errors], [where], errors)
        for part in parts:
            self.assertIn(part, errors[0][1])

    def certify(self, server, *flags):
        """Has the authority sign the server's key again."""
        pki = server.pki
        request, extensions = self.folder / "s.csr", self.folder / "s.ext"
        extensions.write_text("subjectAltName=DNS:localhost\nextendedKeyUsage=serverAuth\n", encoding="utf-8")
        run("openssl", "req", "-new", "-key", pki / "server.key", "-subj", "/CN=s", "-out", request)
        run("openssl", "x509", "-req", "-in", request, "-CA", pki / "ca.crt", "-CAkey", pki / "ca.key",
            "-extfile", extensions, "-out", pki / "server.crt", *flags)  # fmt: skip

    def files(self):
        return {path: path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}


class Host(DoctorTest):
    """Configuration, certificates, files and ports."""

    def test_a_running_server_is_well(self):
        server = self.server(FEW_ROBOTS).start()
        path = server.configuration()
        uplinkctl("store", "clock", "--config", path, "--confirm", "--yes")
        server.wait_for_status(lambda status: not status["degraded"], STATUS_SECONDS, "nothing is degraded")
        report = self.doctor(path)
        self.assertEqual(report.code, 0, report.text)
        self.assertEqual(report.summary, "0 errors, 0 warnings")
        for part in (
            f"listen.relay: {server.relay} is held by the running uplinkd (pid {server.process.pid})",
            'server: ready: {"degraded":[]}', "tls.certificate_file: it is for localhost, 127.0.0.1",
            "it leads to an authority of tls.client_ca_file", "MiB free of",
        ):  # fmt: skip
            self.assertIn(part, report.text)
        self.assertRegex(report.text, r"has schema (\d+), and this program needs \1\n")

    def test_nothing_is_changed(self):
        server = self.server()
        path = server.configuration()
        before = self.files()
        self.assertEqual(self.doctor(path).of("error"), [])
        self.assertEqual(self.files(), before)
        server.start()
        server.terminate(60)
        path = server.configuration()
        before = self.files()
        self.assertEqual(self.doctor(path).of("error"), [])
        self.assertEqual(self.files(), before)

    def test_an_expired_certificate(self):
        server = self.server()
        self.certify(server, "-days", "-1")
        self.assert_one_error(server.configuration(), "tls.certificate_file", "expired 1 day ago", "renew it")

    def test_a_certificate_that_expires_soon(self):
        server = self.server()
        self.certify(server, "-days", "13")
        self.assertIn("expires in 12 days", str(self.doctor(server.configuration()).of("warning")))

    def test_an_authority_of_the_folder_that_expires_soon(self):
        server = self.server()
        folder = self.folder / "authorities"
        folder.mkdir(mode=0o700)
        run("openssl", "req", "-x509", "-newkey", "rsa:3072", "-nodes", "-keyout", self.folder / "old.key",
            "-subj", "/CN=old", "-days", "13", "-out", folder / "old.pem")  # fmt: skip
        (folder / "now.pem").write_bytes((server.pki / "ca.crt").read_bytes())
        for name in ("old", "now"):
            (folder / f"{name}.toml").write_text("")
        server.settings = f'[identity]\nauthorities = "{folder}"\n'
        path = server.configuration()
        # The folder stands in place of the one file.
        path.write_text(re.sub("client_ca_file.*\n", "", path.read_text()))
        warnings = self.doctor(path).of("warning")
        self.assertIn("authority CN=old of", str(warnings))
        self.assertIn("identity.authorities", [where for where, _ in warnings])

    def test_another_authority_of_that_name(self):
        server = self.server()
        path = server.configuration()
        said = run("openssl", "x509", "-in", server.pki / "ca.crt", "-noout", "-subject", "-nameopt", "RFC2253")
        name = said.stdout.strip().removeprefix("subject=CN=")
        uplinkctl("pki", "init", "--dir", server.pki, "--common-name", name, "--force")
        self.assert_one_error(path, "tls.certificate_file", "by another of that name")

    def test_a_wrong_key(self):
        server = self.server()
        path = server.configuration()
        (server.pki / "server.key").write_bytes((server.pki / "ca.key").read_bytes())
        self.assert_one_error(path, "tls.certificate_file", "server.key: is not the key of", "issued together")

    def test_a_key_that_everybody_may_read(self):
        server = self.server()
        key = server.pki / "server.key"
        key.chmod(0o604)
        report = self.doctor(server.configuration())
        self.assertEqual(report.code, 1)
        warnings = report.of("warning")
        self.assertEqual([where for where, _ in warnings], ["tls.key_file"])
        self.assertIn(f"chmod o-r {key}", warnings[0][1])

    def test_a_missing_file(self):
        server = self.server()
        path = server.configuration()
        (server.pki / "server.key").unlink()
        self.assert_one_error(path, "tls.key_file", "server.key: cannot be read: No such file", "make the file")

    def test_an_unknown_key(self):
        path = self.server("[presence]\ntime_out = 1\n").configuration()
        self.assert_one_error(path, "presence.time_out", "uplinkd.toml:", "unknown key")

    def test_no_configuration(self):
        self.assert_one_error(self.folder / "none.toml", "configuration", "none.toml")

    def test_a_port_that_another_program_has(self):
        server = self.server()
        with socket.create_server(("127.0.0.1", 0)) as other:
            server.relay = f"127.0.0.1:{other.getsockname()[1]}"
            self.assert_one_error(server.configuration(), "listen.relay", f"{server.relay} is held by python",
                                  f"(pid {os.getpid()})", "stop that program")  # fmt: skip

    def test_an_address_that_is_not_here(self):
        server = self.server()
        server.relay = "192.0.2.1:7443"
        self.assert_one_error(server.configuration(), "listen.relay", "no interface of this machine")

    def test_another_schema_in_the_file(self):
        server = self.server("migrate = false\n")
        store = self.folder / "uplinkd.db"
        header = bytearray(100)
        header[:16] = b"SQLite format 3\0"
        header[63] = 1
        header[68:72] = b"UPLK"
        store.write_bytes(header)
        self.assert_one_error(server.configuration(), "store.url", "has schema 1, and this program needs")
        store.write_bytes(b"no store")
        self.assert_one_error(server.configuration(), "store.url", "is not a store of uplinkd")
        store.write_bytes(b"")
        self.assert_one_error(server.configuration(), "store.url", "is empty, and store.migrate is false")

    def test_a_schema_that_is_still_in_the_wal(self):
        path = self.server().configuration()
        store = self.folder / "uplinkd.db"
        with contextlib.closing(sqlite3.connect(store)) as shell:
            shell.execute("PRAGMA journal_mode = wal")
            shell.executescript("BEGIN; CREATE TABLE t (x); PRAGMA application_id = 1; PRAGMA user_version = 1; COMMIT")
            report = self.doctor(path)
        self.assertEqual(report.of("error"), [])
        self.assertIn("its schema is still in the -wal", report.text)

    def test_a_store_that_is_no_file(self):
        path = self.server().configuration()
        store = self.folder / "uplinkd.db"
        os.mkfifo(store)
        self.assert_one_error(path, "store.url", "is no regular file")
        for target, said in (("uplinkd.db", "leads to itself"), ("none/u.db", "whose folder is missing")):
            store.unlink()
            store.symlink_to(target)
            self.assert_one_error(path, "store.url", said)
        store.unlink()
        store.symlink_to("later.db")
        self.assertIn("later.db is not there yet: the server makes it", self.doctor(path).text)

    def test_another_server_has_the_store_or_a_port(self):
        server = self.server().start()
        relay = server.relay
        server.relay, server.http = f"127.0.0.1:{free_port()}", f"127.0.0.1:{free_port()}"
        self.assert_one_error(server.configuration(), "store.url", "is in use by another process", "stop that")
        server.relay = relay
        server.store_url = f"sqlite://{self.folder}/other.db"
        self.assert_one_error(server.configuration(), "listen.relay",
                              f"by an uplinkd of another configuration (pid {server.process.pid})")  # fmt: skip

    def test_what_the_servers_user_may_not_do(self):
        server = self.server()
        path = server.configuration()
        if not AS_ROOT:
            refused = uplinkctl("doctor", "--config", path, "--user", "root", code=2)
            self.assertIn("only root can look as another user", refused.stderr)
            return
        self.folder.chmod(0o755)
        server.pki.chmod(0o755)
        errors = self.doctor(path, user="daemon").of("error")
        self.assertIn("tls.key_file", [where for where, _ in errors])
        self.assertIn("let the user daemon read it", str(errors))
        self.assertIn(("store.url", f"daemon may not write the folder {self.folder}: Permission denied;"
                       f" run chown daemon {self.folder}"), errors)  # fmt: skip

    def test_a_user_that_it_cannot_become_is_no_warning(self):
        if not AS_ROOT:
            return
        path = self.server().configuration()
        done = run("setpriv", "--bounding-set=-setuid,-setgid", BIN / "uplinkctl", "doctor", "--config", path,
                   "--user", "daemon", code=2)  # fmt: skip
        self.assertEqual(done.stdout, "")
        self.assertIn("cannot become daemon", done.stderr)

    def test_no_secret_is_printed(self):
        secret = "c0rrect-h0rse"
        password = self.folder / "password"
        password.write_text(secret, encoding="utf-8")
        for url in (f"postgresql://uplinkd:{secret}@127.0.0.1:1/uplinkd", "postgresql://uplinkd@127.0.0.1:1/u"):
            server = Server(self.folder, f'password_file = "{password}"\n', url)
            report = self.doctor(server.configuration())
            self.assertNotIn(secret, report.text)
            self.assertNotIn("PRIVATE", report.text)

    def test_wrong_use_ends_with_2(self):
        path = self.server().configuration()
        for arguments in ([], ["--config", path, "--user", "no-such-user"], ["--config", path, "more"]):
            with self.subTest(arguments):
                self.assertEqual(uplinkctl("doctor", *arguments, code=2).stdout, "")


class Database(DoctorTest):
    """PostgreSQL, with a cluster of its own."""

    def cluster(self, configuration=""):
        cluster = Cluster(self.folder, configuration).create()
        self.open_things.append(cluster)
        return cluster

    def path(self, url, settings=""):
        return Server(self.folder, settings, url).configuration()

    def test_a_good_one_and_a_dead_one(self):
        cluster = self.cluster("fsync = on").migrate()
        path = self.path(cluster.url("uplinkd"))
        report = self.doctor(path)
        self.assertEqual(report.of("error") + report.of("warning"), [])
        self.assertIn("fsync and full_page_writes are on", report.text)
        self.assertIn("this machine's", report.text)
        cluster.halt()
        self.assert_one_error(path, "store.url", "start the database")

    def test_one_that_is_silent_is_given_up(self):
        with socket.create_server(("127.0.0.1", 0)) as silent:
            port = silent.getsockname()[1]
            self.assert_one_error(self.path(f"postgresql://uplinkd@127.0.0.1:{port}/uplinkd"), "store.url",
                                  f"127.0.0.1:{port}")  # fmt: skip

    def test_no_schema_and_no_rights(self):
        cluster = self.cluster("fsync = on")
        path = self.path(cluster.url("uplinkd"))
        self.assert_one_error(path, "store.url", "has schema 0, and this program needs", "uplinkctl store migrate")
        cluster.migrate()
        cluster.sql("REVOKE INSERT ON uplinkd.robots FROM uplinkd")
        self.assert_one_error(path, "store.url", "may not write 1 tables")
        cluster.sql("REVOKE USAGE ON SCHEMA uplinkd FROM uplinkd")
        self.assert_one_error(path, "store.url", "permission denied for schema uplinkd")

    def test_lost_durability(self):
        cluster = self.cluster("fsync = off\nfull_page_writes = off").migrate()
        path = self.path(cluster.url("uplinkd"))
        self.assert_one_error(path, "store.url", "has fsync = off", "set fsync = on")
        warnings = self.doctor(path).of("warning")
        self.assertIn("full_page_writes = off", str(warnings))
        accepted = self.doctor(self.path(cluster.url("uplinkd"), "accept_unsafe = true\n")).of("warning")
        self.assertIn("fsync = off", str(accepted))

    def test_a_database_that_takes_no_writes(self):
        cluster = self.cluster("fsync = on").migrate()
        cluster.sql("ALTER ROLE uplinkd SET default_transaction_read_only = on")
        self.assert_one_error(self.path(cluster.url("uplinkd")), "store.url", "is read-only")


if __name__ == "__main__":
    unittest.main()
