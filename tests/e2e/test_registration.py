"""Who may come in: the keys of [identity], and what operators set of robots, against the real server and an agent of
another gRPC library."""

import json
import os
import subprocess

from ending_agents import AGENT, PYTHON, RURI, SECONDS, EndingAgents
from harness import Cluster, Server, uplinkctl, wait_until
from tcp_proxy import Cut, TcpProxy

CLIENT = AGENT.with_name("relay_client.py")
CLOSED = '[identity]\nregistration = "closed"\n'
STAYS = '[identity]\nfleet_moves = "refuse"\n'
NAMED = '[identity]\ngateways = "named"\n'
# An operator's word reaches a stream.
LIVE_SECONDS = 15


class Operators(EndingAgents):
    def robot(self, name, fleet="acme", ruri=None):
        """The files of a robot's certificate."""
        uplinkctl("pki", "robot", "--dir", self.running.pki, "--ruri", ruri or RURI + name, "--fleet", fleet,
                  "--name", name)  # fmt: skip
        return name

    def come(self, name, act="stream"):
        """What an agent of these files is told."""
        files = [str(file) for file in (self.key("ca", "crt"), self.key(name, "crt"), self.key(name, "key"))]
        said = subprocess.run(
            [PYTHON, str(CLIENT), act, self.running.relay, *files], text=True, capture_output=True, timeout=SECONDS,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(self.modules), str(CLIENT.parent)])}, check=False,
        )  # fmt: skip
        self.assertEqual(said.returncode, 0, said.stderr)
        return json.loads(said.stdout)

    def refused(self, name):
        return self.come(name, "refused")

    def ctl(self, *arguments, code=0):
        env = {name: value for name, value in os.environ.items() if not name.startswith(("UPLINKCTL", "XDG"))}
        at = ("--server", f"http://{self.running.http}")
        return uplinkctl(*arguments, *at, code=code, env={**env, "HOME": str(self.folder)}).stdout


class Registration(Operators):
    def test_where_registration_is_closed_a_new_robot_is_a_candidate_and_a_known_one_comes_in(self):
        self.serve(self.server())
        self.agent("known").kill()
        wait_until(self.running.process, lambda: self.running.get("/api/v1/robots")["robots"], SECONDS, "it is known")
        self.running.terminate(SECONDS)
        self.running.settings = CLOSED
        self.running.start()
        self.agent("known")
        end = self.refused(self.robot("new"))
        self.assertEqual(end["code"], "PERMISSION_DENIED")
        self.assertIn(f"{RURI}new is not registered", end["details"])
        [candidate] = self.running.get("/api/v1/candidates")["candidates"]
        self.assertEqual((candidate["ruri"], candidate["fleet"], candidate["refused"]), (RURI + "new", "acme", "1"))
        self.assertEqual(self.running.get("/api/v1/candidates?fleet=other")["candidates"], [])
        self.assertIn(RURI + "new", self.ctl("robots", "candidates", "-o", "csv"))
        self.assertEqual(self.running.metric('uplinkd_streams_refused_total{cause="operator"}'), 1)

    def test_a_candidate_that_an_operator_adds_comes_in(self):
        self.serve(self.server(CLOSED))
        self.assertEqual(self.refused(self.robot("new"))["code"], "PERMISSION_DENIED")
        self.ctl("robots", "add", RURI + "new")
        wait_until(self.running.process, lambda: self.refused("new")["code"] == "OK", LIVE_SECONDS, "it comes in")
        self.assertEqual(self.running.get("/api/v1/candidates")["candidates"], [])

    def test_registration_closes_without_a_restart(self):
        self.serve(self.server("[identity]\nregistration = \"open\"\n"))
        self.agent("known").kill()
        file = self.folder / "uplinkd.toml"
        file.write_text(file.read_text().replace('registration = "open"', 'registration = "closed"'))
        # By the command, or by the server's own look at the file.
        self.ctl("reload")
        self.running.wait_for_line("reloaded taken_over=identity.registration")
        self.assertIn("is not registered", self.refused(self.robot("new"))["details"])
        self.agent("known")

    def test_where_fleets_stay_a_certificate_of_another_fleet_is_refused(self):
        self.serve(self.server(STAYS))
        self.agent("r1").kill()
        self.robot("moved", fleet="other", ruri=RURI + "r1")
        end = self.refused("moved")
        self.assertEqual(end["code"], "PERMISSION_DENIED")
        self.assertIn("is of another fleet than the certificate, other", end["details"])

    def test_an_authority_moves_no_robot_out_of_a_fleet_that_its_entry_does_not_have(self):
        guests, folder = self.folder / "guests", self.folder / "authorities"
        uplinkctl("pki", "init", "--dir", guests)
        uplinkctl("pki", "robot", "--dir", guests, "--ruri", RURI + "r1", "--fleet", "other", "--name", "moved")
        folder.mkdir()
        (folder / "guests.pem").write_bytes((guests / "ca.crt").read_bytes())
        (folder / "guests.toml").write_text('fleets = ["other"]\n')
        running = self.server()
        running.environment = {"UPLINKD_IDENTITY_AUTHORITIES": str(folder)}
        self.serve(running)
        self.agent("r1").kill()
        for kind in ("crt", "key"):
            self.key("moved", kind).write_bytes((guests / f"moved.{kind}").read_bytes())
        end = self.refused("moved")
        self.assertEqual((end["code"], end["details"]),
                         ("PERMISSION_DENIED",
                          "client certificate: its authority guests may not move this robot from its fleet"))  # fmt: skip
        [robot] = self.running.get("/api/v1/robots")["robots"]
        self.assertEqual(robot["fleet"], "acme")

    def test_a_new_robot_needs_a_canonical_ruri(self):
        self.serve(self.server())
        self.robot("capital", ruri="rcan://Example.org/acme/rover/capital")
        end = self.refused("capital")
        self.assertEqual(end["code"], "PERMISSION_DENIED")
        self.assertIn("has a host with capital letters", end["details"])

    def test_a_block_ends_the_stream_and_an_unblock_lets_it_in(self):
        self.serve(self.server())
        self.agent("stolen")
        other = self.agent("other")
        self.ctl("robots", "block", RURI + "stolen", "--reason", "stolen")
        line = f"robot_disconnected robot={RURI}stolen "
        wait_until(self.running.process, lambda: line in self.running.text(), LIVE_SECONDS, "its stream ends")
        [told] = [each for each in self.running.text().splitlines() if line in each]
        self.assertIn("why=refused", told)
        self.assertIn("PERMISSION_DENIED", told)
        self.assertEqual(self.refused("stolen"), {"code": "PERMISSION_DENIED", "details": "blocked"})
        self.assertIsNone(other.poll(), "another robot notices nothing")
        self.ctl("robots", "unblock", RURI + "stolen")
        wait_until(self.running.process, lambda: self.refused("stolen")["code"] == "OK", LIVE_SECONDS, "it comes in")

    def test_a_disconnect_ends_the_stream_and_the_robot_comes_again(self):
        self.serve(self.server())
        self.agent("r1")
        self.ctl("robots", "disconnect", RURI + "r1")
        line = "disconnected by an operator"
        wait_until(self.running.process, lambda: line in self.running.text(), LIVE_SECONDS, "its stream ends")
        self.agent("r1")

    def test_a_block_outlives_a_restart(self):
        self.serve(self.server())
        self.agent("stolen").kill()
        self.ctl("robots", "block", RURI + "stolen")
        self.running.terminate(SECONDS)
        self.running.start()
        self.assertEqual(self.refused("stolen"), {"code": "PERMISSION_DENIED", "details": "blocked"})


