#!/usr/bin/env python3
"""Writes the tables of docs/reference/ whose words the code knows. Standard library only.

The words, and the columns that code knows, come from the code's own tables. The other columns are
written by hand in the page and kept row by row. Without --check the pages are rewritten, and what is
left to write by hand is printed; with --check nothing is written. Findings: exit 1.
"""

import argparse
import collections
import dataclasses
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/tidy"))

from tree import NOT_CODE, Finding, Tree, blank  # noqa: E402

RULE = "reference"
STRING = re.compile(r'"(\w+)"')


class OutOfDate(Exception):
    """The code does not look as this script expects."""


def _blank_comment(match):
    return blank(match) if match.group().startswith("/") else match.group()


def code(tree, path):
    """A C++ or proto file without its comments; literals stay."""
    if not tree.has(path):
        raise OutOfDate(f"{path} is not there")
    return NOT_CODE.sub(_blank_comment, tree.text(path))


def found(tree, path, pattern):
    """All that `pattern` finds in the file, at least one."""
    matches = re.findall(pattern, code(tree, path), re.DOTALL)
    if not matches:
        raise OutOfDate(f"{path}: the pattern {pattern} finds nothing")
    return matches


# Log events


@dataclasses.dataclass(frozen=True)
class Source:
    """Where the literals stand that reach a call by a variable: files that begin so, a pattern."""

    begin: str
    pattern: str


# A call of the logger whose event is a variable: its function and expression -> who sets it. The
# pattern's first group is the event, its second, if there is one, one more key.
EVENTS = {
    ("ServeBy", "note.event"): (Source("server/config/load.cc", r'\},\s*"(\w+)"\}\);'),),
    ("DebugLines::TellConnection", "event"): (Source("server/front/door/", r'\bTellConnection\("(\w+)"'),),
    ("DebugLines::TellStream", "event"): (Source("server/front/door/", r'\bTellStream\("(\w+)"'),),
    ("SourceLines::Write", "event"): (
        Source("server/front/", r'\bTell\(\s*"(\w+)"'),
        Source("server/front/door/door_book.cc", r'\breturn (?:\w+ \? )?"(\w+)"'),
    ),
    ("OncePerRobotLog::Write", "event_"): (
        Source("server/forward/", r'\b\w+_\(context\.logger, "(\w+)"(?:, "(\w+)")?\)'),
    ),
    ("HealthLog::LogChange", "condition.works_again"): (
        Source("server/store/health_log.h", r'\bCondition \w+\{"\w+", "(\w+)"\}'),
    ),
    ("HealthLog::LogChange", "condition.fails"): (
        Source("server/store/health_log.h", r'\bCondition \w+\{"(\w+)", "\w+"\}'),
    ),
}
# A key that is a variable. Nothing: the pattern of the event finds it.
KEYS = {
    ("LiveBudget::Tell", "name.key"): Source(
        "server/fleet/live_budget.cc", r'(?:return |holder_of\()\{"(\w+)",'
    ),
    ("OncePerRobotLog::Write", "other_"): None,
}
LOGS = "server/log/"
CALL = re.compile(r"(\w*)(?:\.|->)(Debug|Info|Warn|Error|Write)\(|\bLineText\(")
FUNCTION = re.compile(r"^(?! |//|#|\}|namespace|class|struct|using|constexpr)[^\n]*?([\w:~]+)\(", re.M)
LEVEL = re.compile(r"\bLevel::k(Debug|Info|Warn|Error)\b")
FIELD = re.compile(r"\{\s*([\w.]+|\"\w+\")\s*,")


def arguments(text, start):
    """The arguments of a call whose parenthesis opens before `start`, split at its commas."""
    parts, depth, begin, at = [], 0, start, start
    while at < len(text):
        literal = NOT_CODE.match(text, at)
        if literal:
            at = literal.end()
            continue
        letter = text[at]
        if letter in ")]}" and depth == 0 or letter == "," and depth == 0:
            parts.append(text[begin:at].strip())
            begin = at + 1
            if letter != ",":
                break
        depth += (letter in "([{") - (letter in ")]}")
        at += 1
    return parts


def fields(text):
    """The expressions of the keys in `{{"key", value}, ...}`."""
    keys, at, depth = [], 0, 0
    while at < len(text):
        match = FIELD.match(text, at) if depth == 1 else None
        if match:
            keys.append(match.group(1))
        literal = NOT_CODE.match(text, at)
        if literal:
            at = literal.end()
            continue
        depth += (text[at] in "([{") - (text[at] in ")]}")
        at += 1
    return keys


@dataclasses.dataclass
class Event:
    """What all the lines of one event have."""

    levels: set = dataclasses.field(default_factory=set)
    keys: dict = dataclasses.field(default_factory=dict)  # in their order
    rooms: set = dataclasses.field(default_factory=set)


