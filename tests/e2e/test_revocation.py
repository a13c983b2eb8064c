"""Certificates that are taken back, and authorities that may not vouch for everything."""

import hashlib
import json
import pathlib
import subprocess
import urllib.request

from harness import SOURCE, EndToEnd, uplinkctl, wait_until
from test_disk_full import NAMESPACE, may_mount

PYTHON = "/usr/bin/python3"
CLIENT = pathlib.Path(__file__).with_name("relay_client.py")
RURI = "rcan://example.org/acme/rover/r1"
OTHER = "rcan://example.org/acme/rover/r2"
SECONDS = 60
GENERATED = """
[ca]
default_ca = own
[own]
database = {folder}/index.txt
crlnumber = {folder}/crlnumber
default_md = sha256
default_crl_days = 30
"""


class Revocation(EndToEnd):
    def setUp(self):
        super().setUp()
        self.running = self.server()
        self.lists = self.folder / "robots.crl"
        self.modules = self.folder / "modules"
        self.modules.mkdir()
        subprocess.run(
            ["protoc", f"--proto_path={SOURCE / 'proto'}", f"--python_out={self.modules}", "uplink/v1/relay.proto"],
            check=True, timeout=SECONDS,
        )  # fmt: skip
        self.pairs = {ruri: self.robot(ruri) for ruri in (RURI, OTHER)}

    def robot(self, ruri):
        """The files of a robot's new certificate and its key."""
        name = ruri.rsplit("/", 1)[1]
        uplinkctl("pki", "robot", "--dir", self.running.pki, "--ruri", ruri, "--fleet", "acme", "--name", name)
        return self.running.pki / f"{name}.crt", self.running.pki / f"{name}.key"

    def begin(self, act, ruri):
        client = subprocess.Popen(
            [PYTHON, CLIENT, act, f"localhost:{self.running.relay.rsplit(':', 1)[1]}",
             self.running.pki / "ca.crt", *self.pairs[ruri]],
            stdout=subprocess.PIPE, env={"PYTHONPATH": str(self.modules), "PATH": "/usr/bin"},
        )  # fmt: skip
        self.addCleanup(client.stdout.close)
        self.addCleanup(client.wait)
        self.addCleanup(client.kill)
        return client

    def end_of(self, client):
        output, _ = client.communicate(timeout=SECONDS)
        return json.loads(output)

    def held(self, ruri, streams):
        client = self.begin("held", ruri)
        wait_until(self.running.process, lambda: self.running.metric("uplinkd_streams") == streams, SECONDS, "it streams")
        return client

    def openssl(self, *arguments):
        return subprocess.run(["openssl", *map(str, arguments)], check=True, capture_output=True, timeout=SECONDS).stdout

    def write_list(self, *revoked):
        """What the authority's own tool makes of these certificates."""
        own = self.folder / "authority"
        own.mkdir(exist_ok=True)
        lines = []
        for certificate in revoked:
            serial = self.openssl("x509", "-in", certificate, "-noout", "-serial").decode().strip().split("=")[1]
            lines.append(f"R\t400101000000Z\t250101000000Z\t{serial}\tunknown\t/CN=robot\n")
        (own / "index.txt").write_text("".join(lines))
        (own / "crlnumber").write_text("01\n")
        (own / "ca.cnf").write_text(GENERATED.format(folder=own))
        aside = self.lists.with_suffix(".new")
        self.openssl("ca", "-gencrl", "-config", own / "ca.cnf", "-cert", self.running.pki / "ca.crt", "-keyfile",
                     self.running.pki / "ca.key", "-out", aside)  # fmt: skip
        aside.replace(self.lists)

    def assert_revoked(self, end):
        self.assertEqual((end["code"], end["details"]), ("UNAUTHENTICATED", "certificate revoked"))

    def test_a_list_of_the_authority_ends_a_stream_and_no_other(self):
        self.write_list()
        self.running.environment = {"UPLINKD_TLS_CLIENT_CRL_FILE": str(self.lists)}
        self.running.start()
        stolen, other = self.held(RURI, 1), self.held(OTHER, 2)
        self.write_list(self.pairs[RURI][0])
        self.assert_revoked(self.end_of(stolen))
        self.assert_revoked(self.end_of(self.begin("held", RURI)))
        self.assertIsNone(other.poll())
        self.assertEqual(self.running.metric('uplinkd_revocations{source="files"}'), 1)
        self.assertEqual(self.running.metric('uplinkd_certificates_denied_total{why="ended"}'), 1)

    def test_a_broken_list_refuses_the_start_and_later_leaves_the_last(self):
        self.lists.write_text("no list")
        self.running.environment = {"UPLINKD_TLS_CLIENT_CRL_FILE": str(self.lists)}
        with self.assertRaises(AssertionError) as refused:
            self.running.start()
        self.assertIn("tls.client_crl_file", str(refused.exception))
        self.write_list(self.pairs[RURI][0])
        self.running.start()
        self.lists.write_text("no list")
        self.running.wait_for_line("crl_unreadable")
        self.assert_revoked(self.end_of(self.begin("held", RURI)))

    def test_a_key_that_an_operator_revokes_is_no_way_back(self):
        self.running.start()
        stolen = self.held(RURI, 1)
        public = self.openssl("x509", "-in", self.pairs[RURI][0], "-noout", "-pubkey")
        der = subprocess.run(["openssl", "pkey", "-pubin", "-outform", "DER"], input=public, check=True,
                             capture_output=True, timeout=SECONDS).stdout  # fmt: skip
        body = json.dumps({"keySha256": hashlib.sha256(der).hexdigest(), "reason": "stolen"}).encode()
        request = urllib.request.Request(f"http://{self.running.http}/api/v1/certificates/revoke", body,
                                         {"Content-Type": "application/json"})  # fmt: skip
        with urllib.request.urlopen(request, timeout=SECONDS) as answer:
            self.assertEqual(answer.status, 200)
        self.assert_revoked(self.end_of(stolen))
        self.running.close()
        self.running.start()
        self.assert_revoked(self.end_of(self.begin("held", RURI)))

    def test_an_authority_vouches_for_its_fleets_alone(self):
        authorities = self.folder / "authorities"
        authorities.mkdir()
        (authorities / "hall.pem").write_bytes((self.running.pki / "ca.crt").read_bytes())
        (authorities / "hall.toml").write_text('roles = ["robot"]\nfleets = ["north"]\n')
        self.running.environment = {"UPLINKD_IDENTITY_AUTHORITIES": str(authorities)}
        self.running.start()
        end = self.end_of(self.begin("wrong_hello", RURI))
        self.assertEqual(end["code"], "UNAUTHENTICATED")
        self.assertIn("its authority hall may not vouch for the fleet acme", end["details"])
        (authorities / "hall.toml").write_text('roles = ["robot"]\nfleets = ["acme"]\n')
        wait_until(
            self.running.process,
            lambda: self.end_of(self.begin("wrong_hello", RURI))["code"] == "INVALID_ARGUMENT",
            SECONDS, "its new entry counts",
        )  # fmt: skip

    def test_a_folder_of_kubernetes_is_open_by_its_mode_and_read_only(self):
        authorities = self.folder / "authorities"
        authorities.mkdir()
        (authorities / "hall.pem").write_bytes((self.running.pki / "ca.crt").read_bytes())
        (authorities / "hall.toml").touch()
        authorities.chmod(0o777)
        self.running.environment = {"UPLINKD_IDENTITY_AUTHORITIES": str(authorities)}
        with self.assertRaises(AssertionError) as refused:
            self.running.start()
        self.assertIn("everybody on this machine may write it", str(refused.exception))
        if may_mount():
            read_only = 'mount --bind "$1" "$1" && mount -o remount,bind,ro "$1" && shift && exec "$@"'
            self.running.wrapper = [*NAMESPACE, "sh", "-c", read_only, "sh", str(authorities)]
            self.running.start()
