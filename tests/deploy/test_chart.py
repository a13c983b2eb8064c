"""The chart: helm's own lint, the value sets of deploy/helm/uplinkd/ci against Kubernetes' schemas, those that
must fail, and that it knows what uplinkd knows. What needs no helm is a rule of tests/tidy/deployed.py."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

import yaml
from images import SOURCE, TOOLS, run

CHART = SOURCE / "deploy/helm/uplinkd"
SETS = sorted(path for path in (CHART / "ci").glob("*.yaml") if not path.name.startswith("fails-"))
MUST_FAIL = {
    "fails-two-on-sqlite": "/replicas",
    "fails-unknown-section": "additional properties 'limit' not allowed",
}
# The oldest that Chart.yaml allows, and the one of `./dev k8s-test`.
KUBERNETES = ("1.25", "1.34")
# Kinds of operators: Kubernetes has no schema for them.
FOREIGN = {"Certificate", "PodMonitor", "PrometheusRule"}
SECTION = re.compile(r"^\[([a-z0-9_]+)\]$")
KEY = re.compile(r"^# ([a-z0-9_.]+) = ")
PROBE = re.compile(r"kProbeDeadline = std::chrono::seconds\((\d+)\)")


def helm(*arguments, code=0):
    found = TOOLS / "bin/helm"
    return run(found if found.exists() else "helm", *arguments, code=code)


def rendered(values, kubernetes, *flags, chart=CHART):
    """The manifests, and their documents."""
    text = helm("template", "robots", chart, "--namespace", "robots", "--values", values,
                "--kube-version", f"{kubernetes}.0", *flags).stdout  # fmt: skip
    return text, [document for document in yaml.safe_load_all(text) if document]


def one(documents, kind):
    (found,) = [document for document in documents if document["kind"] == kind]
    return found


def probe_seconds():
    (seconds,) = PROBE.findall((SOURCE / "tools/uplinkctl/probe.h").read_text(encoding="utf-8"))
    return int(seconds)


def port_of(address):
    return int(address.rsplit(":", 1)[1])


def keys_of_uplinkd():
    """The keys of deploy/uplinkd.toml, which holds every one that has an effect."""
    keys, section = {}, ""
    for line in (SOURCE / "deploy/uplinkd.toml").read_text(encoding="utf-8").splitlines():
        head, key = SECTION.match(line), KEY.match(line)
        if head:
            section = head.group(1)
            keys[section] = set()
        elif key:
            keys[section].add(key.group(1))
    return keys


class Chart(unittest.TestCase):
    def setUp(self):
        self.assertEqual(len(SETS), 7)

    def test_helm_lint_finds_nothing(self):
        for values in SETS:
            with self.subTest(values.name):
                helm("lint", "--strict", CHART, "--values", values)

    def test_value_sets_fit_the_schemas_of_kubernetes(self):
        validate = pathlib.Path(sys.executable).parent / "kubernetes-validate"
        for values in SETS:
            for kubernetes in KUBERNETES:
                with self.subTest(f"{values.name} {kubernetes}"):
                    text, documents = rendered(values, kubernetes)
                    done = subprocess.run([validate, "--strict", "-k", kubernetes, "-"], input=text, text=True,
                                          capture_output=True, timeout=60, check=False)  # fmt: skip
                    said = done.stdout + done.stderr
                    self.assertEqual(done.returncode, 0, said)
                    unknown = set(re.findall(r"find schema for kind (\w+)", said))
                    self.assertLessEqual(unknown, FOREIGN)
                    passed = len(re.findall(r" passed for resource ", said))
                    self.assertEqual(passed + len(re.findall(r"find schema", said)), len(documents), said)

    def test_sets_that_cannot_work_are_refused(self):
        self.assertEqual(sorted(f"{name}.yaml" for name in MUST_FAIL),
                         sorted(path.name for path in (CHART / "ci").glob("fails-*.yaml")))  # fmt: skip
        for name, why in MUST_FAIL.items():
            with self.subTest(name):
                done = helm("template", "robots", CHART, "--values", CHART / f"ci/{name}.yaml", code=1)
                self.assertIn(why, done.stderr)

    def test_defaults_alone_lack_a_certificate(self):
        self.assertIn("/tls/secret", helm("template", "robots", CHART, code=1).stderr)

    def test_every_key_is_one_of_uplinkd(self):
        known = keys_of_uplinkd()
        for values in SETS:
            with self.subTest(values.name):
                _, documents = rendered(values, KUBERNETES[-1])
                settings = tomllib.loads(one(documents, "ConfigMap")["data"]["uplinkd.toml"])
                self.assertLessEqual({"listen", "tls", "store", "drain"}, settings.keys())
                for section, entries in settings.items():
                    flat = {key if not isinstance(value, dict) else f"{key}.{inner}"
                            for key, value in entries.items()
                            for inner in (value if isinstance(value, dict) else [None])}  # fmt: skip
                    self.assertLessEqual(flat, known[section], section)

    def test_a_port_of_a_pod_is_one_on_which_uplinkd_listens(self):
        example = (SOURCE / "deploy/uplinkd.toml").read_text(encoding="utf-8")
        defaults = tomllib.loads(example.replace("\n# relay = ", "\nrelay = "))
        for values in SETS:
            with self.subTest(values.name):
                _, documents = rendered(values, KUBERNETES[-1])
                (container,) = one(documents, "StatefulSet")["spec"]["template"]["spec"]["containers"]
                ports = {port["name"]: port["containerPort"] for port in container["ports"]}
                set_here = tomllib.loads(one(documents, "ConfigMap")["data"]["uplinkd.toml"])["listen"]
                listen = {**defaults["listen"], **set_here}
                wanted = {"relay": port_of(listen["relay"]), "metrics": port_of(listen["metrics"])}
                # Without the API the chart leaves it on loopback, where only the probes ask.
                for name in ("http", "fleet"):
                    if name in set_here:
                        wanted[name] = port_of(listen[name])
                self.assertEqual(ports, wanted)
                self.assertEqual("http" in set_here, values.name == "http.yaml")
                self.assertEqual("fleet" in set_here, values.name in ("http.yaml", "cert-manager.yaml"))

    def test_every_named_port_is_one_of_the_pod(self):
        named = set()
        for values in SETS:
            _, documents = rendered(values, KUBERNETES[-1])
            (container,) = one(documents, "StatefulSet")["spec"]["template"]["spec"]["containers"]
            ports = {port["name"] for port in container["ports"]}
            for document in documents:
                spec, kind = document.get("spec", {}), document["kind"]
                names = {
                    "Service": lambda: [port["targetPort"] for port in spec["ports"]],
                    "NetworkPolicy": lambda: [port["port"] for rule in spec["ingress"] for port in rule["ports"]],
                    "PodMonitor": lambda: [endpoint["port"] for endpoint in spec["podMetricsEndpoints"]],
                }.get(kind, list)()
                self.assertLessEqual(set(names), ports, f"{values.name}: {kind}")
                named.update((kind, name) for name in names)
        both = {(kind, name) for kind in ("Service", "NetworkPolicy") for name in ("relay", "metrics", "http", "fleet")}
        self.assertEqual(named, both | {("PodMonitor", "metrics")})

    def test_numbers_and_texts_keep_their_type(self):
        _, documents = rendered(CHART / "ci/sqlite-existing-claim.yaml", KUBERNETES[-1])
        settings = tomllib.loads(one(documents, "ConfigMap")["data"]["uplinkd.toml"])
        self.assertEqual(settings["limits"], {"robots_max": 50000, "durable_bytes_rate": "2MiB"})
        self.assertEqual(settings["tls"]["client_ca_file"], "/etc/uplinkd/robots/authorities.pem")

    def test_a_pod_has_longer_than_its_drain(self):
        for values in SETS:
            _, documents = rendered(values, KUBERNETES[-1], "--set", "drain.timeoutSeconds=120")
            pod = one(documents, "StatefulSet")["spec"]["template"]["spec"]
            settings = tomllib.loads(one(documents, "ConfigMap")["data"]["uplinkd.toml"])
            self.assertEqual(settings["drain"]["timeout"], "120s")
            pause = pod["containers"][0]["lifecycle"]["preStop"]["sleep"]["seconds"]
            self.assertGreater(pod["terminationGracePeriodSeconds"], 120 + pause + 2)

    def test_no_probe_asks_a_port_that_other_pods_reach(self):
        for values in SETS:
            pod = one(rendered(values, KUBERNETES[-1])[1], "StatefulSet")["spec"]["template"]["spec"]
            (container,) = pod["containers"]
            for probe in ("startupProbe", "livenessProbe", "readinessProbe"):
                ready = ["--ready"] if probe == "readinessProbe" else []
                self.assertEqual(
                    container[probe]["exec"]["command"],
                    ["/usr/bin/uplinkctl", "health", *ready, "--config", "/etc/uplinkd/uplinkd.toml"],
                )
                self.assertGreater(container[probe]["timeoutSeconds"], probe_seconds(), "uplinkctl says why first")

    def test_the_api_asks_everyone_who_they_are(self):
        _, documents = rendered(CHART / "ci/http.yaml", KUBERNETES[-1])
        http = tomllib.loads(one(documents, "ConfigMap")["data"]["uplinkd.toml"])["http"]
        self.assertEqual(http["tls"], {"certificate_file": "/etc/uplinkd/http/tls.crt",
                                       "key_file": "/etc/uplinkd/http/tls.key"})  # fmt: skip
        self.assertEqual(http["tokens_file"], "/etc/uplinkd/access/tokens")
        self.assertEqual(http["plain_from"], ["127.0.0.0/8", "::1", "10.0.0.0/28"])
        self.assertEqual(http["hosts"][0::3], ["robots-uplinkd-http", "fleet.example.org"])
        (container,) = one(documents, "StatefulSet")["spec"]["template"]["spec"]["containers"]
        mounts = {mount["name"]: mount["mountPath"] for mount in container["volumeMounts"]}
        self.assertEqual((mounts["http"], mounts["access"]), ("/etc/uplinkd/http", "/etc/uplinkd/access"))
        for endpoint in one(documents, "PodMonitor")["spec"]["podMetricsEndpoints"]:
            self.assertEqual(endpoint["authorization"]["credentials"], {"name": "uplinkd-scrapes", "key": "token"})
        for key in ("tokens_file", "plain_from", "tls.certificate_file"):
            helm("template", "robots", CHART, "--values", CHART / "ci/sqlite.yaml",
                 "--set-json", f'config.http={{"{key}":"x"}}', code=1)  # fmt: skip

    def test_operators_are_known_on_the_listener_of_grpc(self):
        _, documents = rendered(CHART / "ci/http.yaml", KUBERNETES[-1])
        settings = tomllib.loads(one(documents, "ConfigMap")["data"]["uplinkd.toml"])
        self.assertEqual(settings["tls"]["operator_ca_file"], "/etc/uplinkd/operators/ca.crt")
        self.assertEqual(settings["tls"]["client_crl_file"], "/etc/uplinkd/robots/ca.crl")
        self.assertEqual(settings["identity"], {"authorities": "/etc/uplinkd/authorities"})
        pod = one(documents, "StatefulSet")["spec"]["template"]["spec"]
        mounts = {mount["name"]: mount for mount in pod["containers"][0]["volumeMounts"]}
        for name in ("authorities", "operators"):
            self.assertEqual(mounts[name]["mountPath"], f"/etc/uplinkd/{name}")
            # Kubernetes' own folders are open to everybody by their mode: uplinkd takes one that is read-only.
            self.assertTrue(mounts[name]["readOnly"])
        robots = next(volume["secret"] for volume in pod["volumes"] if volume["name"] == "robots")
        self.assertEqual([item["key"] for item in robots["items"]], ["ca.crt", "ca.crl"])
        helm("template", "robots", CHART, "--values", CHART / "ci/sqlite.yaml",
             "--set-json", 'config.identity={"authorities":"x"}', code=1)  # fmt: skip

    def test_grpc_alone_knows_the_tokens_and_its_names_are_in_the_certificate(self):
        _, documents = rendered(CHART / "ci/cert-manager.yaml", KUBERNETES[-1])
        settings = tomllib.loads(one(documents, "ConfigMap")["data"]["uplinkd.toml"])
        self.assertEqual(settings["http"], {"tokens_file": "/etc/uplinkd/access/tokens"})
        (container,) = one(documents, "StatefulSet")["spec"]["template"]["spec"]["containers"]
        self.assertIn("access", {mount["name"] for mount in container["volumeMounts"]})
        self.assertIn("robots-uplinkd-fleet.robots.svc", one(documents, "Certificate")["spec"]["dnsNames"])

    def test_a_changed_setting_restarts_pods_and_an_unchanged_one_does_not(self):
        def template(*flags):
            _, documents = rendered(CHART / "ci/sqlite.yaml", KUBERNETES[-1], *flags)
            return one(documents, "StatefulSet")["spec"]["template"]

        self.assertEqual(template(), template("--set", "service.port=443"))
        self.assertNotEqual(template(), template("--set", "config.limits.robots_max=10"))

    def test_no_pod_gets_more_of_a_secret_than_it_uses(self):
        for values in SETS:
            with self.subTest(values.name):
                _, documents = rendered(values, KUBERNETES[-1], "--set", "tests.authoritySecret=authority")
                pods = [one(documents, "StatefulSet")["spec"]["template"], one(documents, "Pod")]
                pods += [document["spec"]["template"] for document in documents if document["kind"] == "Job"]
                for pod in pods:
                    for volume in pod["spec"]["volumes"]:
                        if "secret" in volume:
                            self.assertEqual(volume["secret"].get("defaultMode"), 0o440, volume)
                            self.assertTrue(volume["secret"].get("items"), volume)
        _, documents = rendered(CHART / "ci/postgres.yaml", KUBERNETES[-1],
                                "--set", "store.postgres.passwordKey=p,store.postgres.migrate.passwordKey=owner")  # fmt: skip
        keys = {(document["kind"], volume["name"]): [item["key"] for item in volume["secret"]["items"]]
                for document in documents if document["kind"] in ("StatefulSet", "Job")
                for volume in document["spec"]["template"]["spec"]["volumes"] if "secret" in volume}  # fmt: skip
        self.assertEqual(keys, {
            ("StatefulSet", "tls"): ["tls.crt", "tls.key"], ("StatefulSet", "robots"): ["ca.crt"],
            ("StatefulSet", "store"): ["p"], ("StatefulSet", "database"): ["ca.crt"],
            ("Job", "owner"): ["owner"], ("Job", "database"): ["ca.crt"],
        })  # fmt: skip

    def test_notes_say_who_can_read_positions_until_a_policy_names_who_scrapes(self):
        folder = tempfile.TemporaryDirectory(prefix="uplinkd-chart-")
        self.addCleanup(folder.cleanup)
        chart = pathlib.Path(shutil.copytree(CHART, f"{folder.name}/uplinkd"))
        # Without a cluster, helm shows manifests alone.
        notes = (chart / "templates/NOTES.txt").read_text(encoding="utf-8")
        text = f'{{{{- define "notes" }}}}{notes}{{{{ end }}}}\nkind: Notes\ntext: {{{{ include "notes" . | quote }}}}\n'
        (chart / "templates/notes.yaml").write_text(text, encoding="utf-8")

        def says(*flags):
            _, documents = rendered(CHART / "ci/sqlite.yaml", KUBERNETES[-1], *flags, chart=chart)
            said = one(documents, "Notes")["text"]
            return "Every pod of the cluster can read the robots' positions" in said

        self.assertTrue(says())
        self.assertTrue(says("--set", "networkPolicy.enabled=true"))
        scraper = "networkPolicy.metricsFrom[0].namespaceSelector.matchLabels.name=monitoring"
        self.assertTrue(says("--set", scraper))
        self.assertFalse(says("--set", f"networkPolicy.enabled=true,{scraper}"))
        self.assertFalse(says("--set", "metrics.tokenSecret=scrapes"))

    def test_no_selector_of_servers_finds_a_job_or_a_test(self):
        _, documents = rendered(CHART / "ci/postgres.yaml", KUBERNETES[-1], "--set", "tests.authoritySecret=x")
        selector = one(documents, "StatefulSet")["spec"]["selector"]["matchLabels"].items()
        for document in documents:
            if document["kind"] == "Service":
                self.assertEqual(document["spec"]["selector"].items(), selector)
        for labels in (one(documents, "Job")["spec"]["template"]["metadata"]["labels"],
                       one(documents, "Pod")["metadata"]["labels"]):  # fmt: skip
            self.assertFalse(selector <= labels.items())

    def test_the_rules_are_those_of_deploy_and_their_jobs_have_these_names(self):
        _, documents = rendered(CHART / "ci/monitoring.yaml", KUBERNETES[-1])
        groups = []
        for name in ("recording", "alerts"):
            path = SOURCE / f"deploy/prometheus/{name}.rules.yml"
            groups += yaml.safe_load(path.read_text(encoding="utf-8"))["groups"]
        self.assertEqual(one(documents, "PrometheusRule")["spec"]["groups"], groups)
        jobs = {relabel["replacement"] for endpoint in one(documents, "PodMonitor")["spec"]["podMetricsEndpoints"]
                for relabel in endpoint["relabelings"]}  # fmt: skip
        used = set(re.findall(r'job="([\w-]+)"', str(groups)))
        self.assertTrue(used)
        self.assertLessEqual(used, jobs)


if __name__ == "__main__":
    unittest.main()
