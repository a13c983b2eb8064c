"""Certificates that are taken back, and authorities that may not vouch for everything."""

import hashlib
import http.client
import json
import pathlib
import ssl
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

    def write_list(self, *revoked, pki=None, lists=None, over=False):
        """What the authority's own tool makes of these certificates."""
        pki, lists = pki or self.running.pki, lists or self.lists
        own = self.folder / "authority"
        own.mkdir(exist_ok=True)
        lines = []
        for certificate in revoked:
            serial = self.openssl("x509", "-in", certificate, "-noout", "-serial").decode().strip().split("=")[1]
            lines.append(f"R\t400101000000Z\t250101000000Z\t{serial}\tunknown\t/CN=robot\n")
        (own / "index.txt").write_text("".join(lines))
        (own / "crlnumber").write_text("01\n")
        (own / "ca.cnf").write_text(GENERATED.format(folder=own))
        aside = lists.with_suffix(".new")
        dates = ("-crl_lastupdate", "20240101000000Z", "-crl_nextupdate", "20240102000000Z") if over else ()
        self.openssl("ca", "-gencrl", "-config", own / "ca.cnf", "-cert", pki / "ca.crt", "-keyfile", pki / "ca.key",
                     *dates, "-out", aside)  # fmt: skip
        aside.replace(lists)

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

    def test_lists_that_are_unread_or_over_show_and_those_that_were_good_count(self):
        self.write_list(self.pairs[RURI][0])
        self.running.environment = {"UPLINKD_TLS_CLIENT_CRL_FILE": str(self.lists)}
        self.running.start()
        self.assertEqual(self.running.metric('uplinkd_degraded{reason="crl_unread"}'), 0)
        good = self.lists.read_bytes()
        self.lists.write_text("no list")
        self.wait_for_unread(1)
        self.assert_revoked(self.end_of(self.begin("held", RURI)))
        self.lists.write_bytes(good)
        self.wait_for_unread(0)
        self.write_list(self.pairs[OTHER][0], over=True)
        self.running.wait_for_line("crl_expired")
        self.wait_for_unread(1)
        self.assert_revoked(self.end_of(self.begin("held", OTHER)))

    def wait_for_unread(self, value):
        wait_until(self.running.process, lambda: self.running.metric('uplinkd_degraded{reason="crl_unread"}') == value,
                   SECONDS, f"crl_unread is {value}")  # fmt: skip

    def test_the_list_of_operators_authority_counts_for_them(self):
        operators = self.folder / "operators"
        uplinkctl("pki", "init", "--dir", operators)
        uplinkctl("pki", "operator", "--dir", operators, "--name", "ann", "--role", "admin", "--fleet", "*")
        self.write_list(pki=operators)
        pki = self.running.pki
        self.running.settings = f'[http]\ntls.certificate_file = "{pki}/server.crt"\ntls.key_file = "{pki}/server.key"\n'
        self.running.environment = {"UPLINKD_TLS_OPERATOR_CA_FILE": str(operators / "ca.crt"),
                                    "UPLINKD_TLS_OPERATOR_CRL_FILE": str(self.lists)}  # fmt: skip
        self.running.start()
        context = ssl.create_default_context(cafile=pki / "ca.crt")
        context.load_cert_chain(operators / "ann.crt", operators / "ann.key")
        held = http.client.HTTPSConnection(*self.running.http.rsplit(":", 1), timeout=SECONDS, context=context)
        self.addCleanup(held.close)

        def status():
            held.request("GET", "/api/v1/status")
            answer = held.getresponse()
            answer.read()
            return answer.status

        self.assertEqual(status(), 200)
        self.write_list(operators / "ann.crt", pki=operators)
        wait_until(self.running.process, lambda: status() == 401, SECONDS, "the list counts")

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

    def authorities(self, **entries):
        """A folder of authorities, each with its folder of files and its entry."""
        folder = self.folder / "authorities"
        folder.mkdir()
        for name, (pki, entry) in entries.items():
            (folder / f"{name}.pem").write_bytes((pki / "ca.crt").read_bytes())
            (folder / f"{name}.toml").write_text(entry)
        self.running.environment = {"UPLINKD_IDENTITY_AUTHORITIES": str(folder)}
        return folder

    def test_a_list_counts_for_its_own_authority_and_not_for_a_namesake(self):
        subject = self.openssl("x509", "-in", self.running.pki / "ca.crt", "-noout", "-subject", "-nameopt", "RFC2253")
        name = subject.decode().strip().removeprefix("subject=CN=")
        namesake = self.folder / "namesake"
        uplinkctl("pki", "init", "--dir", namesake, "--common-name", name)
        folder = self.authorities(own=(self.running.pki, ""), other=(namesake, 'crl_file = "other.crl"\n'))
        self.write_list(self.pairs[RURI][0], pki=namesake, lists=folder / "other.crl")
        self.running.start()
        stream = self.held(RURI, 1)
        self.assertEqual(self.running.metric('uplinkd_revocations{source="files"}'), 1)
        self.write_list(self.pairs[RURI][0], lists=folder / "own.crl")
        (folder / "own.toml").write_text('crl_file = "own.crl"\n')
        self.assert_revoked(self.end_of(stream))

    def test_an_authority_vouches_for_its_fleets_alone(self):
        entry = 'roles = ["robot"]\nfleets = ["north"]\n'
        authorities = self.authorities(hall=(self.running.pki, entry))
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

    def test_a_stream_outside_the_new_entry_of_its_authority_ends(self):
        guests = self.folder / "guests"
        uplinkctl("pki", "init", "--dir", guests)
        uplinkctl("pki", "robot", "--dir", guests, "--ruri", OTHER, "--fleet", "acme", "--name", "r2")
        self.pairs[OTHER] = guests / "r2.crt", guests / "r2.key"
        folder = self.authorities(hall=(self.running.pki, 'fleets = ["acme"]\n'), guests=(guests, ""))
        self.running.start()
        stream, guest = self.held(RURI, 1), self.held(OTHER, 2)
        (folder / "guests.pem").unlink()
        end = self.end_of(guest)
        self.assertEqual((end["code"], end["details"]),
                         ("UNAUTHENTICATED", "client certificate: its authority is not trusted any more"))  # fmt: skip
        self.assertIsNone(stream.poll())
        (folder / "hall.toml").write_text('fleets = ["north"]\n')
        end = self.end_of(stream)
        self.assertEqual((end["code"], end["details"]),
                         ("UNAUTHENTICATED", "client certificate: its authority hall may not vouch for the fleet acme"))  # fmt: skip
        self.assertEqual(self.running.metric('uplinkd_certificates_denied_total{why="authority"}'), 2)

    def test_an_entry_counts_for_operators_also_where_their_authority_stands_in_a_file_of_its_own(self):
        both, alone = self.folder / "both", self.folder / "alone"
        for operators in (both, alone):
            uplinkctl("pki", "init", "--dir", operators)
            uplinkctl("pki", "operator", "--dir", operators, "--name", "ann", "--role", "admin", "--fleet", "*")
        uplinkctl("pki", "operator", "--dir", both, "--name", "vic", "--role", "viewer", "--fleet", "south")
        self.authorities(both=(both, 'roles = ["viewer"]\nfleets = ["south"]\n'))
        trusted = self.folder / "operators.crt"
        trusted.write_bytes((both / "ca.crt").read_bytes() + (alone / "ca.crt").read_bytes())
        pki = self.running.pki
        self.running.settings = f'[http]\ntls.certificate_file = "{pki}/server.crt"\ntls.key_file = "{pki}/server.key"\n'
        self.running.environment["UPLINKD_TLS_OPERATOR_CA_FILE"] = str(trusted)
        self.running.start()

        def answer(operators, name):
            context = ssl.create_default_context(cafile=pki / "ca.crt")
            context.load_cert_chain(operators / f"{name}.crt", operators / f"{name}.key")
            asking = http.client.HTTPSConnection(*self.running.http.rsplit(":", 1), timeout=SECONDS, context=context)
            self.addCleanup(asking.close)
            asking.request("GET", "/api/v1/robots")
            got = asking.getresponse()
            return got.status, got.read().decode()

        status, body = answer(both, "ann")
        self.assertEqual(status, 401, body)
        self.assertIn("its authority both may not vouch for the role admin", body)
        self.assertEqual(answer(both, "vic")[0], 200)
        self.assertEqual(answer(alone, "ann")[0], 200)

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
