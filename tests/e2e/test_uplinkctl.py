"""uplinkctl pki, held against the openssl program."""

import os
import stat
import unittest

from harness import BIN, EndToEnd, run, uplinkctl


class Pki(EndToEnd):
    def setUp(self):
        super().setUp()
        self.pki = self.folder / "pki"
        uplinkctl("pki", "init", "--dir", self.pki)

    def verify(self, name, purpose):
        run("openssl", "verify", "-x509_strict", "-purpose", purpose, "-CAfile", self.pki / "ca.crt",
            self.pki / f"{name}.crt")  # fmt: skip

    def text_of(self, name):
        return run("openssl", "x509", "-in", self.pki / f"{name}.crt", "-noout", "-text",
                   "-nameopt", "RFC2253").stdout  # fmt: skip

    def test_every_role_verifies_and_says_what_it_must(self):
        uplinkctl("pki", "server", "--dir", self.pki, "--host", "localhost", "--host", "127.0.0.1")
        uplinkctl("pki", "robot", "--dir", self.pki, "--ruri", "rcan://a/b/c/d/1", "--fleet", "north",
                  "--name", "r1")  # fmt: skip
        uplinkctl("pki", "operator", "--dir", self.pki, "--role", "admin", "--fleet", "*")
        uplinkctl("pki", "gateway", "--dir", self.pki, "--ruri", "rcan://a/1", "--ruri", "rcan://a/2")
        self.verify("server", "sslserver")
        for name in ("r1", "operator", "gateway"):
            self.verify(name, "sslclient")
        self.assertRegex(self.text_of("server"), "DNS:localhost, IP Address:127.0.0.1")
        robot = self.text_of("r1")
        for part in ("O=north", "URI:rcan://a/b/c/d/1", "TLS Web Client Authentication", "prime256v1",
                     "ecdsa-with-SHA256"):  # fmt: skip
            self.assertIn(part, robot)
        self.assertNotIn("OU=", robot)
        self.assertIn("OU=admin", self.text_of("operator"))
        uplinkctl("pki", "operator", "--dir", self.pki, "--role", "metrics", "--fleet", "north", "--name", "scraper")
        self.assertIn("OU=metrics", self.text_of("scraper"))
        self.assertIn("URI:rcan://a/1, URI:rcan://a/2", self.text_of("gateway"))
        self.assertIn("OU=gateway", self.text_of("gateway"))

    def test_a_server_certificate_is_no_client_and_the_other_way_round(self):
        uplinkctl("pki", "server", "--dir", self.pki, "--host", "localhost")
        uplinkctl("pki", "robot", "--dir", self.pki, "--ruri", "rcan://a", "--name", "r1")
        with self.assertRaises(AssertionError):
            self.verify("server", "sslclient")
        with self.assertRaises(AssertionError):
            self.verify("r1", "sslserver")

    def test_keep_makes_what_is_missing_and_leaves_the_rest(self):
        before = (self.pki / "ca.crt").read_bytes()
        for _ in range(2):
            uplinkctl("pki", "init", "--keep", "--dir", self.pki)
            uplinkctl("pki", "server", "--keep", "--dir", self.pki, "--host", "localhost")
        self.assertEqual((self.pki / "ca.crt").read_bytes(), before)
        self.verify("server", "sslserver")
        certificate = (self.pki / "server.crt").read_bytes()
        uplinkctl("pki", "server", "--keep", "--dir", self.pki, "--host", "localhost")
        self.assertEqual((self.pki / "server.crt").read_bytes(), certificate)
        uplinkctl("pki", "server", "--keep", "--force", "--dir", self.pki, "--host", "localhost", code=2)

    def test_keep_says_what_it_keeps(self):
        uplinkctl("pki", "server", "--dir", self.pki, "--host", "localhost")
        for verb, name in ((("init",), "ca"), (("server", "--host", "localhost"), "server")):
            done = uplinkctl("pki", *verb, "--keep", "--dir", self.pki)
            self.assertEqual(done.stdout, f"kept {self.pki}/{name}.crt\n")

    def test_keep_replaces_nothing_where_one_file_of_two_is_missing(self):
        uplinkctl("pki", "robot", "--dir", self.pki, "--ruri", "rcan://a", "--name", "r1")
        robot = ("robot", "--ruri", "rcan://a", "--name", "r1")
        for verb, name in ((robot, "r1"), (("init",), "ca")):
            for there, missing in (("key", "crt"), ("crt", "key")):
                with self.subTest(name=name, there=there):
                    lone, gone = self.pki / f"{name}.{there}", self.pki / f"{name}.{missing}"
                    before, text = lone.read_bytes(), gone.read_bytes()
                    gone.unlink()
                    done = uplinkctl("pki", *verb, "--keep", "--dir", self.pki, code=1)
                    self.assertIn(f"{lone} is there and {gone} is missing; restore", done.stderr)
                    self.assertEqual(lone.read_bytes(), before)
                    self.assertFalse(gone.exists())
                    gone.write_bytes(text)

    def test_keep_refuses_what_a_server_could_not_use(self):
        server = ("pki", "server", "--keep", "--dir", self.pki, "--host", "localhost")
        uplinkctl(*server)
        done = uplinkctl(*server, "--host", "192.0.2.7", code=1)
        self.assertIn("server.crt: is for localhost, and not for 192.0.2.7; --force", done.stderr)
        certificate = self.pki / "server.crt"
        before = certificate.read_bytes()
        uplinkctl("pki", "init", "--dir", self.pki, "--force")
        self.assertIn("was not signed by the authority of", uplinkctl(*server, code=1).stderr)
        self.assertEqual(certificate.read_bytes(), before)

    def test_keep_refuses_another_identity_and_a_key_that_others_may_read(self):
        robot = ("pki", "robot", "--keep", "--dir", self.pki, "--name", "r1", "--ruri")
        uplinkctl(*robot, "rcan://a", "--fleet", "north")
        uplinkctl(*robot, "rcan://a", "--fleet", "north")
        done = uplinkctl(*robot, "rcan://b", "--fleet", "south", code=1)
        self.assertIn("r1.crt: has the fleet north, and not south; the RURI rcan://a, and not rcan://b; --force",
                      done.stderr)  # fmt: skip
        viewer = ("pki", "operator", "--keep", "--dir", self.pki, "--name", "ann", "--role")
        uplinkctl(*viewer, "viewer")
        self.assertIn("has the role viewer, and not admin", uplinkctl(*viewer, "admin", code=1).stderr)
        key = self.pki / "r1.key"
        key.chmod(0o644)
        done = uplinkctl(*robot, "rcan://a", "--fleet", "north", code=1)
        self.assertIn(f"{key}: others than its owner may read or write the key (mode 0644)", done.stderr)

    def test_a_copy_for_the_server_lacks_the_authoritys_key(self):
        copy = self.folder / "tls"
        for _ in range(2):
            uplinkctl("pki", "server", "--keep", "--dir", self.pki, "--host", "localhost", "--copy-to", copy)
            files = {file.name: file.read_bytes() for file in copy.iterdir()}
            self.assertEqual(sorted(files), ["ca.crt", "server.crt", "server.key"])
            for name, content in files.items():
                self.assertEqual(content, (self.pki / name).read_bytes(), name)

    def test_a_copy_goes_into_no_folder_that_others_may_write(self):
        copy = self.folder / "tls"
        copy.mkdir()
        copy.chmod(0o777)
        server = ("pki", "server", "--keep", "--dir", self.pki, "--host", "localhost", "--copy-to", copy)
        self.assertIn(f"{copy}: others than the folder's owner may write into it (mode 0777)",
                      uplinkctl(*server, code=1).stderr)  # fmt: skip
        self.assertEqual(list(copy.iterdir()), [])
        copy.chmod(0o755)
        uplinkctl(*server)

    def test_what_a_killed_call_left_is_removed(self):
        copy = self.folder / "tls"
        copy.mkdir(mode=0o700)
        left = [folder / f".server.{kind}.new" for folder in (self.pki, copy) for kind in ("crt", "key")]
        for file in left:
            file.write_text("half", encoding="utf-8")
        uplinkctl("pki", "server", "--dir", self.pki, "--host", "localhost", "--copy-to", copy)
        for file in left:
            self.assertFalse(file.exists(), file)

    def test_every_file_is_for_its_owner_only(self):
        uplinkctl("pki", "server", "--dir", self.pki, "--host", "localhost")
        uplinkctl("pki", "robot", "--dir", self.pki, "--count", "3")
        files = sorted(self.pki.iterdir())
        self.assertEqual(len(files), 2 * (1 + 1 + 3))
        for file in files:
            self.assertEqual(stat.S_IMODE(file.stat().st_mode), 0o600, file)
        self.assertEqual(stat.S_IMODE(self.pki.stat().st_mode), 0o700)
        self.assertIn("/robot-0003", self.text_of("robot-0003"))

    def test_nothing_is_overwritten_without_force(self):
        authority = (self.pki / "ca.crt").read_bytes()
        done = uplinkctl("pki", "init", "--dir", self.pki, code=1)
        self.assertIn(str(self.pki / "ca.crt"), done.stderr)
        self.assertEqual((self.pki / "ca.crt").read_bytes(), authority)
        uplinkctl("pki", "init", "--dir", self.pki, "--force")
        self.assertNotEqual((self.pki / "ca.crt").read_bytes(), authority)

    def test_a_validity_is_kept(self):
        uplinkctl("pki", "robot", "--dir", self.pki, "--ruri", "rcan://a", "--name", "r1", "--days", "2")
        day = 24 * 3600
        certificate = self.pki / "r1.crt"
        run("openssl", "x509", "-in", certificate, "-noout", "-checkend", 2 * day - 600)
        run("openssl", "x509", "-in", certificate, "-noout", "-checkend", 2 * day + 600, code=1)

    def test_wrong_use_ends_with_2(self):
        for arguments in (
            [], ["pki"], ["robots", "drive"], ["pki", "server", "--dir", self.pki],
            ["pki", "robot", "--dir", self.pki, "--ruri", "http://a"],
            ["pki", "robot", "--dir", self.pki], ["pki", "robot", "--count", "0"],
            ["pki", "robot", "--dir", self.pki, "--ruri", "rcan://a", "--name", "ca"],
            ["pki", "robot", "--dir", self.pki, "--ruri", "rcan://a", "--name", "../r1"],
            ["pki", "operator", "--dir", self.pki, "--role", "owner"],
            ["pki", "init", "--dir", self.pki, "--days", "0"],
        ):  # fmt: skip
            with self.subTest(arguments):
                uplinkctl(*arguments, code=2)

    def test_a_missing_authority_ends_with_1_and_is_named(self):
        nowhere = self.folder / "nowhere"
        done = uplinkctl("pki", "robot", "--dir", nowhere, "--ruri", "rcan://a", code=1)
        self.assertIn(str(nowhere / "ca.crt"), done.stderr)


