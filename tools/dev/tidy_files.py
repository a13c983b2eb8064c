#!/usr/bin/env python3
"""Lists what clang-tidy has to read: pairs of hash and file, each ended by NUL.

The hash covers the file, every header of ours that it reaches, its compile command and the checks,
so a pass stays good exactly as long as none of them changes.
"""

import argparse
import hashlib
import json
import os
import pathlib
import re
import sys

INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]+([<"])([^>"]+)[>"]', re.MULTILINE)
GRPC = re.compile(rb"^grpc|\.grpc\.pb\.h$")


class Tree:
    """The include graph of our own files, read once each."""

    def __init__(self, root):
        self.root = root
        self.cache = {}

    def read(self, path):
        if path not in self.cache:
            data = (self.root / path).read_bytes()
            ours, grpc = [], False
            for _, name in INCLUDE.findall(data):
                grpc = grpc or bool(GRPC.search(name))
                text = name.decode(errors="replace")
                if (self.root / text).is_file():
                    ours.append(text)
            self.cache[path] = (hashlib.sha256(data).hexdigest(), ours, grpc)
        return self.cache[path]

    def reach(self, path):
        """All files of ours that `path` includes, itself among them, and whether gRPC is there."""
        seen, todo, grpc = set(), [path], False
        while todo:
            each = todo.pop()
            if each in seen:
                continue
            seen.add(each)
            _, ours, holds = self.read(each)
            grpc = grpc or holds
            todo.extend(ours)
        return sorted(seen), grpc


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--database", type=pathlib.Path, required=True)
    parser.add_argument("--passed", type=pathlib.Path, required=True)
    parser.add_argument("--all", action="store_true")
    arguments = parser.parse_args()

    root = pathlib.Path.cwd()
    tree = Tree(root)
    checks = (root / ".clang-tidy").read_bytes()
    left_out = 0
    for entry in json.loads(arguments.database.read_text()):
        path = os.path.relpath(os.path.join(entry["directory"], entry["file"]), root)
        if path.startswith(("..", "build" + os.sep)):
            continue
        files, grpc = tree.reach(path)
        if grpc and not arguments.all:
            left_out += 1
            continue
        digest = hashlib.sha256(checks + entry["command"].encode())
        for each in files:
            digest.update(f"{each} {tree.read(each)[0]}\n".encode())
        if not (arguments.passed / digest.hexdigest()).exists():
            sys.stdout.write(f"{digest.hexdigest()}\0{path}\0")
    if left_out:
        print(f"lint: {left_out} files that hold gRPC are left to ./dev lint --all", file=sys.stderr)


if __name__ == "__main__":
    main()
