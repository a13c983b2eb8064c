"""Rules about the tree as a whole: what is built, configured, linked and explained."""

import posixpath
import re

from tree import SOURCE_FOLDERS, Finding

SETTINGS = "server/config/settings.cc"
EXAMPLE = "deploy/uplinkd.toml"
RATE = re.compile(r'^ *UPLINK_RATE\(([a-z0-9_]+), "', re.MULTILINE)
SETTING = re.compile(r'\.section\s*=\s*"([a-z0-9_]+)",\s*\.key\s*=\s*"([a-z0-9_.]+)"')
SECTION_LINE = re.compile(r"^\[([a-z0-9_]+)\]")
KEY_LINE = re.compile(r"^(?:#\s*)?([a-z0-9_.]+)\s*=\s")

README_FOLDERS = ("proto", "schema", "metrics", "storage", "server", "tools", "deploy", "tests")
ROOM_FOLDERS = ("server/", "storage/")
CMAKE_COMMENT = re.compile(r"#.*")
CMAKE_SOURCE = re.compile(r"[\w./+-]+\.(?:cc|h)\b")
TARGET = re.compile(r"\buplink_(?:library|interface)\(\s*(\w+)")
SUBDIRECTORY = re.compile(r"\badd_subdirectory\(\s*([\w./-]+)")
# These pages name files and tests, and a developer follows them.
NAMING_PAGES = (
    "docs/design/architecture.md",
    "docs/design/failures.md",
    "docs/design/adding.md",
)
QUOTED = re.compile(r"`([^`]+)`")
NAMED_PATH = re.compile(r"(?:%s)/[\w./-]*" % "|".join((*README_FOLDERS, "docs")))
NAMED_TEST = re.compile(r"[A-Z]\w+\.[A-Z]\w+")
NAMED_PYTHON = re.compile(r"test_\w+(?:\.py)?")
TEST = re.compile(r"\bTEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)")
PYTHON_TEST = re.compile(r"\bdef (test_\w+)\(")
DOC_PAGE = re.compile(r'\bDocPage\(\s*"([^"]+)"(?:,\s*"([^"]+)")?')
LINK = re.compile(r"\[[^\]]*\]\(([^)\s#]+)(?:#[^)]*)?\)")


def _cmake(tree, path):
    return CMAKE_COMMENT.sub("", tree.text(path))


def _cmake_files(tree):
    return [path for path in tree.files if posixpath.basename(path) == "CMakeLists.txt"]


def built(tree):
    """Every source is named in a CMakeLists.txt, every header is included, every list is entered."""
    named, entered = set(), set()
    for path in _cmake_files(tree):
        folder = posixpath.dirname(path)
        text = _cmake(tree, path)
        for name in CMAKE_SOURCE.findall(text):
            named.add(posixpath.normpath(posixpath.join(folder, name)))
        for name in SUBDIRECTORY.findall(text):
            entered.add(posixpath.normpath(posixpath.join(folder, name, "CMakeLists.txt")))
    included = {include.name for path in tree.cxx for include in tree.includes(path)}
    for path in tree.cxx:
        if not path.startswith(tuple(folder + "/" for folder in SOURCE_FOLDERS)):
            continue
        if path.endswith(".cc") and path not in named:
            yield Finding(path, 1, "not-built", "no CMakeLists.txt names it")
        if path.endswith(".h") and path not in included:
            yield Finding(path, 1, "not-built", "nothing includes it")
    for path in _cmake_files(tree):
        if path != "CMakeLists.txt" and path not in entered:
            yield Finding(path, 1, "not-built", "no add_subdirectory enters it")


def targets(tree):
    """What the list of a room of server/ builds is named after that room."""
    for path in _cmake_files(tree):
        parts = path.split("/")
        if parts[0] != "server" or len(parts) < 3:
            continue
        for name in TARGET.findall(_cmake(tree, path)):
            if name != f"uplink_{parts[1]}" and not name.startswith(f"uplink_{parts[1]}_"):
                text = f"{name} is not named after its room: uplink_{parts[1]}"
                yield Finding(path, 1, "target", text)


