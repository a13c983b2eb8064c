"""Agents of another gRPC library whose streams end each in its own way (relay_ends.py)."""

import datetime
import os
import pathlib
import subprocess

from harness import SOURCE, EndToEnd, run, uplinkctl
from tcp_proxy import TcpProxy

PYTHON = "/usr/bin/python3"
AGENT = pathlib.Path(__file__).with_name("relay_ends.py")
RURI = "rcan://example.org/acme/rover/"
SECONDS = 60
# Keepalive needs 40 s to find out, and so does an agent that does not read.
PATIENCE_SECONDS = 120
DRAIN = '[drain]\ntimeout = "5s"\n'

# What makes the authority of the pki sign a certificate with any end, as `pki robot` does not.
AUTHORITY = """
[ca]
default_ca = it
[it]
new_certs_dir = {folder}
database = {folder}/index.txt
serial = {folder}/serial
default_md = sha256
policy = any
x509_extensions = robot
[any]
organizationName = supplied
commonName = supplied
[robot]
basicConstraints = critical, CA:FALSE
keyUsage = critical, digitalSignature
extendedKeyUsage = clientAuth
subjectAltName = URI:{ruri}
"""


class EndingAgents(EndToEnd):
    """Before the first agent: `serve`."""

    def serve(self, server):
        """Starts the server to which they stream; also through `proxy`."""
        self.running = server.start()
        self.modules = self.running.folder / "modules"
        self.modules.mkdir()
        subprocess.run(
            ["protoc", f"--proto_path={SOURCE / 'proto'}", f"--python_out={self.modules}", "uplink/v1/relay.proto"],
            check=True, timeout=SECONDS,
        )  # fmt: skip
        self.proxy = TcpProxy(self.running.relay)
        self.addCleanup(self.proxy.close)

    def agent(self, act, name=None, through=None):
        """An agent that streams, of the robot `name`, by default that of its act."""
        name = name or act
        if not self.key(name, "crt").exists():
            uplinkctl("pki", "robot", "--dir", self.running.pki, "--ruri", RURI + name, "--fleet", "acme", "--name", name)
        files = [str(file) for file in (self.key("ca", "crt"), self.key(name, "crt"), self.key(name, "key"))]
        agent = subprocess.Popen(
            [PYTHON, str(AGENT), act, through or self.running.relay, *files],
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(self.modules), str(AGENT.parent)])},
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        self.addCleanup(self.end, agent)
        self.assertEqual(agent.stdout.readline().strip(), "welcome")
        return agent

    @staticmethod
    def end(agent):
        agent.kill()
        agent.communicate()

    def key(self, name, kind):
        return self.running.pki / f"{name}.{kind}"

    def certify(self, name, seconds):
        """A certificate for the robot `name` that expires so soon."""
        folder = self.running.folder / f"authority-{name}"
        folder.mkdir()
        (folder / "index.txt").touch()
        (folder / "serial").write_text("4242\n", encoding="utf-8")
        settings = folder / "openssl.cnf"
        settings.write_text(AUTHORITY.format(folder=folder, ruri=RURI + name), encoding="utf-8")
        end = datetime.datetime.now(datetime.timezone.utc) + datetime.timedelta(seconds=seconds)
        run("openssl", "req", "-new", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
            "-keyout", self.key(name, "key"), "-subj", f"/O=acme/CN={name}", "-out", folder / "request")  # fmt: skip
        run("openssl", "ca", "-batch", "-notext", "-config", settings, "-cert", self.key("ca", "crt"),
            "-keyfile", self.key("ca", "key"), "-enddate", end.strftime("%Y%m%d%H%M%SZ"),
            "-in", folder / "request", "-out", self.key(name, "crt"))  # fmt: skip
