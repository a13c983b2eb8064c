"""Rules about who includes what."""

import dataclasses
import posixpath
import re

from tree import Finding

# A folder includes itself and the folders before it; tools and tests see all that come before.
SEES = {
    "schema": {"schema"},
    "metrics": {"schema", "metrics"},
    "storage": {"schema", "metrics", "storage"},
    "server": {"schema", "metrics", "storage", "server"},
    "tools": {"schema", "metrics", "storage", "server", "tools"},
    "tests": {"schema", "metrics", "storage", "server", "tools", "tests"},
}


@dataclasses.dataclass(frozen=True)
class Foreign:
    """A library whose types stop at the folders that `allowed` begins."""

    name: str
    pattern: re.Pattern
    allowed: tuple


FOREIGN = (
    Foreign("gRPC", re.compile(r"^grpc(pp)?/(?!health/|reflection/)|\.grpc\.pb\.h$"), ("tools/", "tests/")),
    Foreign(
        "protobuf",
        re.compile(r"^google/protobuf/|\.pb\.h$"),
        ("schema/uncrew/", "server/session/", "server/uncrew/", "server/view/", "server/admin/", "server/forward/", "server/front/", "server/http/", "server/rpc/", "server/run/process_setup.cc", "tools/", "tests/"),
    ),
    Foreign("nghttp2", re.compile(r"^nghttp2/"), ("server/front/http2/", "server/front/call/", "tools/", "tests/")),
    Foreign("SQLite", re.compile(r"^sqlite3"), ("storage/sqlite/", "tests/")),
    Foreign("libpq", re.compile(r"^(postgresql/)?libpq"), ("storage/postgres/", "tests/")),
    Foreign(
        "Cap'n Proto",
        re.compile(r"^(capnp|kj)/|\.capnp\.h$"),
        ("schema/", "tests/unit/schema/", "tests/conformance/", "tests/fuzz/", "tests/bench/"),
    ),
    Foreign("Boost.JSON", re.compile(r"^boost/json"), ("schema/json/", "schema/rcan/", "schema/cyberwave/", "server/identity/token_line.cc", "server/view/", "tools/", "tests/")),
    Foreign("Boost.Beast", re.compile(r"^boost/beast"), ("server/http/", "tools/", "tests/")),
    Foreign(
        "Boost",
        re.compile(r"^boost/(?!json|beast)"),
        ("server/front/", "server/http/", "server/loop/", "server/mqtt/", "tools/", "tests/"),
    ),
    Foreign("toml++", re.compile(r"^toml\+\+/"), ("server/config/", "tools/", "tests/")),
    Foreign("libmosquitto", re.compile(r"^mosquitto\.h$"), ("tools/uplink-fleet/broker/", "tests/")),
    Foreign("CLI11", re.compile(r"^CLI/"),
            ("server/config/flags.cc", "server/config/flag_errors.cc", "server/config/help_tree.cc")),  # fmt: skip
    Foreign("prometheus-cpp", re.compile(r"^prometheus/"), ("metrics/", "server/http/", "tests/")),
)

# The rooms of server/, in the order in which they may include each other: a room sees itself and the
# steps before its own, never another room of its step. The file of server/ itself (main) comes last
# and sees all. A room that is not here, and one that is here
# and has no folder, is a finding.
ROOMS = (
    ("log", "identity"),  # lines; what a certificate says: both know nothing of the server
    ("config",),  # it reads the certificates that it names, by identity
    ("loop",),  # the event loop; what threads do again and again; wakes
    ("limits",),  # how much one sender may send
    ("transport",),  # what the listener for robots, and a handler of its calls, need beside the wire
    ("robot",),  # what is held of one robot
    ("cyberwave",),  # what is held of one twin: the queries show it, and the series are made of it
    ("fleet",),  # the map of robots
    ("journal",),  # what stands before the store
    ("ingest",),  # what every message goes through, by whichever source it came
    ("uncrew",),  # what drones say by calls: the queries show it, and the series are made of it
    ("session", "view"),  # one stream's protocol; the queries
    ("admin",),  # what operators decide
    # health counts streams by the sessions' probe; the robots' series; what robots share
    ("health", "rcan", "forward"),
    ("front", "mqtt", "http"),  # the adapters: they translate and enqueue
    # what a broker delivers, over mqtt, becomes what robots say; what HTTP answers, by gRPC
    ("broker", "rpc"),
    ("store",),  # a store's life
    ("run",),  # the program: its parts, the way up and down
)
# Tools do not see these.
ADAPTERS = ("front", "mqtt", "http")
# The rooms of uplink-fleet, in the same way: its README says what each holds.
FLEET_ROOMS = (("scenario",), ("robot",), ("twin",), ("drone",), ("broker",), ("compare",), ("report",), ("run",))

