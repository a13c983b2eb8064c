"""The robot's payloads: what it says, as the server reads it."""

import math
import os
import time

import capnp

VERSION = "agent-python 0.1.0"


def now():
    return time.time_ns() // 1_000_000


class Robot:
    """Makes payloads: one UplinkMsg of schema/uplink.capnp each."""

    def __init__(self, schema):
        # Its import of c++.capnp lies in the package of pycapnp.
        imports = [os.path.dirname(os.path.dirname(capnp.__file__))]
        self.message = capnp.load(str(schema), imports=imports).UplinkMsg

    def motion(self, latitude, longitude, heading, speed):
        message = self.message.new_message()
        motion = message.init("motionTelemetry")
        motion.unixTimeMs, motion.hasPose, motion.hasVelocity = now(), True, True
        motion.pose = {"latDeg": latitude, "lonDeg": longitude, "altitudeM": math.nan, "headingDeg": heading}
        motion.velocity = {"linearMps": speed}
        return message.to_bytes()

    def status(self, percent):
        message = self.message.new_message()
        status = message.init("statusTelemetry")
        status.unixTimeMs, status.hasBattery, status.hasMode, status.mode = now(), True, True, "auto"
        status.battery = {"socPct": percent, "powerSupplyStatus": "discharging"}
        return message.to_bytes()

    def fault(self, name, active, description):
        message = self.message.new_message()
        fault = message.init("fault")
        fault.unixTimeMs, fault.faultId, fault.source, fault.active = now(), name, "drive", active
        fault.severity, fault.description = "major", description
        return message.to_bytes()

    def say(self, text):
        message = self.message.new_message()
        said = message.init("message")
        said.unixTimeMs, said.message = now(), text
        return message.to_bytes()

    def agent_info(self):
        message = self.message.new_message()
        message.init("agentInfo").agentVersion = VERSION
        return message.to_bytes()
