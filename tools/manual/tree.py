"""What a program says of its flags (`--help-tree`), and how pages and shells show it."""

import dataclasses
import json
import re
import subprocess

NUMBERS = ("INT", "UINT", "FLOAT")
RANGE = re.compile(r"(?:INT|UINT|FLOAT) in \[(\S+) - (\S+)\]$")
CHOICES = re.compile(r"\{(.*)\}$")


@dataclasses.dataclass(frozen=True)
class Option:
    """A flag; with `position`, an argument that stands without a flag."""

    names: tuple
    position: str
    takes: str
    default: str
    required: bool
    several: bool
    excludes: tuple
    about: str

    @property
    def form(self):
        """The last part of what it takes: TEXT:HOST:PORT is HOST:PORT."""
        return self.takes.split(":", 1)[-1]

    @property
    def choices(self):
        found = CHOICES.match(self.form)
        return found.group(1).split(",") if found else []

    @property
    def bounds(self):
        found = RANGE.match(self.form)
        return found.groups() if found else None

    @property
    def value(self):
        """The word that stands for its value; empty: a switch."""
        if not self.takes:
            return ""
        if self.bounds or self.form in NUMBERS:
            return "NUMBER"
        if self.choices:
            return "WORD"
        if self.form == "TEXT":
            return self.names[-1].rsplit("-", 1)[-1].upper() if self.names else self.position.upper()
        return self.form


@dataclasses.dataclass(frozen=True)
class Command:
    """A program, a noun or a verb."""

    # The words that choose it: ("uplinkctl", "pki", "init").
    words: tuple
    about: str
    # What the help shows below the flags, such as examples.
    footer: str
    options: tuple
    positions: tuple
    # Of each group of flags, exactly one must be given.
    exactly_one_of: tuple
    commands: tuple

    @property
    def page(self):
        return "-".join(self.words)

    def leaves(self):
        """The commands below it that do something."""
        for command in self.commands:
            if command.commands:
                yield from command.leaves()
            else:
                yield command


def _option(node):
    fields = dict(node, names=tuple(node["names"]), excludes=tuple(node["excludes"]))
    return Option(**fields)


def command_of(node, before=()):
    words = (*before, node["name"])
    groups = tuple(
        tuple(_option(each) for each in group["options"] if "--help" not in each["names"])
        for group in node["exactlyOneOf"]
    )
    every = [_option(each) for each in node["options"]]
    every[1:1] = [option for group in groups for option in group]
    return Command(
        words,
        node["about"],
        node["footer"],
        tuple(option for option in every if not option.position),
        tuple(option for option in every if option.position),
        groups,
        tuple(command_of(each, words) for each in node["commands"]),
    )


def read(program):
    done = subprocess.run([program, "--help-tree"], check=True, capture_output=True, text=True)
    return command_of(json.loads(done.stdout))
