"""The chart in a real cluster of one node: install, `helm test`, an upgrade under a fleet, a server that hangs,
a rollback from an image that is not there, and an uninstall that keeps the claim."""

import json
import os
import pathlib
import signal
import subprocess
import time
import unittest

from cluster import Cluster
from images import BIN, MINUTES, SOURCE, run, wait_for

CHART = SOURCE / "deploy/helm/uplinkd"
RELEASE, POD, CLAIM = "uplinkd", "uplinkd-0", "data-uplinkd-0"
RELAY_PORT, HTTP_PORT = 17443, 17480
VALUES = ("image.pullPolicy=Never", "tls.secret=uplinkd-tls", "service.type=ClusterIP", "store.sqlite.size=1Gi",
          "resources.requests.memory=64Mi", "resources.limits.memory=512Mi")  # fmt: skip
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


class Kubernetes(unittest.TestCase):
    """One cluster, one release: the steps follow each other as in an operator's life."""

    maxDiff = None

    @classmethod
    def setUpClass(cls):
        began = time.monotonic()
        cls.cluster = Cluster()
        cls.addClassCleanup(cls.cluster.close)
        cls.cluster.up()
        cls.folder = cls.cluster.folder
        cls.pki = cls.folder / "pki"
        run(BIN / "uplinkctl", "pki", "init", "--dir", cls.pki)
        run(BIN / "uplinkctl", "pki", "server", "--dir", cls.pki, "--host", RELEASE, "--host", "127.0.0.1")
        cls.cluster.kubectl("create", "secret", "generic", "uplinkd-tls", f"--from-file=tls.crt={cls.pki}/server.crt",
                            f"--from-file=tls.key={cls.pki}/server.key", f"--from-file=ca.crt={cls.pki}/ca.crt")  # fmt: skip
        cls.cluster.kubectl("create", "secret", "generic", "authority", f"--from-file={cls.pki}/ca.crt",
                            f"--from-file={cls.pki}/ca.key")  # fmt: skip
        # A folder of the node is no volume that Kubernetes gives to the pod's group: it is ours from the start.
        volume = cls.folder / "volume"
        volume.mkdir(mode=0o750)
        os.chown(volume, 10001, 10001)
        manifest = cls.folder / "volume.yaml"
        manifest.write_text(VOLUME.format(path=volume), encoding="utf-8")
        cls.cluster.kubectl("apply", "-f", manifest)
        print(f"\ncluster ready after {time.monotonic() - began:.0f} s")

    def helm(self, verb, *flags, code=0):
        sets = [word for value in VALUES for word in ("--set", value)]
        return self.cluster.helm(verb, RELEASE, CHART, *sets, *flags, code=code)

    def pod(self):
        return json.loads(self.cluster.kubectl("get", "pod", POD, "-o", "json").stdout)

    def ready_pod(self):
        """The pod once it is ready, written down for the front."""

        def look():
            answer = self.cluster.answers("get", "pod", POD, "-o", "json")
            pod = json.loads(answer) if answer else {"status": {}}
            conditions = {each["type"]: each["status"] for each in pod["status"].get("conditions", [])}
            return pod if conditions.get("Ready") == "True" and "deletionTimestamp" not in pod["metadata"] else None

        pod = self.cluster.wait_for(look, f"{POD} is ready")
        place = self.folder / "pod.new"
        place.write_text(f"{pod['status']['podIP']} {self.server_pid()}", encoding="utf-8")
        place.rename(self.folder / "pod")
        return pod

    def server_pid(self):
        """The server's process, by its command line in the cluster's processes."""
        found = [int(pid) for pid in run("pgrep", "--full", "^/usr/bin/uplinkd --config").stdout.split()
                 if pathlib.Path(f"/proc/{pid}/cgroup").read_text(encoding="utf-8").find("kubepods") >= 0]  # fmt: skip
        self.assertEqual(len(found), 1, found)
        return found[0]

    def test_the_life_of_a_release(self):
        steps = (self.install, self.robot_test, self.upgrade_under_a_fleet, self.hang, self.roll_back, self.uninstall)
        for step in steps:
            began = time.monotonic()
            step()
            print(f"{step.__name__}: {time.monotonic() - began:.0f} s", flush=True)

    def install(self):
        self.cluster.kubectl("apply", "--dry-run=server", "--validate=strict", "-f", self.manifests())
        self.helm("install", "--wait", "--timeout", "120s")
        pod = self.ready_pod()
        security = pod["spec"]["containers"][0]["securityContext"]
        self.assertTrue(security["readOnlyRootFilesystem"])
        status = pathlib.Path(f"/proc/{self.server_pid()}/status").read_text(encoding="utf-8")
        self.assertIn("NoNewPrivs:\t1", status)
        self.assertIn("CapEff:\t0000000000000000", status)
        self.assertIn("Uid:\t10001", status)
        metrics = self.cluster.inside("curl", "-sf", "-H", "Host: uplinkd-metrics", f"http://{pod['status']['podIP']}:7481/metrics")
        self.assertIn("uplinkd_build_info", metrics.stdout)
        refused = self.cluster.inside("curl", "-s", "-m", "5", f"http://{pod['status']['podIP']}:7480/readyz", code=7)
        self.assertEqual(refused.stdout, "")
        print(self.cluster.kubectl("get", "all,pvc,pdb,configmap").stdout)

    def manifests(self):
        """What the chart renders for the test of the API server."""
        path = self.folder / "manifests.yaml"
        sets = [word for value in VALUES for word in ("--set", value)]
        path.write_text(self.cluster.helm("template", RELEASE, CHART, *sets, "--set", "networkPolicy.enabled=true").stdout,
                        encoding="utf-8")  # fmt: skip
        return path

    def robot_test(self):
        before = self.pod()["metadata"]["uid"]
        # There is no DNS here. Values of the test leave the server alone.
        address = self.pod()["status"]["podIP"]
        self.helm("upgrade", "--wait", "--set", "tests.authoritySecret=authority", "--set",
                  f"tests.hostAliases[0].ip={address}", "--set", f"tests.hostAliases[0].hostnames[0]={RELEASE}")  # fmt: skip
        self.assertEqual(self.pod()["metadata"]["uid"], before)
        said = self.cluster.helm("test", RELEASE, "--logs", "--timeout", "90s").stdout
        self.assertIn("verification: all agree", said)

    def upgrade_under_a_fleet(self):
        front = subprocess.Popen([*self.cluster.enter(), "python3", SOURCE / "tests/deploy/front.py",
                                  str(RELAY_PORT), str(HTTP_PORT), self.folder / "pod"])  # fmt: skip
        self.addCleanup(front.wait, 30)
        self.addCleanup(front.kill)
        self.ready_pod()
        fleet = subprocess.Popen(
            [*self.cluster.enter(), BIN / "uplink-fleet", "--target", f"127.0.0.1:{RELAY_PORT}",
             "--http", f"127.0.0.1:{HTTP_PORT}", "--pki", self.pki, "--robots", "30", "--pace", "5",
             "--report", "json", "--for", "90s", "--settle-for", "120s"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        self.addCleanup(fleet.stdout.close)
        self.addCleanup(fleet.kill)
        self.wait_for_robots(30)
        before = self.pod()["metadata"]["uid"]
        self.helm("upgrade", "--wait", "--timeout", "120s", "--set", "config.log.level=debug")
        after = self.ready_pod()
        self.assertNotEqual(after["metadata"]["uid"], before)
        self.assertEqual(after["status"]["containerStatuses"][0]["restartCount"], 0)
        output, _ = fleet.communicate(timeout=5 * MINUTES)
        report = json.loads(output)
        self.assertTrue(report["ok"], [check for check in report["checks"] if not check["ok"]])
        self.assertEqual(fleet.returncode, 0)

    def wait_for_robots(self, robots):
        def enough():
            try:
                page = self.cluster.inside("curl", "-sf", f"http://127.0.0.1:{HTTP_PORT}/metrics").stdout
            except AssertionError:
                return False
            return any(line.startswith('uplinkd_robots{presence="online"}') and float(line.split()[1]) >= robots
                       for line in page.splitlines())  # fmt: skip

        wait_for(enough, 60, f"{robots} robots are online")

    def hang(self):
        os.kill(self.server_pid(), signal.SIGSTOP)

        def restarted():
            status = self.pod()["status"]["containerStatuses"][0]
            return status["restartCount"] == 1 and status["ready"]

        self.cluster.wait_for(restarted, "the liveness probe restarts a server that hangs", 4 * MINUTES)
        self.ready_pod()

    def roll_back(self):
        self.helm("upgrade", "--set", "image.tag=missing")

        def stuck():
            statuses = self.pod()["status"].get("containerStatuses", [{"state": {}}])
            return statuses[0]["state"].get("waiting", {}).get("reason") == "ErrImageNeverPull"

        self.cluster.wait_for(stuck, "the new pod has no image")
        self.cluster.helm("rollback", RELEASE, "--wait", "--timeout", "120s")
        self.ready_pod()

    def uninstall(self):
        self.cluster.helm("uninstall", RELEASE, "--wait", "--timeout", "90s")
        phase = self.cluster.kubectl("get", "pvc", CLAIM, "-o", "jsonpath={.status.phase}").stdout
        self.assertEqual(phase, "Bound")
        self.assertTrue((self.folder / "volume/uplinkd.db").exists())
        left = self.cluster.kubectl("get", "all,configmap,secret,pdb", "-l", f"app.kubernetes.io/instance={RELEASE}",
                                    "-o", "name").stdout  # fmt: skip
        self.assertNotIn("statefulset", left)
        # Installed again, it has the robots of before.
        self.helm("install", "--wait", "--timeout", "120s")
        self.ready_pod()
        page = self.cluster.inside("curl", "-sf", f"http://127.0.0.1:{HTTP_PORT}/api/v1/robots?pageSize=100").stdout
        self.assertEqual(len(json.loads(page)["robots"]), 31)


if __name__ == "__main__":
    unittest.main()