def room_of(path):
    """`store` of server/store/x.cc; `main` beside the rooms."""
    parts = path.split("/")
    return parts[1] if len(parts) > 2 else "main"


def set_by(tree, source):
    """(path, match) for each literal that `source` finds."""
    for path in tree.cxx:
        if path.startswith(source.begin):
            for match in re.finditer(source.pattern, code(tree, path)):
                yield path, match


def log_calls(tree):
    """(path, function, level expression, event expression, keys) of each call of the logger."""
    for path in tree.cxx:
        if not path.startswith("server/") or not CALL.search(tree.text(path)):
            continue
        text = code(tree, path)
        for match in CALL.finditer(text):
            writer, verb = match.groups()
            parts = arguments(text, match.end())
            if verb is None:
                parts = parts[1:]  # the format
            elif verb != "Write":
                parts = [f"Level::k{verb}", *parts]
            functions = FUNCTION.findall(text, 0, match.start())
            function = functions[-1] if functions else ""
            if len(parts) < 2 or not LEVEL.search(parts[0]):
                if "logger" in (writer or "") and not path.startswith(LOGS):
                    raise OutOfDate(f"{path}: {function} logs with a level that is a variable")
                continue
            level, event = parts[:2]
            if not path.startswith(LOGS):
                keys = fields(parts[2]) if len(parts) > 2 else []
            elif STRING.fullmatch(event):
                keys = [f'"{key}"' for key in re.findall(r'\bField \w+\("(\w+)"', text)]
            else:
                continue  # how a line is made, of whichever event
            yield path, function, level, event, keys


def log_events(tree):
    """Every event of the log -> Event."""
    events = collections.defaultdict(Event)
    for path, function, level, event, keys in log_calls(tree):
        names = [(path, name, None) for name in STRING.findall(event)]
        if not names:
            if (function, event) not in EVENTS:
                raise OutOfDate(f"{path}: {function} logs {event}: EVENTS does not say who sets it")
            for source in EVENTS[function, event]:
                for where, match in set_by(tree, source):
                    more = match.group(2) if match.re.groups > 1 else None
                    names.append((where, match.group(1), more))
            if not names:
                raise OutOfDate(f"{path}: {function} logs {event}: EVENTS finds no literal")
        for where, name, more in names:
            known = events[name]
            known.levels.update(each.lower() for each in LEVEL.findall(level))
            known.rooms.add(room_of(where))
            for key in keys:
                if STRING.fullmatch(key):
                    known.keys.setdefault(key.strip('"'))
                elif (function, key) not in KEYS:
                    raise OutOfDate(f"{path}: {function} logs the key {key}: KEYS does not say which")
                elif KEYS[function, key]:
                    for _, match in set_by(tree, KEYS[function, key]):
                        known.keys.setdefault(match.group(1))
            if more:
                known.keys.setdefault(more)
    if not events:
        raise OutOfDate("server/ logs no event")
    return events


LEVELS = ("debug", "info", "warn", "error")


def log_event_rows(tree):
    for name, event in sorted(log_events(tree).items()):
        level = ", ".join(level for level in LEVELS if level in event.levels)
        keys = " ".join(f"`{key}`" for key in event.keys)
        yield f"`{name}`", level, keys, ", ".join(sorted(event.rooms))


# The other pages

READINESS = "server/health/readiness.cc"
TURNED_AWAY = "server/transport/turned_away.h"
CONTRACT = "proto/uplink/v1/relay.proto"
REASONS = "schema/model/rejection.h"
REASON_TEXTS = "schema/model/rejection.cc"
EXITS = (
    ("uplinkd", "server/main.cc"),
    ("uplinkctl", "tools/uplinkctl/command.h"),
    ("uplink-fleet", "tools/uplink-fleet/run/run_options.h"),
)


def degraded_rows(tree):
    for word in found(tree, READINESS, r'refuses\.emplace_back\("(\w+)"\)'):
        yield f"`{word}`", "refuses"
    table = found(tree, READINESS, r"to_array<DegradedWord>\(\{(.*?)\}\);")[0]
    for word in re.findall(r'\{"(\w+)",', table):
        yield f"`{word}`", "degraded"


def cause_rows(tree):
    table = found(tree, TURNED_AWAY, r"\bkTurnedAwayTexts = \{(.*?)\};")[0]
    for cause in STRING.findall(table):
        yield (f"`{cause}`",)


def reject_rows(tree):
    numbers = dict(found(tree, REASONS, r"\bk(\w+) = (\d+),"))
    texts = dict(found(tree, REASON_TEXTS, r'case RejectReason::k(\w+):\s*return "(\w+)";'))
    names = {number: name for name, number in found(tree, CONTRACT, r"\bREJECT_REASON_(\w+) = (\d+);")}
    names.pop("0", None)  # unspecified
    if sorted(numbers) != sorted(texts) or sorted(numbers.values()) != sorted(names):
        raise OutOfDate(f"{REASONS}, {REASON_TEXTS} and {CONTRACT} do not have the same reasons")
    for reason, number in sorted(numbers.items(), key=lambda each: int(each[1])):
        yield f"`{names[number]}`", f"`{texts[reason]}`", number