class WhileTheStoreIsAway(Operators):
    """A server that starts while it cannot reach its store."""

    def setUp(self):
        super().setUp()
        cluster = Cluster(self.folder).create()
        self.open_things.append(cluster)
        cluster.migrate()
        password = self.folder / "store.password"
        password.write_text("uplinkd\n", encoding="utf-8")
        self.store = TcpProxy(f"127.0.0.1:{cluster.place['port']}")
        self.open_things.append(self.store)
        url = f"postgresql://uplinkd@127.0.0.1:{self.store.port}/uplinkd?sslmode=disable"
        server = Server(self.folder, f'password_file = "{password}"\n{CLOSED}', url)
        self.open_things.append(server)
        self.serve(server)

    def test_robots_come_in_and_those_that_are_not_registered_are_ended_once_it_is_back(self):
        self.ctl("robots", "add", RURI + "added")
        self.robot("added")
        wait_until(self.running.process, lambda: self.come("added", "refused")["code"] == "OK", LIVE_SECONDS, "it came")
        self.running.terminate(SECONDS)
        self.store.cut(Cut.REFUSE)
        self.running.start()
        self.agent("added")
        self.agent("stranger")
        self.running.wait_for_status(lambda state: "identity" in state["degraded"], SECONDS, "no one can be judged")
        self.store.mend()
        line = f"robot_disconnected robot={RURI}stranger "
        wait_until(self.running.process, lambda: line in self.running.text(), SECONDS, "it is ended")
        [told] = [each for each in self.running.text().splitlines() if line in each]
        self.assertIn(f"{RURI}stranger is not registered", told)
        self.assertNotIn(f"robot_disconnected robot={RURI}added ", self.running.text())
        [candidate] = self.running.get("/api/v1/candidates")["candidates"]
        self.assertEqual(candidate["ruri"], RURI + "stranger")
        self.assertEqual(self.refused("stranger")["code"], "PERMISSION_DENIED")
        # A restart does not let it in either: the store has no row of it.
        self.running.terminate(SECONDS)
        self.running.start()
        self.assertEqual(self.refused("stranger")["code"], "PERMISSION_DENIED")
        self.agent("added")


class UnnamedGateways(EndingAgents):
    """A gateway whose certificate names no robots."""

    def gateway(self, settings=""):
        self.serve(self.server(settings))
        uplinkctl("pki", "gateway", "--dir", self.running.pki, "--fleet", "acme", "--name", "hall")
        files = [str(file) for file in (self.key("ca", "crt"), self.key("hall", "crt"), self.key("hall", "key"))]
        said = subprocess.run(
            [PYTHON, str(CLIENT), "for_robot", self.running.relay, *files], text=True, capture_output=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(self.modules), str(CLIENT.parent)])},
            timeout=SECONDS, check=True,
        )  # fmt: skip
        return json.loads(said.stdout)

    def test_the_first_is_warned_of(self):
        self.assertEqual(self.gateway()["code"], "OK")
        self.running.wait_for_line("gateway_unnamed gateway=")

    def test_it_is_refused_where_gateways_must_name_their_robots(self):
        end = self.gateway(NAMED)
        self.assertEqual(end["code"], "PERMISSION_DENIED")
        self.assertIn("names no robots", end["details"])
        self.assertNotIn("gateway_unnamed", self.running.text())
