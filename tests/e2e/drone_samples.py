"""What the drones of these tests say: the types of uncrew/v1/avatar.proto, and of each a sample by number,
in the JSON form of the contract. Samples of two numbers differ.

It needs neither gRPC nor protobuf, so that tests and drones of any language share it.
"""

import dataclasses
import enum

LINKS = ("autopilot", "winch", "avatar")
MODES = ("READY", "TAKEOFF", "HOLD", "MISSION", "RETURN_TO_LAUNCH", "LAND")
OWN_MODES = ("preflight", "cruise", "crouch", "deliver")
STATES = ("STARTED", "SUCCEEDED", "FAILED", "REFUSED", "EXPIRED", "CANCELLED")
# Of alerts: one comes, another one comes beside it, the first gives way to a third, all are over.
SETS = (set(), {"low-0"}, {"low-0", "low-1"}, {"low-1", "low-2"})


class Kind(enum.Enum):
    """What becomes of a sample: it is shown, or stored, or stored where it changes something."""

    LIVE = "live"
    DURABLE = "durable"
    CHANGE = "change"


@dataclasses.dataclass(frozen=True)
class Type:
    """`field`: of the request, which holds the sample. `key`: how the sample of `sample_of` is told apart
    from others of the same type; none: the type has one."""

    field: str
    kind: Kind
    key: str = ""


TYPES = {
    "Altitude": Type("altitude", Kind.LIVE),
    "Armed": Type("armed", Kind.CHANGE),
    "Battery": Type("battery", Kind.LIVE, "0"),
    "CameraMode": Type("camera_mode", Kind.LIVE, "1"),
    "ConnectionEvent": Type("connection_event", Kind.DURABLE),
    "CurrentMissionItem": Type("current_mission_item", Kind.CHANGE),
    "DistanceSensor": Type("distance_sensor", Kind.LIVE, "2"),
    "Error": Type("error", Kind.DURABLE),
    "FlightMode": Type("flight_mode", Kind.CHANGE),
    "GPSInfo": Type("gps_info", Kind.LIVE),
    "GimbalControlStatus": Type("gimbal_control_status", Kind.LIVE, "3"),
    "Heading": Type("heading", Kind.LIVE),
    "Health": Type("health", Kind.LIVE),
    "Imu": Type("imu", Kind.LIVE),
    "Odometry": Type("odometry", Kind.LIVE),
    "PoseEuler": Type("pose_euler", Kind.LIVE),
    "Position": Type("position", Kind.LIVE),
    "StatusText": Type("status_text", Kind.DURABLE),
    "UncrewFlightMode": Type("uncrew_flight_mode", Kind.CHANGE),
    "VelocityNed": Type("velocity_ned", Kind.LIVE),
    "VideoStreamSettings": Type("video_stream_settings", Kind.LIVE, "4"),
    "WinchReelStatus": Type("winch_reel_status", Kind.LIVE, "5"),
    "WinchStatus": Type("winch_status", Kind.LIVE, "6"),
    "Alert": Type("alerts", Kind.DURABLE),
    "OperatorActionRequests": Type("operator_action_requests", Kind.DURABLE),
    # Its sample is not one field: see request_of.
    "UAVCommandResult": Type("", Kind.DURABLE),
}
TELEMETRY = tuple(name for name in TYPES if name not in ("Alert", "OperatorActionRequests", "UAVCommandResult"))
# A set of alerts in which one id stands twice: a row of quarantine, and no change of the set.
WRONG = "Wrong"
# It is said at numbers that this divides: a store keeps a bounded number of such rows of a robot.
WRONG_EVERY = 8
UNSTORED = tuple(name for name, each in TYPES.items() if each.kind is Kind.LIVE)
STORED = tuple(name for name in TYPES if name not in UNSTORED)


def value_of(name, number):
    """The value whose change is reported, or that the stored row names."""
    if name == "Armed":
        return number % 2 == 1
    if name == "FlightMode":
        return MODES[number % len(MODES)]
    if name == "UncrewFlightMode":
        return OWN_MODES[number % len(OWN_MODES)]
    return number


def alerts_of(number):
    """The ids of the alerts that are active at this number. The set changes with each."""
    return SETS[number % len(SETS)]


def requests_of(number):
    """The ids of the requests that wait: one, none, another one. One that was closed does not come back."""
    return {f"ask-{number // 2}"} if number % 2 else set()


def alerts(*ids, termination=()):
    """A set of alerts, those of `termination` that the drone ends its flight."""
    batteries = [
        {"alert_id": each, "text": f"battery of {each}", "reaction": {"rtl": {}},
         "battery_percentage": {"battery_id": 0, "remaining_percent": 18, "threshold_percent": 20}}
        for each in ids
    ]  # fmt: skip
    ends = [
        {"alert_id": each, "reaction": {"none": {}}, "flight_termination": {"cause": "geofence"}}
        for each in termination
    ]
    return {"alerts": batteries + ends}