class Config(EndToEnd):
    def test_check_reads_the_environment_as_the_server_does(self):
        config = self.folder / "empty.toml"
        config.write_text("", encoding="utf-8")
        env = dict(os.environ, UPLINKD_LIMITS_ROBOTS_MAX="none", UPLINKD_NO_SUCH="1")
        done = run(BIN / "uplinkctl", "config", "check", config, code=2, env=env)
        self.assertIn("limits.robots_max", done.stderr)
        self.assertIn("UPLINKD_NO_SUCH", done.stderr)

    def test_a_wrong_noun_is_named(self):
        done = run(BIN / "uplinkctl", "drive", code=2)
        self.assertIn("uplinkctl: drive: unknown command; uplinkctl --help", done.stderr)

    def test_a_wrong_verb_is_named(self):
        for noun in ("pki", "store", "config", "robots"):
            done = run(BIN / "uplinkctl", noun, "drive", code=2)
            self.assertIn(f"uplinkctl: {noun} drive: unknown command", done.stderr)
        self.assertIn("a command is missing", run(BIN / "uplinkctl", "pki", code=2).stderr)

    def test_check_reports_every_problem(self):
        server = self.server()
        path = server.configuration()
        self.assertIn("good", uplinkctl("config", "check", path).stdout)
        path.write_text("[limits]\nrobots_max = -1\nno_such_key = 3\n", encoding="utf-8")
        done = uplinkctl("config", "check", path, code=2)
        for problem in ("robots_max", "no_such_key"):
            self.assertIn(problem, done.stderr)


if __name__ == "__main__":
    unittest.main()