def exit_rows(tree):
    for program, path in EXITS:
        codes = found(tree, path, r"\bint kExit\w+ = (\d+);")
        for each in sorted(codes, key=int):
            yield f"`{program}`", each


@dataclasses.dataclass(frozen=True)
class Page:
    """A table: its columns from code, whose first `key` name a row, and those by hand."""

    path: str
    rows: object
    generated: tuple
    written: tuple
    key: int = 1
    # Of the columns by hand, those that may be empty.
    optional: tuple = ()

    @property
    def columns(self):
        return self.generated + self.written


FOLDER = "docs/reference/"
PAGES = (
    Page(FOLDER + "degraded.md", degraded_rows, ("word", "in"), ("means", "do first")),
    Page(
        FOLDER + "log-events.md", log_event_rows, ("event", "level", "keys", "room"), ("means",)
    ),
    Page(FOLDER + "causes.md", cause_rows, ("cause",), ("means", "do first")),
    Page(
        FOLDER + "rejects.md",
        reject_rows,
        ("`REJECT_REASON_`", "text", "number"),
        ("means", "usual cause"),
        optional=("usual cause",),
    ),
    Page(FOLDER + "exit-codes.md", exit_rows, ("program", "code"), ("means",), key=2),
)


def line_of(cells):
    """`| a | b |`; an empty cell has no blanks of its own, as in the other pages."""
    return "|" + "".join(f" {cell} |" for cell in cells)


def cells_of(line):
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]]


@dataclasses.dataclass
class Made:
    """A page as it should be, and what must be written by hand or was dropped: (line, text)."""

    text: str
    findings: list
    # Lines whose columns from code are not what the code says.
    stale: list


def make(tree, page):
    """The page with its table from the code. OutOfDate if the code or the page is not as expected."""
    if not tree.has(page.path):
        raise OutOfDate("the page is not there")
    lines = tree.text(page.path).splitlines()
    header = line_of(page.columns)
    if header not in lines:
        raise OutOfDate(f"the page has no table {header}")
    first = lines.index(header)
    last = first
    while last < len(lines) and lines[last].startswith("|"):
        last += 1
    written, at, cells_at, stale = {}, {}, {}, []
    for number, line in enumerate(lines[first + 2 : last], first + 3):
        cells = cells_of(line)
        key = tuple(cells[: page.key])
        written[key] = dict(zip(page.written, cells[len(page.generated) :]))
        at[key], cells_at[key] = number, cells[: len(page.generated)]
    table, findings, keys = [header, line_of("---" for _ in page.columns)], [], set()
    for row in page.rows(tree):
        key = tuple(row[: page.key])
        keys.add(key)
        if cells_at.get(key, list(row)) != list(row):
            stale.append(at[key])
        texts = written.get(key, {})
        for column in page.written:
            if not texts.get(column) and column not in page.optional:
                findings.append((at.get(key, first + 1), f"{' '.join(key)}: write its {column!r}"))
        table.append(line_of((*row, *(texts.get(column, "") for column in page.written))))
    for key in written.keys() - keys:
        findings.append((at[key], f"{' '.join(key)} is not in the code any more"))
    text = "\n".join([*lines[:first], *table, *lines[last:]]) + "\n"
    return Made(text, findings, stale)


def pages(tree, which=PAGES):
    """The pages of docs/reference/ say what the code says; each row has its sentence."""
    for page in which:
        try:
            made = make(tree, page)
        except OutOfDate as error:
            yield Finding(page.path, 1, RULE, str(error))
            continue
        for line, text in sorted(made.findings):
            yield Finding(page.path, line, RULE, text)
        now, then = tree.text(page.path).splitlines(), made.text.splitlines()
        differs = [n for n, (a, b) in enumerate(zip(now, then), 1) if a != b] or [len(then)]
        line = min(made.stale, default=differs[0])
        if made.stale or now != then and not made.findings:
            yield Finding(page.path, line, RULE, "not what the code says: run tools/dev/reference.py")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", default=".")
    parser.add_argument("--check", action="store_true", help="write nothing")
    options = parser.parse_args()
    tree = Tree(options.root)
    findings = sorted(pages(tree))
    for finding in findings:
        print(finding)
    if options.check:
        return 1 if findings else 0
    for page in PAGES:
        try:
            made = make(tree, page)
        except OutOfDate:
            continue
        (tree.root / page.path).write_text(made.text, encoding="utf-8")
    return 1 if list(pages(Tree(options.root))) else 0


if __name__ == "__main__":
    sys.exit(main())
