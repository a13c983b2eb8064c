"""What the rules look at: the files of a tree, and C++ code without its comments and strings."""

import dataclasses
import functools
import os
import pathlib
import re
import subprocess

SOURCE_FOLDERS = ("schema", "metrics", "storage", "server", "tools", "tests")


@dataclasses.dataclass(frozen=True, order=True)
class Finding:
    path: str
    line: int
    rule: str
    text: str

    def __str__(self):
        return f"{self.path}:{self.line}: [{self.rule}] {self.text}"


@dataclasses.dataclass(frozen=True)
class Include:
    line: int
    name: str
    quoted: bool


INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]+([<"])([^>"]+)[>"]')
# Longest first: raw strings, comments, strings, character literals (a quote between digits parts
# them and opens nothing).
NOT_CODE = re.compile(
    r'R"(?P<mark>[^()\\\s]{0,16})\(.*?\)(?P=mark)"'
    r"|//[^\n]*|/\*.*?\*/"
    r'|"(?:\\.|[^"\\\n])*"'
    r"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])+'",
    re.DOTALL,
)


def blank(match):
    """The match as blanks, so that lines and columns stay."""
    return re.sub(r"[^\n]", " ", match.group())


class Tree:
    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.files = sorted(self._list())

    def _list(self):
        if (self.root / ".git").exists():
            # Whoever runs this trusts the tree, so its owner does not matter.
            command = ["git", "-c", "safe.directory=*", "ls-files", "-z"]
            command += ["--cached", "--others", "--exclude-standard"]
            listed = subprocess.run(command, cwd=self.root, check=True, capture_output=True).stdout
            names = set(filter(None, listed.decode().split("\0")))
            return [name for name in names if (self.root / name).is_file()]
        found = []
        for folder, folders, names in os.walk(self.root):
            folders[:] = [each for each in folders if each not in ("build", ".git", "__pycache__")]
            found += [
                (pathlib.Path(folder) / name).relative_to(self.root).as_posix() for name in names
            ]
        return found

    def has(self, path):
        return path in self._set

    @functools.cached_property
    def _set(self):
        return frozenset(self.files)

    @functools.cached_property
    def cxx(self):
        return [path for path in self.files if path.endswith((".h", ".cc"))]

    @functools.lru_cache(maxsize=None)
    def text(self, path):
        return (self.root / path).read_text(encoding="utf-8", errors="replace")

    @functools.lru_cache(maxsize=None)
    def lines(self, path):
        return self.text(path).splitlines()

    @functools.lru_cache(maxsize=None)
    def code(self, path):
        """The lines of a C++ file with comments and literals blanked."""
        return NOT_CODE.sub(blank, self.text(path)).splitlines()

    @functools.lru_cache(maxsize=None)
    def includes(self, path):
        found = []
        for number, line in enumerate(self.lines(path), 1):
            match = INCLUDE.match(line)
            if match:
                found.append(Include(number, match.group(2), match.group(1) == '"'))
        return found
