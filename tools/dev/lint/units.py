"""The translation units of the compile database: what each reads, and its key."""

import hashlib
import json
import os
import re
import shlex

INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]+[<"]([^>"]+)[>"]', re.MULTILINE)
BUILD = "build" + os.sep
WORD = re.compile(rb"\w+")


class File:
    """One file of ours, read once: its digest, the names it includes and the words in it."""

    def __init__(self, data):
        self.digest = hashlib.sha256(data).hexdigest()
        self.includes = [name.decode(errors="replace") for name in INCLUDE.findall(data)]
        self.words = frozenset(WORD.findall(data))


class Tree:
    """The include graph of what lies below `root`, the generated headers in its build included."""

    def __init__(self, root):
        self.root = root
        self.files = {}

    def file(self, path):
        if path not in self.files:
            with open(os.path.join(self.root, path), "rb") as stream:
                self.files[path] = File(stream.read())
        return self.files[path]

    def reach(self, path, folders):
        """What `path` reads with `folders` to search: files of ours or made of them, and what our
        files include of made and foreign headers."""
        ours, foreign, todo = set(), set(), [path]
        while todo:
            each = todo.pop()
            if each in ours:
                continue
            ours.add(each)
            for name in self.file(each).includes:
                found = self.find(name, (os.path.dirname(each), *folders))
                if found is not None:
                    todo.append(found)
                if (found is None or found.startswith(BUILD)) and not each.startswith(BUILD):
                    foreign.add(name)
        return sorted(ours), foreign

    def find(self, name, folders):
        for folder in folders:
            path = os.path.normpath(os.path.join(folder, name))
            if path in self.files or os.path.isfile(os.path.join(self.root, path)):
                return path
        return None


class Unit:
    """A file and the flags it is compiled with."""

    def __init__(self, tree, path, command):
        self.path = path
        self.defines, self.systems, self.others, search = split(command)
        folders = [os.path.relpath(each, tree.root) for each in search + self.systems]
        folders = [each for each in folders if not each.startswith("..")]
        self.files, self.foreign = tree.reach(path, folders)
        self.words = frozenset().union(*(tree.file(each).words for each in self.files))
        # A define of ours that nothing in here mentions makes no difference: the simulation's
        # mutants compile most files as they are.
        self.defines = [
            each
            for each in self.defines
            if not name_of(each).startswith("UPLINK") or name_of(each).encode() in self.words
        ]

    def flags(self):
        """The unit's own flags; where the tree lies is in them."""
        systems = [word for each in self.systems for word in ("-isystem", each)]
        return [*self.others, *(f"-D{each}" for each in self.defines), *systems]

    def key(self, tree, context):
        """The digest of all that findings depend on: equal wherever the tree lies."""
        digest = hashlib.sha256(context)
        for flag in self.flags():
            digest.update(flag.replace(tree.root, ".").encode() + b"\0")
        for each in self.files:
            digest.update(f"{each} {tree.file(each).digest}\n".encode())
        return digest.hexdigest()


def name_of(define):
    return define.split("=", 1)[0]


def split(command):
    """(defines, folders of -isystem, other flags, folders of -I) of a compiler's command line."""
    words = iter(shlex.split(command)[1:])
    defines, systems, others, search = [], [], [], []
    for word in words:
        if word in ("-o", "-c"):
            next(words)
        elif word == "-isystem":
            systems.append(next(words))
        elif word.startswith("-D"):
            defines.append(word[2:])
        elif not word.startswith("-ffile-prefix-map="):
            others.append(word)
            if word.startswith("-I"):
                search.append(word[2:])
    return defines, systems, others, search


def read_units(tree, database):
    """The units of a compile database, each once, without those of generated sources."""
    with open(database, encoding="utf-8") as stream:
        entries = json.load(stream)
    units = {}
    for entry in entries:
        path = os.path.relpath(os.path.join(entry["directory"], entry["file"]), tree.root)
        if not path.startswith(("..", BUILD)):
            unit = Unit(tree, path, entry["command"])
            units[(path, *unit.flags())] = unit
    return list(units.values())
