"""The example of an agent, where its packages are at hand: what it reports is stored once, across kills of both sides.

UPLINK_AGENT_PYTHON names an interpreter with grpcio, grpcio-tools and pycapnp (examples/agent-python/README.md).
"""

import contextlib
import os
import re
import resource
import signal
import sqlite3
import subprocess
import unittest
import urllib.parse

from harness import SOURCE, EndToEnd, run, uplinkctl, wait_until

PYTHON = os.environ.get("UPLINK_AGENT_PYTHON", "/usr/bin/python3")
EXAMPLE = SOURCE / "examples/agent-python"
RURI = "rcan://local.rcan/example/rover/r1"
SECONDS = 60
PORT = re.compile(r"(\d+)\n")
STEP = re.compile(r"^step (\d+)$", re.MULTILINE)
# The robot says so at every fifth step.
SAYS = 5
# The example whose robot says what its agent is far too often: 20 at once and 1 per second are taken.
HASTY = """
import agent


def drive(robot, link, step):
    for number in range(25):
        key = "same" if step else f"{number}"
        link.keep("agentInfo", f"agentInfo/{key}", robot.agent_info())


agent.drive = drive
agent.main()
"""
# The same where the clock is a year ahead until the first message has come too soon.
SET_BACK = (
    """
import time

import agent

clock, ahead = time.time, [365 * 86_400]
time.time = lambda: clock() + sum(ahead)
repeat = agent.Spool.repeat


def repeat_and_set_back(spool, seq, due):
    repeat(spool, seq, due)
    ahead.clear()


agent.Spool.repeat = repeat_and_set_back
"""
    + HASTY
)
# The example whose spool fails for its first message, and in each of its first streams by another method.
FAILING = """
import sqlite3

import agent

agent.PAUSE_SECONDS = 0.01
turns, failing = ["hello", "batch", "judged", "acked"], {"keep"}


def let_fail(name):
    method = getattr(agent.Spool, name)

    def fail(*arguments):
        if name == "hello" and turns:
            failing.add(turns.pop(0))
        if name in failing:
            failing.remove(name)
            raise sqlite3.OperationalError(f"no room to {name}")
        return method(*arguments)

    setattr(agent.Spool, name, fail)


for name in ("keep", *turns):
    let_fail(name)
agent.main()
"""
# A server whose first streams go wrong, each in another way, and which then acks all. It prints its port, and the
# numbers that it acks.
WRONG_SERVER = r"""
import sys
from concurrent import futures

import grpc
from uplink.v1 import relay_pb2 as relay
from uplink.v1 import relay_pb2_grpc

NUMBER_MAX = 2**64 - 1
turns = iter(sys.argv[2:])


def welcome(number):
    return relay.RelayResponse(welcome=relay.Welcome(committed_seq=number))


def ack(number):
    return relay.RelayResponse(ack=relay.Ack(through_seq=number, judged_seq=number))


class Server(relay_pb2_grpc.UplinkRelayServicer):
    def Relay(self, requests, context):
        turn = next(turns)
        next(requests)
        yield welcome(NUMBER_MAX if turn == "welcome" else 0)
        for request in requests:
            numbers = [uplink.seq for uplink in request.batch.uplinks]
            if not numbers:
                # As uplinkd 0.1.0 ends a stream whose frame it does not know.
                context.abort(grpc.StatusCode.INVALID_ARGUMENT, "frame 9: it holds neither hello nor batch")
            if turn == "reject":
                text = "\x1b[31m\x9b2J\u202e"
                yield relay.RelayResponse(notice=relay.Notice(seq=numbers[0], field=text, detail=text))
                yield relay.RelayResponse(reject=relay.Reject(seq=numbers[0], reason=99, field=text, detail=text))
                context.abort(grpc.StatusCode.UNAVAILABLE, text)
            elif turn == "ack":
                yield ack(10**9)
            else:
                print(*numbers, flush=True)
                yield ack(numbers[-1])


def read(name):
    with open(f"{sys.argv[1]}/{name}", "rb") as opened:
        return opened.read()


pair = (read("server.key"), read("server.crt"))
server = grpc.server(futures.ThreadPoolExecutor(4))
relay_pb2_grpc.add_UplinkRelayServicer_to_server(Server(), server)
print(server.add_secure_port("localhost:0", grpc.ssl_server_credentials([pair], read("ca.crt"), True)))
server.start()
server.wait_for_termination()
"""
HURRIED = """
import agent

agent.PAUSE_SECONDS = 0.01
agent.main()
"""
# More than the agent's log has, and less than its spool.
FILE_BYTES_MAX = 64 * 1024


