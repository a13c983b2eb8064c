"""Rules about what stands in a file: its length, banned calls, words."""

import dataclasses
import re

from tree import Finding

LINES_MAX = 300
TEST_LINES_MAX = 500
# Files that are longer for a reason: path -> (lines, reason). An entry that is no longer needed is
# itself a finding.
LONG_FILES = {
    "metrics/catalogue.cc": (480, "one table of data, a row per metric"),
    "server/config/settings.cc": (930, "one table of data, a row per setting"),
    "tests/tidy/test_tidy.py": (800, "one list, a short class per rule"),
    "tools/dev/reference.py": (420, "one list, a short reader per page"),
}


@dataclasses.dataclass(frozen=True)
class Banned:
    """A call and what stands in its place. `within`: where it is banned; `allowed`: where not."""

    pattern: re.Pattern
    instead: str
    within: tuple
    allowed: tuple = ()


CODE = ("schema/", "metrics/", "storage/", "server/", "tools/", "tests/")
LIBRARY = ("schema/", "metrics/", "storage/", "server/")

BANNED = (
    Banned(
        re.compile(r"\b(sleep_for|sleep_until|usleep|nanosleep|sleep)\s*\("),
        "wait on a condition with a deadline, or move a ManualClock",
        (*LIBRARY, "tests/"),
    ),
    Banned(
        re.compile(
            r"\b(system_clock|steady_clock|high_resolution_clock)::now\s*\("
            r"|\b(gettimeofday|clock_gettime)\s*\(|\btime\s*\(\s*(nullptr|NULL|0)\s*\)"
        ),
        "take a Clock& (schema/base/clock.h)",
        CODE,
        ("schema/base/clock.cc",),
    ),
    Banned(
        re.compile(r"\b(secure_)?getenv\s*\("),
        "settings come from server/config",
        CODE,
        ("server/config/", "tests/"),
    ),
    Banned(
        re.compile(r"\bstd::(cout|cerr|clog)\b|(?<![\w])v?printf\s*\(|\bfmt::print\s*\("),
        "log through server/log",
        LIBRARY,
        ("server/main.cc",),
    ),
    Banned(re.compile(r"\bthrow\b"), "return a Status or a Rejection", CODE),
    Banned(re.compile(r"\.detach\s*\("), "join it: std::jthread", CODE),
    Banned(re.compile(r"\bs?rand\s*\("), "take a seeded generator", CODE),
    Banned(
        re.compile(r"\bfor \(.* : (\*[\w.>-]+\(|.*\)->\w+\)|.*\)\.value\(\)(\.\w+)?\))"),
        "name what the call returns: it ends before the loop does",
        CODE,
    ),
    Banned(re.compile(r"\bGTEST_SKIP\b"), "fail and name the remedy", ("tests/",)),
)

NOLINT = re.compile(r"NOLINT(NEXTLINE|BEGIN)?\b(?!\([a-z0-9.,* -]+\): \S)")

# Words that do not belong in the tree, anywhere.
WORDS = (
    (re.compile(r"\b(FIXME|XXX|HACK)\b"), "write TODO(soon|perf|security|test): text, or do it"),
    (re.compile(r"\bTODO\b(?!\((soon|perf|security|test)\): \S)"), "TODO(soon|perf|security|test): text"),
    (re.compile(r"\bissues?\s+#?\d+", re.IGNORECASE), "say what it is, not its number"),
    (re.compile(r"(?<![\w.$}])/(work|home|root|Users)/"), "no path of one machine"),
    (re.compile(r"\b(chatgpt|claude|copilot)\b", re.IGNORECASE), "tools of an author are not content"),
)
# These name the words in order to find them.
WORDS_ALLOWED = ("tests/tidy/",)
TEXT_SUFFIXES = (
    ".h", ".cc", ".py", ".sh", ".md", ".txt", ".toml", ".cmake", ".json", ".proto", ".capnp", ".sql",
    ".yml", ".yaml", ".service", ".svg",
)  # fmt: skip


def length(tree, long_files=None):
    """Files of C++ and Python stay short enough to hold one concept."""
    long_files = LONG_FILES if long_files is None else long_files
    for path in (*tree.cxx, *(each for each in tree.files if each.endswith(".py"))):
        lines = len(tree.lines(path))
        usual = TEST_LINES_MAX if path.startswith("tests/") else LINES_MAX
        limit = long_files[path][0] if path in long_files else usual
        if lines > limit:
            yield Finding(path, limit, "file-length", f"{lines} lines, at most {limit}: split it")
        elif path in long_files and lines <= usual:
            yield Finding(path, 1, "file-length", "no longer long: take it off LONG_FILES")
    for path in long_files:
        if not tree.has(path):
            yield Finding(path, 1, "file-length", "LONG_FILES names a file that is not there")


def banned(tree):
    """Calls that have a better one of ours."""
    for path in tree.cxx:
        for number, line in enumerate(tree.code(path), 1):
            for call in BANNED:
                match = call.pattern.search(line)
                if match and path.startswith(call.within) and not path.startswith(call.allowed):
                    text = f"{match.group().strip()}: {call.instead}"
                    yield Finding(path, number, "banned-call", text)
        for number, line in enumerate(tree.lines(path), 1):
            if NOLINT.search(line):
                yield Finding(path, number, "nolint", "NOLINT(check): reason")


def words(tree):
    """Texts that mean something to one person or machine only."""
    for path in tree.files:
        if path.startswith(WORDS_ALLOWED):
            continue
        if not path.endswith(TEXT_SUFFIXES) and "." in path.split("/")[-1].lstrip("."):
            continue
        for number, line in enumerate(tree.lines(path), 1):
            for pattern, instead in WORDS:
                match = pattern.search(line)
                if match:
                    yield Finding(path, number, "word", f"{match.group()!r}: {instead}")
