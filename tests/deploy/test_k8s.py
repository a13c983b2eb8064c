"""The chart in a real cluster of one node. On SQLite: install, `helm test`, an upgrade under a fleet, a server that
hangs, a rollback from an image that is not there, and an uninstall that keeps the claim. On PostgreSQL: the
migration, and two servers that are replaced one by one under a fleet."""

import json
import os
import pathlib
import signal
import subprocess
import time
import unittest

from cluster import Cluster
from images import BIN, MINUTES, SOURCE, run

CHART = SOURCE / "deploy/helm/uplinkd"
RELEASE, CLAIM = "uplinkd", "data-uplinkd-0"
RELAY_PORT, HTTP_PORT = 17443, 17480
VALUES = ("image.pullPolicy=Never", "tls.secret=uplinkd-tls", "service.type=ClusterIP", "store.sqlite.size=1Gi",
          "resources.requests.cpu=50m", "resources.requests.memory=64Mi", "resources.limits.memory=512Mi")  # fmt: skip
VOLUME = """
apiVersion: v1
kind: PersistentVolume
metadata: {{name: robots}}
spec:
  capacity: {{storage: 1Gi}}
  accessModes: [ReadWriteOnce]
  persistentVolumeReclaimPolicy: Retain
  hostPath: {{path: {path}}}
"""
DATABASE = """
apiVersion: v1
kind: Pod
metadata: {name: postgres}
spec:
  enableServiceLinks: false
  automountServiceAccountToken: false
  containers:
    - name: postgres
      image: localhost/postgres:15
      imagePullPolicy: Never
      env:
        - {name: POSTGRES_USER, value: uplinkd_owner}
        - {name: POSTGRES_DB, value: uplinkd}
        - {name: POSTGRES_PASSWORD_FILE, value: /run/secrets/owner_password}
      readinessProbe:
        exec: {command: [pg_isready, --quiet, --host, localhost, --dbname, uplinkd, --username, uplinkd_owner]}
        periodSeconds: 2
      volumeMounts:
        - {name: data, mountPath: /var/lib/postgresql/data}
        - {name: roles, mountPath: /docker-entrypoint-initdb.d}
        - {name: passwords, mountPath: /run/secrets}
  volumes:
    - {name: data, emptyDir: {}}
    - {name: roles, configMap: {name: roles, defaultMode: 0755}}
    - {name: passwords, secret: {secretName: passwords, defaultMode: 0444}}
"""


def setUpModule():
    began = time.monotonic()
    Release.cluster = Cluster()
    # Last of all: tests stop their own programs before.
    unittest.addModuleCleanup(Release.cluster.close)
    Release.cluster.up()
    Release.folder = Release.cluster.folder
    Release.pki = Release.folder / "pki"
    Release.make_secrets()
    print(f"\ncluster ready after {time.monotonic() - began:.0f} s")