# The rooms of server/front, in the same way.
FRONT_ROOMS = (
    ("loop", "tls", "http2"),  # sockets; OpenSSL and nghttp2 without a socket
    ("door",),  # who may come in, by what TLS has shown
    ("call",),  # gRPC over all of these
)

GENERATED = re.compile(r"\.(grpc\.pb|pb|capnp)\.h$")


def direction(tree):
    """schema <- metrics <- storage <- server <- tools, tests."""
    for path in tree.cxx:
        sees = SEES.get(path.split("/")[0])
        for include in tree.includes(path):
            target = include.name.split("/")[0]
            if sees and include.quoted and target in SEES and target not in sees:
                text = f"{path.split('/')[0]} does not include {target}: {include.name}"
                yield Finding(path, include.line, "include-direction", text)


def foreign(tree):
    """The types of a library stop at its own folder."""
    for path in tree.cxx:
        for include in tree.includes(path):
            for library in FOREIGN:
                if library.pattern.search(include.name) and not path.startswith(library.allowed):
                    text = f"{library.name} ({include.name}) belongs in {', '.join(library.allowed)}"
                    yield Finding(path, include.line, "foreign-header", text)


def rooms(tree, order=ROOMS):
    """The rooms of server/ include each other in one direction, and are those of the list."""
    yield from _order(tree, "server", order)
    for path in tree.cxx:
        if path.startswith(("server/", "tests/")):
            continue  # the root and tests see every room
        for include in tree.includes(path):
            if include.quoted and _room_of(include.name, "server") in ADAPTERS:
                text = f"only server/ and tests include adapters: {include.name}"
                yield Finding(path, include.line, "room-order", text)


def fleet_rooms(tree, order=FLEET_ROOMS):
    """The rooms of tools/uplink-fleet/ too."""
    yield from _order(tree, "tools/uplink-fleet", order)


def front_rooms(tree, order=FRONT_ROOMS):
    """The rooms of server/front/ too."""
    yield from _order(tree, "server/front", order)


def _order(tree, house, order):
    """What breaks the order of a house's rooms; files beside its rooms see them all, unseen by them."""
    step_of = {room: step for step, here in enumerate(order) for room in here}
    found = {}
    for path in tree.files:
        room = _room_of(path, house)
        if room is not None:
            found.setdefault(room, path)
    for room in sorted(found.keys() - step_of.keys()):
        text = f"the list of rooms lacks {house}/{room}/ (includes.py)"
        yield Finding(found[room], 1, "room", text)
    if found:
        for room in sorted(step_of.keys() - found.keys()):
            yield Finding("tests/tidy/includes.py", 1, "room", f"there is no {house}/{room}/")
    for path in tree.cxx:
        room = _room_of(path, house)
        if room is None:
            continue
        for include in tree.includes(path):
            if include.quoted and posixpath.dirname(include.name) == house:
                text = f"{house}/{room}/ does not include what joins the rooms: {include.name}"
                yield Finding(path, include.line, "room-order", text)
            target = _room_of(include.name, house) if include.quoted else None
            if target is None or target == room or target not in step_of:
                continue
            if step_of.get(room, len(order)) <= step_of[target]:
                text = f"{house}/{room}/ does not include {house}/{target}/: {include.name}"
                yield Finding(path, include.line, "room-order", text)


def _room_of(name, house):
    """`robot` of server/robot/x.h; None outside the rooms of the house."""
    rest = name.removeprefix(house + "/")
    return rest.split("/")[0] if rest != name and "/" in rest else None


def _source_of(name):
    """The schema file that a generated header comes from; proto/ holds the include root."""
    if name.endswith(".capnp.h"):
        return (name[: -len(".h")],)
    stem = GENERATED.sub(".proto", name)
    return (stem, posixpath.join("proto", stem))


def form(tree):
    """Quoted includes start at the top folder and exist; own header first; #pragma once."""
    for path in tree.cxx:
        includes = tree.includes(path)
        for include in includes:
            if not include.quoted:
                if include.name.split("/")[0] in SEES and tree.has(include.name):
                    yield Finding(path, include.line, "include-form", f"quote {include.name}")
            elif GENERATED.search(include.name):
                if not any(tree.has(source) for source in _source_of(include.name)):
                    text = f"nothing generates {include.name}"
                    yield Finding(path, include.line, "include-form", text)
            elif not tree.has(include.name):
                text = f"no such file from the top folder: {include.name}"
                yield Finding(path, include.line, "include-form", text)
        own = path[: -len(".cc")] + ".h"
        if path.endswith(".cc") and tree.has(own) and (not includes or includes[0].name != own):
            yield Finding(path, 1, "own-header-first", f"begin with {own}")
        if path.endswith(".h") and not any(
            line.strip() == "#pragma once" for line in tree.lines(path)
        ):
            yield Finding(path, 1, "pragma-once", "a header begins with #pragma once")
