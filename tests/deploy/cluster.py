"""A Kubernetes of one node, in namespaces of its own: network, mounts and processes end with it. It has no DNS,
no proxy for Services and no provisioner: pods are reached by their addresses, volumes are folders."""

import contextlib
import json
import os
import pathlib
import shutil
import subprocess

from docker import POSTGRES
from images import MINUTES, TOOLS, WORK, Podman, run
from waiting import wait_for

NODE, ADDRESS = "node", "192.0.2.1"
TOKEN = "of-this-test-alone"
# kubelet sets them for the whole machine.
SYSCTLS = ("kernel.panic", "kernel.panic_on_oops", "vm.overcommit_memory", "vm.panic_on_oom",
           "kernel.keys.root_maxkeys", "kernel.keys.root_maxbytes")  # fmt: skip
NAMESPACES = """
set -e
mount --make-rshared /
mount -t proc proc /proc
ip link set lo up
ip link add node type bridge
ip addr add {address}/24 dev node
ip link set node up
echo 1 >/proc/sys/net/ipv4/ip_forward
echo ready
exec tail -f /dev/null
"""
KUBECONFIG = """
apiVersion: v1
kind: Config
clusters: [{{name: it, cluster: {{server: "https://127.0.0.1:6443", insecure-skip-tls-verify: true}}}}]
users: [{{name: it, user: {{token: {token}}}}}]
contexts: [{{name: it, context: {{cluster: it, user: it}}}}]
current-context: it
"""
KUBELET = """
apiVersion: kubelet.config.k8s.io/v1beta1
kind: KubeletConfiguration
authentication: {{anonymous: {{enabled: true}}, webhook: {{enabled: false}}}}
authorization: {{mode: AlwaysAllow}}
containerRuntimeEndpoint: unix://{folder}/containerd.sock
cgroupDriver: cgroupfs
failCgroupV1: false
failSwapOn: false
featureGates: {{KubeletInUserNamespace: true}}
resolvConf: {folder}/resolv.conf
evictionHard: {{memory.available: "1Mi", nodefs.available: "1%", imagefs.available: "1%"}}
imageGCHighThresholdPercent: 100
syncFrequency: 2s
"""
CONTAINERD = """
version = 2
root = "{folder}/containerd"
state = "{folder}/containerd-state"
[grpc]
address = "{folder}/containerd.sock"
[plugins."io.containerd.grpc.v1.cri"]
sandbox_image = "localhost/pause:1"
restrict_oom_score_adj = true
disable_apparmor = true
[plugins."io.containerd.grpc.v1.cri".cni]
bin_dir = "/usr/lib/cni"
conf_dir = "{folder}/cni"
[plugins."io.containerd.grpc.v1.cri".containerd.runtimes.runc]
runtime_type = "io.containerd.runc.v2"
[plugins."io.containerd.grpc.v1.cri".containerd.runtimes.runc.options]
SystemdCgroup = false
"""
CNI = {
    "cniVersion": "0.4.0",
    "name": "pods",
    "plugins": [
        {"type": "bridge", "bridge": "pods", "isGateway": True, "hairpinMode": True,
         "ipam": {"type": "host-local", "subnet": "198.51.100.0/24", "dataDir": ""}},
    ],
}  # fmt: skip


