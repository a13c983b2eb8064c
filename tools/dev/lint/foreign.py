"""One precompiled header of the foreign headers that many units share."""

import collections
import os
import subprocess
import sys

UNITS_MIN = 3  # a header that fewer units reach is cheaper where it is

# Off, because C++20's modules, which we do not use, make clang-tidy read each header twice.
COMMON = ("-Xclang", "-fno-cxx-modules")


class Precompiled:
    """The header and the flags that go with it: the foreign part of every unit's flags together.

    A define is foreign if no file of ours mentions it: libraries export such to what links them.
    """

    def __init__(self, units):
        words = frozenset().union(*(each.words for each in units))
        self.others = collections.Counter(tuple(each.others) for each in units).most_common(1)[0][0]
        if any("-pthread" in each.others for each in units):
            self.others = (*[each for each in self.others if each != "-pthread"], "-pthread")
        self.own = lambda define: define.split("=", 1)[0].encode() in words
        suited = [each for each in units if self.suits(each)]
        self.defines = ordered(d for each in suited for d in each.defines if not self.own(d))
        self.systems = ordered(s for each in suited for s in each.systems)
        reached = collections.Counter(name for each in suited for name in each.foreign)
        self.headers = [f"<{each}>" for each, count in sorted(reached.items()) if count >= UNITS_MIN]
        self.path = None

    def suits(self, unit):
        return set(unit.others) <= set(self.others)

    def shared_flags(self):
        systems = [word for each in self.systems for word in ("-isystem", each)]
        return [*self.others, *(f"-D{each}" for each in self.defines), *systems]

    def make(self, folder):
        """Builds it. Where it cannot be built, units read their headers themselves."""
        header, path = os.path.join(folder, "foreign.h"), os.path.join(folder, "foreign.pch")
        with open(header, "w", encoding="utf-8") as stream:
            stream.writelines(f"#include {each}\n" for each in self.headers)
        command = ["clang++-14", *self.shared_flags(), *COMMON]
        # What the headers instantiate is then instantiated once, not once per unit.
        command += ["-Xclang", "-fpch-instantiate-templates", "-x", "c++-header", header, "-o", path]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            self.path = path
        else:
            print(f"lint: no precompiled header, so slower: {done.stderr[:2000]}", file=sys.stderr)

    def flags(self, unit):
        """The flags to read `unit` with."""
        if self.path is None or not self.suits(unit):
            return [*unit.flags(), *COMMON]
        own = [f"-D{each}" for each in unit.defines if self.own(each)]
        return [*self.shared_flags(), *own, *COMMON, "-include-pch", self.path]


def ordered(items):
    return list(dict.fromkeys(items))
