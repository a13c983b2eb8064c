"""Drones of others: Node's gRPC library, where it is at hand, and the example for authors of drones."""

import os
import shutil
import subprocess
import unittest

from drone_samples import TYPES, Kind
from drones import HERE, PYTHON, SECONDS, Drone, DroneTest, turned_away
from harness import SOURCE, run

# Debian has no grpc-js: `npm install @grpc/grpc-js @grpc/proto-loader`, and NODE_PATH names its node_modules.
NODE = shutil.which("node")
NEEDED = "require('@grpc/grpc-js'); require('@grpc/proto-loader')"
EXAMPLE = SOURCE / "examples/drone-python/drone.py"
ROUNDS = 9
# The example with a flight that begins with a text of more than 64 KiB.
LENGTHY = """
import drone
from uncrew.v1 import avatar_pb2 as avatar


def flight(step, rounds, plain=drone.flight):
    if step == 0:
        text = avatar.TelemetryStatusText(text="x" * 70_000)
        yield True, "StatusText", avatar.PublishStatusTextRequest(metadata=drone.now(), status_text=text)
    yield from plain(step, rounds)


drone.flight = flight
drone.main()
"""


def has_grpc_js():
    return NODE is not None and subprocess.run([NODE, "-e", NEEDED], capture_output=True, check=False).returncode == 0


@unittest.skipUnless(has_grpc_js(), "Node's @grpc/grpc-js and @grpc/proto-loader are not at hand")
class Node(DroneTest):
    def setUp(self):
        super().setUp()
        self.running = self.serve()
        self.uav = self.keep(Drone([NODE, str(HERE / "drone.js"), str(SOURCE / "proto")], {}))
        self.lead(self.uav, self.running)

    def test_every_type_is_taken_and_known_again(self):
        for name, each in TYPES.items():
            first, second = (self.publish(self.uav, name, 1) for _ in "12")
            live = each.kind is Kind.LIVE
            with self.subTest(name):
                self.assert_outcome(first, "APPLIED" if live else "STORED", dropped={})
                self.assert_outcome(second, "SUPERSEDED" if live else "DUPLICATE")

    def test_calls_that_it_cancels_store_their_sample_once(self):
        for number in range(1, 11):
            self.publish(self.uav, "StatusText", number, lose_after=number / 2500)
            self.assert_outcome(self.publish(self.uav, "StatusText", number), "STORED", "DUPLICATE")
        messages = [row["message"] for row in self.history(self.running, "messages")]
        self.assertEqual(messages, [f"number {number}." for number in range(1, 11)])
        self.assertEqual(turned_away(self.running), [])

    def test_it_is_told_that_no_commands_come(self):
        ends = self.uav.tell("subscribe", to="server", times=3)
        self.assertEqual(ends.pop("commands"), 0)
        ((end, count),) = ends.items()
        self.assertEqual((end.partition(":")[0], count), ("UNIMPLEMENTED", 3))


class Example(DroneTest):
    def fly(self, program):
        """What the program said, and the server to which it flew."""
        server = self.serve()
        self.certify(server.pki, "d1")
        run("protoc", f"--proto_path={SOURCE / 'proto'}", f"--grpc_out={self.modules}",
            "--plugin=protoc-gen-grpc=/usr/bin/grpc_python_plugin", "uncrew/v1/avatar.proto")  # fmt: skip
        done = run(
            PYTHON, program, "--target", server.relay.replace("127.0.0.1", "localhost"), "--pki", server.pki,
            "--name", "d1", "--rounds", ROUNDS, "--every", 0.05, timeout=SECONDS,
            env={**os.environ, "PYTHONPATH": f"{self.modules}:{EXAMPLE.parent}"},
        )  # fmt: skip
        self.assertIn(f"landed after {ROUNDS} rounds", done.stdout)
        return done, server

    def test_the_example_flies_a_delivery_and_everything_of_it_is_stored(self):
        done, server = self.fly(EXAMPLE)
        self.assertEqual(done.stderr, "")
        self.assertEqual([row["message"] for row in self.history(server, "messages")], ["takes off"])
        self.assertEqual(len(self.events(server, "flightMode")), 2)
        faults = [(row["faultId"], row["active"]) for row in self.listed(server, "faults")]
        self.assertEqual(faults, [("battery-low", True)])
        (request,) = self.listed(server, "operator-requests")
        self.assertIn("closedAt", request)
        self.assertGreater(self.shown(server)["battery"]["0"]["remainingPercent"], 0)

    def test_the_example_drops_a_sample_that_is_too_large_and_sends_what_comes_after_it(self):
        program = self.folder / "lengthy.py"
        program.write_text(LENGTHY, encoding="utf-8")
        done, server = self.fly(program)
        self.assertRegex(done.stderr, r"^StatusText: dropped, 70\d\d\d bytes are too many\n$")
        self.assertEqual([row["message"] for row in self.history(server, "messages")], ["takes off"])
        self.assertEqual(len(self.events(server, "flightMode")), 2)


if __name__ == "__main__":
    unittest.main()