def requests(*ids, kind="confirm_delivery_ready"):
    """A set of requests that wait for an operator."""
    return {"requests": [{"request_id": each, "text": f"asks {each}", kind: {}} for each in ids]}


def result(number):
    """What became of a command."""
    state = STATES[number % len(STATES)]
    return {"command_id": f"{number:032x}", "status": {"state": f"STATE_{state}", "text": f"number {number}."}}


def _xyz(number):
    return {"x": number, "y": -number, "z": 0.5}


def _body(number):
    return {"forward": number, "right": 0.25, "down": 9.75}


SAMPLES = {
    "Altitude": lambda n: {"altitude_amsl_m": 400 + n, "altitude_relative_m": n, "altitude_terrain_m": n + 0.5},
    "Armed": lambda n: {"is_armed": value_of("Armed", n)},
    "Battery": lambda n: {"id": 0, "voltage_v": 22.5, "remaining_percent": 100 - n % 100, "capacity_consumed_ah": n},
    "CameraMode": lambda n: {"mode": "CAMERA_MODE_VIDEO" if n % 2 else "CAMERA_MODE_PHOTO", "camera_id": 1},
    "ConnectionEvent": lambda n: {"kind": "KIND_CONNECTED" if n % 2 else "KIND_DISCONNECTED",
                                  "link": LINKS[n % len(LINKS)], "text": f"number {n}."},
    "CurrentMissionItem": lambda n: {"current": n, "total": 1_000_000, "mission_id": "round"},
    "DistanceSensor": lambda n: {"current_distance_m": n + 0.25, "maximum_distance_m": 1e6, "id": 2},
    "Error": lambda n: {"code": "E7", "text": f"number {n}.", "source": "autopilot"},
    "FlightMode": lambda n: {"mode": f"FLIGHT_MODE_{value_of('FlightMode', n)}"},
    "GPSInfo": lambda n: {"num_satellites": n % 32, "fix_type": "GPS_FIX_TYPE_FIX_3D"},
    "GimbalControlStatus": lambda n: {"gimbal_id": 3, "control_mode": "CONTROL_MODE_PRIMARY",
                                      "sysid_primary_control": n % 256},
    "Heading": lambda n: {"heading_deg": n % 360},
    "Health": lambda n: {"is_armable": n % 2 == 0, "is_gyrometer_calibration_ok": True},
    "Imu": lambda n: {"acceleration_m_s2": _body(n % 90), "temperature_degc": 31},
    "Odometry": lambda n: {"frame_id": "FRAME_BODY_NED", "position_m": _xyz(n),
                           "pose_covariance": {"covariance_matrix": [0.5] * 21}},
    "PoseEuler": lambda n: {"roll_deg": n % 45, "pitch_deg": -3, "yaw_deg": 12.5},
    "Position": lambda n: {"latitude_deg": 47 + n % 1000 / 1e4, "longitude_deg": 8.5, "absolute_altitude_m": 431.5},
    "StatusText": lambda n: {"type": "STATUS_TEXT_TYPE_WARNING", "text": f"number {n}."},
    "UncrewFlightMode": lambda n: {"mode": value_of("UncrewFlightMode", n), "detail": "by plan"},
    "VelocityNed": lambda n: {"north_m_s": 3 + n % 50, "east_m_s": 4, "down_m_s": -1.5},
    "VideoStreamSettings": lambda n: {"frame_rate_hz": 30, "bit_rate_b_s": n, "stream_id": 4},
    "WinchReelStatus": lambda n: {"state": "spooled", "line_remaining_m": n, "instance": 5},
    "WinchStatus": lambda n: {"line_length_m": n + 0.5, "tension_kg": 1.25, "instance": 6,
                              "status_flags": {"healthy": True}},
    "Alert": lambda n: alerts(*sorted(alerts_of(n))),
    "OperatorActionRequests": lambda n: requests(*requests_of(n)),
    "UAVCommandResult": lambda n: result(n),
}  # fmt: skip


def sample_of(name, number):
    return SAMPLES[name](number)


def request_of(name, sample, metadata):
    """The request of a call. None as the sample: it is left out."""
    request = {"metadata": metadata}
    if name == "UAVCommandResult":
        request.update(sample or {})
    elif sample is not None:
        request[TYPES[name].field] = sample
    return request


def call_of(name, number):
    """Type and request of the call by which the sample of this number is published."""
    if name == WRONG:
        return "Alert", request_of("Alert", alerts(f"wrong-{number}", f"wrong-{number}"), times(number))
    return name, request_of(name, sample_of(name, number), times(number))


def times(number, start_us=1_795_262_400_000_000):
    """Metadata of the sample of this number: a second after the one before."""
    return {"sampled_at_unix_us": start_us + number * 1_000_000, "sampled_at_boot_us": (1 + number) * 1_000_000}
