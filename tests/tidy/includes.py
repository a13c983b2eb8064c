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
    Foreign("gRPC", re.compile(r"^grpc(pp)?/|\.grpc\.pb\.h$"), ("server/relay/", "tools/", "tests/")),
    Foreign(
        "protobuf",
        re.compile(r"^google/protobuf/|\.pb\.h$"),
        ("server/session/", "server/view/", "server/relay/", "server/http/", "tools/", "tests/"),
    ),
    Foreign("SQLite", re.compile(r"^sqlite3"), ("storage/sqlite/", "tests/")),
    Foreign("libpq", re.compile(r"^(postgresql/)?libpq"), ("storage/postgres/", "tests/")),
    Foreign(
        "Cap'n Proto",
        re.compile(r"^(capnp|kj)/|\.capnp\.h$"),
        ("schema/", "tests/unit/schema/", "tests/conformance/", "tests/fuzz/", "tests/bench/"),
    ),
    Foreign("Boost.JSON", re.compile(r"^boost/json"), ("schema/json/", "schema/rcan/", "server/view/", "tools/", "tests/")),
    Foreign(
        "Boost",
        re.compile(r"^boost/(?!json)"),
        ("server/http/", "server/loop/", "tools/", "tests/"),
    ),
    Foreign("toml++", re.compile(r"^toml\+\+/"), ("server/config/", "tools/", "tests/")),
    Foreign("spdlog", re.compile(r"^spdlog/"), ("server/log/",)),
    Foreign("CLI11", re.compile(r"^CLI/"), ("server/main.cc", "tools/", "tests/")),
    Foreign("prometheus-cpp", re.compile(r"^prometheus/"), ("metrics/", "server/http/", "tests/")),
)

# Adapters: only the composition root and tests know them, and never one another.
TRANSPORTS = ("server/relay/", "server/http/")
KNOWS_TRANSPORTS = ("server/lifecycle/", "server/app", "server/process_setup", "server/main.cc", "tests/")

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


def transports(tree):
    """A transport is included by itself, by the composition root and by tests."""
    for path in tree.cxx:
        for include in tree.includes(path):
            for transport in TRANSPORTS:
                if include.name.startswith(transport) and not path.startswith(
                    (transport, *KNOWS_TRANSPORTS)
                ):
                    text = f"only the composition root includes {transport}: {include.name}"
                    yield Finding(path, include.line, "transport", text)


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