class Cluster:
    def __init__(self):
        self.folder = WORK / "k8s"
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.ctr = ("ctr", "--address", self.folder / "containerd.sock", "--namespace", "k8s.io")
        self.sysctls = {name: self.sysctl(name) for name in SYSCTLS}
        self.started = []
        # Its first process: what it holds ends with it.
        script = NAMESPACES.format(address=ADDRESS)
        self.holder = subprocess.Popen(
            ["unshare", "--net", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c", script],
            stdout=subprocess.PIPE,
        )  # fmt: skip
        try:
            assert self.holder.stdout.readline() == b"ready\n"
            (self.first,) = run("pgrep", "--parent", self.holder.pid).stdout.split()
            self.images()
            self.write_files()
        except BaseException:
            self.close()
            raise

    @staticmethod
    def sysctl(name):
        return pathlib.Path("/proc/sys", name.replace(".", "/")).read_text(encoding="utf-8").strip()

    def images(self):
        podman = Podman()
        try:
            image = podman.build()
            self.image = image.removeprefix("localhost/")
            archive = self.folder / "uplinkd.tar"
            root = self.folder / "pause"
            root.mkdir()
            shutil.copy(shutil.which("catatonit"), root / "catatonit")
            run("tar", "-cf", self.folder / "pause-root.tar", "-C", root, "catatonit")
            podman("import", "--change", 'ENTRYPOINT ["/catatonit", "-P"]', self.folder / "pause-root.tar",
                   "localhost/pause:1")  # fmt: skip
            podman("tag", image, f"docker.io/library/{self.image}")
            podman("save", "--format", "docker-archive", "--multi-image-archive", "--output", archive,
                   f"docker.io/library/{self.image}", "localhost/pause:1")  # fmt: skip
        finally:
            podman.close()

    def load_postgres(self):
        """A stand-in for PostgreSQL's image, on the node as localhost/postgres:15."""
        podman = Podman()
        try:
            podman.provide("localhost/stand-in", "postgres-stand-in", "postgresql-15")
            folder = self.folder / "postgres"
            folder.mkdir()
            (folder / "entry.sh").write_text(POSTGRES, encoding="utf-8")
            (folder / "Dockerfile").write_text(
                'FROM localhost/stand-in\nCOPY --chmod=755 entry.sh /\nENTRYPOINT ["/entry.sh"]\n', encoding="utf-8"
            )
            podman("build", "--pull-never", "--tag", "localhost/postgres:15", folder, timeout=10 * MINUTES)
            podman("save", "--format", "docker-archive", "--output", self.folder / "postgres.tar",
                   "localhost/postgres:15", timeout=10 * MINUTES)  # fmt: skip
        finally:
            podman.close()
        self.inside(*self.ctr, "images", "import", self.folder / "postgres.tar", timeout=10 * MINUTES)

    def write_files(self):
        values = {"folder": self.folder, "token": TOKEN}
        for name, text in (("kubeconfig", KUBECONFIG), ("kubelet.yaml", KUBELET), ("containerd.toml", CONTAINERD)):
            (self.folder / name).write_text(text.format(**values), encoding="utf-8")
        (self.folder / "resolv.conf").touch()
        (self.folder / "tokens").write_text(f'{TOKEN},admin,admin,"system:masters"\n', encoding="utf-8")
        CNI["plugins"][0]["ipam"]["dataDir"] = str(self.folder / "addresses")
        (self.folder / "cni").mkdir()
        (self.folder / "cni/pods.conflist").write_text(json.dumps(CNI), encoding="utf-8")
        run("openssl", "genrsa", "-out", self.folder / "accounts.key", "2048")
        run("openssl", "rsa", "-in", self.folder / "accounts.key", "-pubout", "-out", self.folder / "accounts.pub")

    def start(self, name, *arguments):
        """A program of the cluster, in its namespaces; its log is NAME.log."""
        program = TOOLS / "bin" / name
        log = (self.folder / f"{name}.log").open("wb")
        self.started.append((name, log, subprocess.Popen(
            [*self.enter(), str(program if program.exists() else name), *map(str, arguments)],
            stdout=log, stderr=subprocess.STDOUT,
        )))  # fmt: skip

    def enter(self):
        return ["nsenter", "--net", "--mount", "--pid", "--target", self.first]

    def inside(self, *command, code=0, timeout=2 * MINUTES):
        environment = {**os.environ, "KUBECONFIG": str(self.folder / "kubeconfig"), "HOME": str(self.folder)}
        return run(*self.enter(), *command, code=code, timeout=timeout, env=environment)

    def kubectl(self, *arguments, code=0, timeout=2 * MINUTES):
        program = TOOLS / "bin/kubectl"
        return self.inside(program if program.exists() else "kubectl", *arguments, code=code, timeout=timeout)

    def helm(self, *arguments, code=0, timeout=5 * MINUTES):
        return self.inside(TOOLS / "bin/helm", *arguments, code=code, timeout=timeout)

    def up(self):
        """Starts it; the node is ready afterwards."""
        folder, config = self.folder, self.folder / "kubeconfig"
        self.start("etcd", "--data-dir", folder / "etcd", "--listen-client-urls", "http://127.0.0.1:2379",
                   "--advertise-client-urls", "http://127.0.0.1:2379", "--listen-peer-urls", "http://127.0.0.1:2380")  # fmt: skip
        self.start("kube-apiserver", "--etcd-servers=http://127.0.0.1:2379", f"--advertise-address={ADDRESS}",
                   "--bind-address=127.0.0.1", "--kubelet-preferred-address-types=InternalIP",
                   f"--cert-dir={folder}/apiserver", "--allow-privileged=true",
                   "--service-cluster-ip-range=203.0.113.0/24", "--authorization-mode=RBAC",
                   f"--token-auth-file={folder}/tokens", "--service-account-issuer=https://kubernetes.default.svc",
                   f"--service-account-signing-key-file={folder}/accounts.key",
                   f"--service-account-key-file={folder}/accounts.pub")  # fmt: skip
        self.wait_for(lambda: self.answers("get", "--raw", "/readyz"), "the API server is ready")
        self.start("kube-controller-manager", f"--kubeconfig={config}", "--leader-elect=false",
                   f"--service-account-private-key-file={folder}/accounts.key",
                   f"--root-ca-file={folder}/apiserver/apiserver.crt", "--bind-address=127.0.0.1")  # fmt: skip
        self.start("kube-scheduler", f"--kubeconfig={config}", "--leader-elect=false", "--bind-address=127.0.0.1")
        self.start("containerd", "--config", folder / "containerd.toml")
        self.wait_for(lambda: self.tries(*self.ctr, "version"), "containerd answers")
        self.inside(*self.ctr, "images", "import", folder / "uplinkd.tar")
        self.start("kubelet", f"--config={folder}/kubelet.yaml", f"--kubeconfig={config}",
                   f"--root-dir={folder}/kubelet", f"--hostname-override={NODE}", f"--node-ip={ADDRESS}")  # fmt: skip
        self.wait_for(
            lambda: "True" in (self.answers("get", "node", NODE, "-o", "jsonpath={.status.conditions[-1:].status}") or ""),
            "the node is ready",
        )  # fmt: skip
        return self

    def tries(self, *command):
        with contextlib.suppress(AssertionError):
            self.inside(*command)
            return True
        return False

    def answers(self, *arguments):
        with contextlib.suppress(AssertionError):
            return self.kubectl(*arguments).stdout
        return None

    def wait_for(self, condition, what, seconds=2 * MINUTES):
        def look():
            for name, _, process in self.started:
                assert process.poll() is None, f"{name} ended: {self.log(name)}"
            return condition()

        try:
            return wait_for(look, seconds, what, [process.pid for _, _, process in self.started], every=0.5)
        except AssertionError as error:
            logs = "\n".join(f"{name}: {self.log(name)}" for name, _, _ in self.started)
            raise AssertionError(f"{error}\n{logs}") from None

    def log(self, name):
        return (self.folder / f"{name}.log").read_text(encoding="utf-8", errors="replace")[-1500:]

    def close(self):
        self.holder.kill()
        self.holder.wait(30)
        self.holder.stdout.close()
        for _, log, process in self.started:
            process.wait(30)
            log.close()
        for name, value in self.sysctls.items():
            if self.sysctl(name) != value:
                pathlib.Path("/proc/sys", name.replace(".", "/")).write_text(value, encoding="utf-8")
        for root in pathlib.Path("/sys/fs/cgroup").glob("**/kubepods"):
            for folder in sorted((f for f in root.glob("**/") if f.is_dir()), reverse=True):
                with contextlib.suppress(OSError):
                    folder.rmdir()
        shutil.rmtree(self.folder, ignore_errors=True)