class Release(unittest.TestCase):
    """One release at a time; the steps of a test follow each other as in an operator's life."""

    cluster = folder = pki = None

    @classmethod
    def make_secrets(cls):
        run(BIN / "uplinkctl", "pki", "init", "--dir", cls.pki)
        run(BIN / "uplinkctl", "pki", "server", "--dir", cls.pki, "--host", RELEASE, "--host", "127.0.0.1")
        for name, files in (
            ("uplinkd-tls", {"tls.crt": "server.crt", "tls.key": "server.key", "ca.crt": "ca.crt"}),
            ("authority", {"ca.crt": "ca.crt", "ca.key": "ca.key"}),
        ):
            literals = [f"--from-file={key}={cls.pki}/{file}" for key, file in files.items()]
            cls.cluster.kubectl("create", "secret", "generic", name, *literals)

    def helm(self, verb, *sets, flags=(), code=0):
        words = [word for value in (*VALUES, *sets) for word in ("--set", value)]
        return self.cluster.helm(verb, RELEASE, CHART, *words, *flags, code=code)

    def deploy(self, verb, *sets):
        return self.helm(verb, *sets, flags=("--wait", "--timeout", "150s"))

    def go_through(self, *steps):
        # Whatever a test leaves, the next one finds no release.
        self.addCleanup(self.cluster.helm, "uninstall", RELEASE, "--ignore-not-found", "--wait", "--timeout", "90s")
        for step in steps:
            began = time.monotonic()
            try:
                step()
            except AssertionError:
                print(self.cluster.answers("describe", "pods"), self.cluster.answers("logs", "uplinkd-0", "--tail=30"))
                raise
            print(f"{step.__name__}: {time.monotonic() - began:.0f} s", flush=True)

    def pods(self):
        """The servers that are ready, by name; None while one is not."""
        answer = self.cluster.answers("get", "pods", "-l", "app.kubernetes.io/component=server", "-o", "json")
        found = {}
        for pod in json.loads(answer)["items"] if answer else ():
            conditions = {each["type"]: each["status"] for each in pod["status"].get("conditions", [])}
            if conditions.get("Ready") != "True" or "deletionTimestamp" in pod["metadata"]:
                return None
            found[pod["metadata"]["name"]] = pod
        return found

    def ready_pods(self, number=1):
        """All pods, once they are ready; written down for the front."""

        def look():
            pods = self.pods()
            return pods if pods and len(pods) == number else None

        pods = self.cluster.wait_for(look, f"{number} pods are ready")
        self.write_places(pods)
        return pods

    def write_places(self, pods):
        found = [(pod["status"]["podIP"], self.process_of(pod)) for pod in pods.values()]
        lines = [f"{address} {process}\n" for address, process in found if process is not None]
        place = self.folder / "pods.new"
        place.write_text("".join(lines), encoding="utf-8")
        place.rename(self.folder / "pods")

    def process_of(self, pod):
        """The server's process: the one of its program in the pod's control group. None if it has ended."""
        uid = pod["metadata"]["uid"]
        for pid in run("pgrep", "--full", "^/usr/bin/uplinkd --config").stdout.split():
            try:
                groups = pathlib.Path(f"/proc/{pid}/cgroup").read_text(encoding="utf-8")
            except (FileNotFoundError, ProcessLookupError):
                continue
            if uid in groups:
                return int(pid)
        return None

    def start_front(self):
        # It finds the pods' networks by the processes of this machine, so it is only in the cluster's network.
        front = subprocess.Popen(["nsenter", "--net", "--target", self.cluster.first, "python3",
                                  SOURCE / "tests/deploy/front.py", str(RELAY_PORT), str(HTTP_PORT),
                                  self.folder / "pods"])  # fmt: skip
        self.addCleanup(front.wait, 30)
        self.addCleanup(front.kill)

    def start_fleet(self, robots, *flags):
        fleet = subprocess.Popen(
            [*self.cluster.enter(), BIN / "uplink-fleet", "--target", f"127.0.0.1:{RELAY_PORT}",
             "--http", f"127.0.0.1:{HTTP_PORT}", "--pki", self.pki, "--robots", str(robots), "--pace", "5",
             "--report", "json", "--for", "1h", "--settle-for", "120s", *flags],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self.addCleanup(fleet.stdout.close)
        self.addCleanup(fleet.kill)
        return fleet

    def assert_agrees(self, fleet):
        run("pkill", "--signal", "INT", "--parent", str(fleet.pid), "uplink-fleet")
        output, _ = fleet.communicate(timeout=5 * MINUTES)
        report = json.loads(output)
        self.assertTrue(report["ok"], [check for check in report["checks"] if not check["ok"]])

    def get(self, path):
        """What the API on the first pod's loopback answers; empty if it does not."""
        try:
            return self.cluster.inside("curl", "-sf", "-m", "10", f"http://127.0.0.1:{HTTP_PORT}{path}").stdout
        except AssertionError:
            return ""

    def wait_for_robots(self, robots):
        """Until that many are online, here or at another server."""

        def enough():
            lines = [line.split() for line in self.get("/metrics").splitlines()
                     if line.startswith("uplinkd_robots") and 'presence="online"' in line]  # fmt: skip
            return sum(float(value) for _, value in lines) >= robots

        self.cluster.wait_for(enough, f"{robots} robots are online", 60)


class Sqlite(Release):
    def test_the_life_of_a_release(self):
        # A folder of the node is no volume that Kubernetes gives to the pod's group: it is ours from the start.
        volume = self.folder / "volume"
        volume.mkdir(mode=0o750)
        os.chown(volume, 10001, 10001)
        manifest = self.folder / "volume.yaml"
        manifest.write_text(VOLUME.format(path=volume), encoding="utf-8")
        self.cluster.kubectl("apply", "-f", manifest)
        self.start_front()
        self.go_through(self.install, self.robot_test, self.upgrade_under_a_fleet, self.hang, self.roll_back,
                        self.uninstall)  # fmt: skip

    def pod(self):
        (pod,) = self.ready_pods().values()
        return pod

    def install(self):
        manifests = self.folder / "manifests.yaml"
        manifests.write_text(self.helm("template", "networkPolicy.enabled=true", flags=("--validate",)).stdout, encoding="utf-8")
        self.cluster.kubectl("apply", "--dry-run=server", "--validate=strict", "-f", manifests)
        self.deploy("install")
        pod = self.pod()
        status = pathlib.Path(f"/proc/{self.process_of(pod)}/status").read_text(encoding="utf-8")
        for said in ("NoNewPrivs:\t1", "CapEff:\t0000000000000000", "Uid:\t10001", "Seccomp:\t2"):
            self.assertIn(said, status)
        address = pod["status"]["podIP"]
        said = self.cluster.inside("curl", "-sf", "-H", "Host: uplinkd-metrics", f"http://{address}:7481/metrics")
        self.assertIn("uplinkd_build_info", said.stdout)
        self.cluster.inside("curl", "-s", "-m", "5", f"http://{address}:7480/readyz", code=7)
        print(self.cluster.kubectl("get", "all,pvc,pv,pdb,configmap").stdout)

    def robot_test(self):
        pod = self.pod()
        # There is no DNS here. Values of the test leave the server alone.
        alias = (f"tests.hostAliases[0].ip={pod['status']['podIP']}", f"tests.hostAliases[0].hostnames[0]={RELEASE}")
        self.deploy("upgrade", "tests.authoritySecret=authority", *alias)
        self.assertEqual(self.pod()["metadata"]["uid"], pod["metadata"]["uid"])
        said = self.cluster.helm("test", RELEASE, "--logs", "--timeout", "90s").stdout
        self.assertIn("verification: all agree", said)

    def upgrade_under_a_fleet(self):
        before = self.pod()["metadata"]["uid"]
        fleet = self.start_fleet(30)
        self.wait_for_robots(30)
        self.deploy("upgrade", "config.log.level=debug")
        after = self.pod()
        self.assertNotEqual(after["metadata"]["uid"], before)
        self.wait_for_robots(30)
        self.assert_agrees(fleet)

    def hang(self):
        pod = self.pod()
        os.kill(self.process_of(pod), signal.SIGSTOP)

        def restarted():
            pods = self.pods()
            return pods and pods["uplinkd-0"]["status"]["containerStatuses"][0]["restartCount"] == 1

        self.cluster.wait_for(restarted, "the liveness probe restarts a server that hangs", 4 * MINUTES)
        self.assertEqual(self.pod()["metadata"]["uid"], pod["metadata"]["uid"])

    def roll_back(self):
        self.helm("upgrade", "image.tag=missing")

        def stuck():
            answer = self.cluster.answers("get", "pod", "uplinkd-0", "-o", "json")
            statuses = json.loads(answer)["status"].get("containerStatuses") if answer else None
            return statuses and statuses[0]["state"].get("waiting", {}).get("reason") == "ErrImageNeverPull"

        self.cluster.wait_for(stuck, "the new pod has no image")
        self.cluster.helm("rollback", RELEASE, "--wait", "--timeout", "120s")
        self.pod()

    def uninstall(self):
        self.cluster.helm("uninstall", RELEASE, "--wait", "--timeout", "90s")
        phase = self.cluster.kubectl("get", "pvc", CLAIM, "-o", "jsonpath={.status.phase}").stdout
        self.assertEqual(phase, "Bound")
        left = self.cluster.kubectl("get", "statefulset,service,configmap,pdb,serviceaccount", "-o", "name",
                                    "-l", f"app.kubernetes.io/instance={RELEASE}").stdout  # fmt: skip
        self.assertEqual(left, "")
        # Installed again, it has the robots of before: the fleet's, and that of `helm test`.
        self.deploy("install")
        self.pod()
        self.assertEqual(len(json.loads(self.get("/api/v1/robots?pageSize=100"))["robots"]), 31)
        self.cluster.helm("uninstall", RELEASE, "--wait", "--timeout", "90s")


class Postgres(Release):
    def test_two_servers_are_replaced_one_by_one(self):
        self.cluster.load_postgres()
        self.start_front()
        self.go_through(self.database, self.install, self.upgrade_under_a_fleet)

    def database(self):
        kubectl = self.cluster.kubectl
        kubectl("create", "configmap", "roles", f"--from-file=roles.sh={SOURCE}/deploy/compose/postgres-roles.sh")
        kubectl("create", "secret", "generic", "passwords", "--from-literal=owner_password=of-the-owner",
                "--from-literal=store_password=of-the-servers")  # fmt: skip
        manifest = self.folder / "postgres.yaml"
        manifest.write_text(DATABASE, encoding="utf-8")
        kubectl("apply", "-f", manifest)
        kubectl("wait", "--for=condition=Ready", "pod/postgres", "--timeout=90s")
        address = kubectl("get", "pod", "postgres", "-o", "jsonpath={.status.podIP}").stdout
        of = "store.postgres"
        Postgres.sets = (
            "replicas=2", "store.type=postgres", f"{of}.url=postgresql://uplinkd@{address}/uplinkd",
            f"{of}.passwordSecret=passwords", f"{of}.passwordKey=store_password",
            f"{of}.migrate.url=postgresql://uplinkd_owner@{address}/uplinkd",
            f"{of}.migrate.passwordSecret=passwords", f"{of}.migrate.passwordKey=owner_password",
        )  # fmt: skip

    def install(self):
        self.deploy("install", *self.sets)
        self.ready_pods(2)
        self.assertEqual(json.loads(self.get("/api/v1/status"))["degraded"], [])

    def upgrade_under_a_fleet(self):
        before = self.ready_pods(2)
        # The counters are of each server alone: the robots' own acks decide.
        fleet = self.start_fleet(20, "--acks-only")
        self.wait_for_robots(20)
        # The migration runs first; then one server follows the other.
        self.helm("upgrade", *self.sets, "config.log.level=debug")
        least = [2]

        def replaced():
            answer = self.cluster.answers("get", "pods", "-l", "app.kubernetes.io/component=server", "-o", "json")
            pods = {pod["metadata"]["name"]: pod for pod in json.loads(answer)["items"]} if answer else {}
            ready = {name: pod for name, pod in pods.items() if "deletionTimestamp" not in pod["metadata"] and
                     any(c["type"] == "Ready" and c["status"] == "True" for c in pod["status"].get("conditions", []))}  # fmt: skip
            least[0] = min(least[0], len(ready))
            if ready:
                self.write_places(ready)
            return len(ready) == 2 and all(ready[n]["metadata"]["uid"] != before[n]["metadata"]["uid"] for n in ready)

        self.cluster.wait_for(replaced, "both pods are new", 4 * MINUTES)
        self.assertEqual(least[0], 1, "one server was there at any moment")
        self.wait_for_robots(20)
        self.assert_agrees(fleet)
        robots = self.cluster.kubectl("exec", "postgres", "--", "setpriv", "--reuid=postgres", "--clear-groups",
                                      "psql", "-X", "-A", "-t", "-U", "uplinkd_owner", "-d", "uplinkd", "-c",
                                      "SELECT count(*) FROM uplinkd.robots").stdout  # fmt: skip
        self.assertEqual(robots.strip(), "20")


if __name__ == "__main__":
    unittest.main()