def settings(tree):
    """The keys of the settings table that do something are those of the example file."""
    if not tree.has(SETTINGS) or not tree.has(EXAMPLE):
        missing = EXAMPLE if tree.has(SETTINGS) else SETTINGS
        yield Finding(missing, 1, "settings", "the file is not there")
        return
    text = tree.text(SETTINGS)
    table = {}
    for match in SETTING.finditer(text):
        if ".effect = Effect::kNone" in text[match.end() :].split("{.section")[0]:
            continue
        table[f"{match.group(1)}.{match.group(2)}"] = text.count("\n", 0, match.start()) + 1
    for match in RATE.finditer(text):
        for key in (match.group(1), match.group(1) + "_burst"):
            table[f"rates.{key}"] = text.count("\n", 0, match.start()) + 1
    example, section = {}, ""
    for number, line in enumerate(tree.lines(EXAMPLE), 1):
        head, key = SECTION_LINE.match(line), KEY_LINE.match(line)
        if head:
            section = head.group(1)
        elif key:
            example[f"{section}.{key.group(1)}"] = number
    for key in sorted(table.keys() - example.keys()):
        yield Finding(SETTINGS, table[key], "settings", f"{key} is not in {EXAMPLE}")
    for key in sorted(example.keys() - table.keys()):
        yield Finding(EXAMPLE, example[key], "settings", f"{key} is no setting")
    if not table:
        yield Finding(SETTINGS, 1, "settings", "no setting was found: the pattern is out of date")


def links(tree):
    """Relative links of the documents lead somewhere."""
    folders = {posixpath.dirname(path) for path in tree.files}
    for path in tree.files:
        if not path.endswith(".md"):
            continue
        for number, line in enumerate(tree.lines(path), 1):
            for name in LINK.findall(line):
                if re.match(r"[a-z]+:", name):
                    continue
                target = posixpath.normpath(posixpath.join(posixpath.dirname(path), name))
                if not tree.has(target) and not any(
                    each == target or each.startswith(target + "/") for each in folders
                ):
                    yield Finding(path, number, "link", f"leads nowhere: {name}")


def doc_pages(tree):
    """The pages of the handbook that messages name are there, with the heading that is named."""
    for path in tree.cxx:
        if path.startswith("tests/"):
            continue
        text = tree.text(path)
        for found in DOC_PAGE.finditer(text):
            page, heading = found.groups()
            number = text.count("\n", 0, found.start()) + 1
            if not tree.has(page):
                yield Finding(path, number, "doc-page", f"leads nowhere: {page}")
            elif heading and heading not in [line.lstrip("# ") for line in tree.lines(page)]:
                yield Finding(path, number, "doc-page", f"{page} has no heading: {heading}")


def readmes(tree):
    """Each top folder says what it is for, and so does each room of the server and the storage."""
    folders = {
        folder
        for folder in README_FOLDERS
        if any(path.startswith(folder + "/") for path in tree.files)
    }
    rooms = {posixpath.dirname(path) for path in tree.cxx}
    folders.update(room for room in rooms if room.startswith(ROOM_FOLDERS))
    for folder in sorted(folders):
        if not tree.has(f"{folder}/README.md"):
            yield Finding(f"{folder}/README.md", 1, "readme", "the folder has no README.md")


def _tests(tree):
    """Names of tests: suite and test in C++; file and function in Python."""
    names = set()
    for path in tree.files:
        if not path.startswith("tests/"):
            continue
        if path.endswith(".cc"):
            names.update(".".join(each) for each in TEST.findall(tree.text(path)))
        elif path.endswith(".py"):
            names.add(posixpath.basename(path))
            names.update(PYTHON_TEST.findall(tree.text(path)))
    return names


def named(tree):
    """The files and tests that the pages about the design name are there."""
    folders = {posixpath.dirname(path) for path in tree.files}
    tests = _tests(tree)
    for page in NAMING_PAGES:
        if not tree.has(page):
            continue
        for number, line in enumerate(tree.lines(page), 1):
            for name in QUOTED.findall(line):
                path = name.rstrip("/")
                if NAMED_PATH.fullmatch(name):
                    there = tree.has(path) or any(
                        each == path or each.startswith(path + "/") for each in folders
                    )
                elif NAMED_TEST.fullmatch(name) or NAMED_PYTHON.fullmatch(name):
                    there = name in tests
                else:
                    continue
                if not there:
                    yield Finding(page, number, "named", f"{name} is not there")