def has_packages():
    seen = subprocess.run(
        [PYTHON, "-c", "import capnp, grpc, grpc_tools"], capture_output=True, check=False
    )  # fmt: skip
    return seen.returncode == 0


@unittest.skipUnless(has_packages(), f"{PYTHON} has not grpcio, grpcio-tools and pycapnp")
class AgentPython(EndToEnd):
    def setUp(self):
        super().setUp()
        self.running = self.server().start()
        uplinkctl("pki", "robot", "--dir", self.running.pki, "--name", "r1", "--ruri", RURI)
        run(PYTHON, "-m", "grpc_tools.protoc", f"--proto_path={SOURCE / 'proto'}", f"--python_out={self.folder}",
            f"--grpc_python_out={self.folder}", "uplink/v1/relay.proto")  # fmt: skip
        self.said = self.folder / "agent.log"

    def drive(self, first, steps, program=EXAMPLE / "agent.py", every=0.02, target=None, flags=()):
        """Starts the agent. It is killed with the test."""
        target = target or self.running.relay.replace("127.0.0.1", "localhost")
        with self.said.open("wb") as said:
            agent = subprocess.Popen(
                [PYTHON, str(program), "--target", target, "--pki", str(self.running.pki), "--spool",
                 str(self.folder / "spool.db"), "--schema", str(SOURCE / "schema/uplink.capnp"),
                 "--first", str(first), "--steps", str(steps), "--every", str(every), *flags],
                stdout=said, stderr=subprocess.STDOUT,
                env=self.environment(),
            )  # fmt: skip
        self.addCleanup(agent.wait)
        self.addCleanup(agent.kill)
        return agent

    def environment(self):
        return {**os.environ, "PYTHONPATH": f"{self.folder}:{EXAMPLE}", "PYTHONDONTWRITEBYTECODE": "1"}

    def wrong_server(self, *turns):
        """It runs until the test ends; where it listens, and the file into which it prints."""
        printed = self.folder / "wrong-server.txt"
        with printed.open("wb") as out:
            server = subprocess.Popen([PYTHON, "-c", WRONG_SERVER, str(self.running.pki), *turns], stdout=out,
                                      stderr=subprocess.DEVNULL, env=self.environment())  # fmt: skip
        self.addCleanup(server.wait)
        self.addCleanup(server.kill)
        port = wait_until(server, lambda: PORT.match(printed.read_text("utf-8")), SECONDS, "its port")
        return f"localhost:{port.group(1)}", printed

    def text(self):
        return self.said.read_text(encoding="utf-8")

    def steps(self):
        return [int(step) for step in STEP.findall(self.text())]

    def wait_for_step(self, agent, step):
        wait_until(agent, lambda: step in self.steps(), SECONDS, f"step {step}")

    @contextlib.contextmanager
    def full_disk(self, agent):
        """A file of the agent grows no further: a write of the spool's log fails."""
        _, most = resource.prlimit(agent.pid, resource.RLIMIT_FSIZE)
        resource.prlimit(agent.pid, resource.RLIMIT_FSIZE, (FILE_BYTES_MAX, most))
        yield
        resource.prlimit(agent.pid, resource.RLIMIT_FSIZE, (most, most))

    @contextlib.contextmanager
    def locked_file(self, _agent):
        """Somebody else writes: no transaction of the agent begins."""
        with contextlib.closing(sqlite3.connect(self.folder / "spool.db", isolation_level=None)) as other:
            other.execute("BEGIN IMMEDIATE")
            yield

    def assert_outlives(self, trouble, error):
        """While its spool fails it says what it loses; afterwards it goes on."""
        agent = self.drive(0, 100_000)
        self.wait_for_step(agent, 100)
        before = self.steps()
        with trouble(agent):
            for said in (f"fault: lost, {error}", f"link: UNAVAILABLE: spool: {error}"):
                wait_until(agent, lambda said=said: said in self.text(), SECONDS, said)
        # What it says of the next step may have been lost.
        after = self.steps()[-1] + 2
        wait_until(agent, lambda: any(step >= after for step in self.stored()), SECONDS, "it sends again")
        agent.send_signal(signal.SIGKILL)
        agent.wait(SECONDS)
        self.assertNotIn("Traceback", self.text())
        done = before + [step for step in self.steps() if step >= after]
        self.assert_ends_stored(self.drive(done[-1] + 2, 1))
        self.assert_stored(done)

    def assert_ends_stored(self, agent):
        self.assertEqual(agent.wait(SECONDS), 0, self.text())
        self.assertIn("everything is stored", self.text())

    def robot(self):
        return self.running.get(f"/api/v1/robots/{urllib.parse.quote(RURI, safe='')}")

    def stored(self):
        """What it said, as the server has it, oldest first."""
        ruri = urllib.parse.quote(RURI, safe="")
        rows = reversed(self.running.get(f"/api/v1/messages?ruri={ruri}&pageSize=1000")["messages"])
        return [int(row["message"].removeprefix("step ")) for row in rows]

    def assert_stored(self, done):
        """Each step that the agent finished said what it had to, once, and in order."""
        stored = self.stored()
        self.assertEqual(stored, sorted(set(stored)))
        self.assertLessEqual({step for step in done if step % SAYS == SAYS - 1}, set(stored))

    def test_what_it_reports_is_shown_and_stored(self):
        self.assert_ends_stored(self.drive(0, 60))
        robot = self.robot()
        self.assertAlmostEqual(robot["motion"]["pose"]["latDeg"], 47.377, 2)
        self.assertEqual(robot["agentInfo"]["agentVersion"], "agent-python 0.1.0")
        self.assertEqual(self.stored(), list(range(SAYS - 1, 60, SAYS)))
        reports = self.running.get("/api/v1/faults?pageSize=1000")["faults"]
        self.assertEqual(len(reports), 60 // SAYS)
        self.assertEqual(self.running.get("/api/v1/faults?active=true")["faults"], [])

    def test_it_says_when_it_will_be_back(self):
        self.assert_ends_stored(self.drive(0, 10, flags=("--parked", "2")))
        self.assertIn("parkedUntil", self.robot())
        self.assert_ends_stored(self.drive(10, 10))
        self.assertNotIn("parkedUntil", self.robot())

    def test_a_server_from_before_goodbye_has_everything(self):
        target, printed = self.wrong_server("good")
        self.assert_ends_stored(self.drive(0, 10, target=target, flags=("--parked", "2")))
        self.assertIn("link: INVALID_ARGUMENT: ", self.text())
        self.assertGreaterEqual(len(printed.read_text("utf-8").split()), 4)

    def test_kills_of_both_sides_lose_and_double_nothing(self):
        done, first = [], 0
        for turn in range(6):
            agent = self.drive(first, 1_000)
            self.wait_for_step(agent, first + 30)
            if turn % 2:
                self.running.kill()
                self.wait_for_step(agent, first + 60)
                self.running.start()
                self.wait_for_step(agent, first + 90)
            agent.send_signal(signal.SIGKILL)
            agent.wait(SECONDS)
            done += self.steps()
            # The next step may have been kept, and not been told.
            first = done[-1] + 2
        self.assert_ends_stored(self.drive(first, 30))
        self.assert_stored(done + self.steps())

    def leave_steps_on_disk(self):
        """The steps of an agent that was killed, and found no server."""
        self.running.kill()
        agent = self.drive(0, 1_000)
        self.wait_for_step(agent, 50)
        agent.send_signal(signal.SIGKILL)
        agent.wait(SECONDS)
        return self.steps()

    def test_what_waits_on_disk_is_sent_by_the_next_start(self):
        done = self.leave_steps_on_disk()
        self.running.start()
        self.assert_ends_stored(self.drive(done[-1] + 2, 1))
        self.assert_stored(done)

    def test_it_stops_with_the_servers_sentence_where_its_certificate_is_refused(self):
        uplinkctl("pki", "operator", "--dir", self.running.pki, "--name", "r1", "--force")
        agent = self.drive(0, 1_000)
        self.assertEqual(agent.wait(SECONDS), 1)
        self.assertRegex(self.text(), r"messages wait in .*spool.db: UNAUTHENTICATED: ")

    def test_what_comes_too_soon_is_sent_again_later(self):
        program = self.folder / "hasty.py"
        program.write_text(HASTY, encoding="utf-8")
        self.assert_ends_stored(self.drive(0, 2, program))
        self.assertNotIn("rejected", self.text())
        self.assertGreater(int(self.robot()["rateLimited"]["agentInfo"]), 0)

    def test_a_wall_clock_that_is_set_back_delays_nothing(self):
        program = self.folder / "set_back.py"
        program.write_text(SET_BACK, encoding="utf-8")
        self.assert_ends_stored(self.drive(0, 2, program))
        self.assertGreater(int(self.robot()["rateLimited"]["agentInfo"]), 0)

    def test_what_waits_for_its_time_is_sent_at_once_after_a_restart(self):
        done = self.leave_steps_on_disk()
        # As if they had come too soon, by a clock that no longer counts.
        with contextlib.closing(sqlite3.connect(self.folder / "spool.db")) as spool, spool:
            spool.execute("UPDATE message SET seq = NULL, due = 1e12")
        self.running.start()
        self.assert_ends_stored(self.drive(done[-1] + 2, 1))
        self.assert_stored(done)

    def test_it_outlives_a_full_disk(self):
        self.assert_outlives(self.full_disk, "disk I/O error")

    def test_it_outlives_a_spool_that_another_program_locks(self):
        self.assert_outlives(self.locked_file, "database is locked")

    def test_it_reconnects_after_each_failure_of_its_spool(self):
        program = self.folder / "failing.py"
        program.write_text(FAILING, encoding="utf-8")
        self.assert_ends_stored(self.drive(0, 60, program))
        text = self.text()
        self.assertIn("agentInfo: lost, no room to keep", text)
        for name in ("hello", "batch", "judged", "acked"):
            self.assertRegex(text, rf"link: UNAVAILABLE: .*no room to {name}\n")
        self.assertNotIn("Traceback", text)
        self.assertEqual(self.stored(), list(range(SAYS - 1, 60, SAYS)))

    def test_it_outlives_what_a_later_or_wrong_server_says(self):
        target, printed = self.wrong_server("welcome", "reject", "ack", "good")
        program = self.folder / "hurried.py"
        program.write_text(HURRIED, encoding="utf-8")
        self.assert_ends_stored(self.drive(0, 10, program, target=target))
        text = self.text()
        self.assertRegex(text, r"link: UNAVAILABLE: ProtocolError\('the server names 18446744073709551615, ")
        self.assertRegex(text, r"link: UNAVAILABLE: ProtocolError\('the server names 1000000000, ")
        escaped = r"'\x1b[31m\x9b2J\u202e'"
        for said in (f"dropped: {escaped}: {escaped}", f"rejected: reason 99 {escaped}: {escaped}",
                     f"link: UNAVAILABLE: {escaped}"):  # fmt: skip
            self.assertIn(f"{said}\n", text)
        self.assertNotIn("Traceback", text)
        acked = [int(number) for line in printed.read_text("utf-8").splitlines()[1:] for number in line.split()]
        self.assertEqual(acked[0], 1, "neither a Reject nor an Ack of what was not sent lets it forget")


if __name__ == "__main__":
    unittest.main()
