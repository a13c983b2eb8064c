"""The manual pages and the completion of shells that the build made from the programs' help."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from harness import BIN, SOURCE, run

sys.path.insert(0, str(SOURCE / "tools/manual"))

import completion  # noqa: E402
import program_pages  # noqa: E402
import roff  # noqa: E402
import settings_page  # noqa: E402
import tree  # noqa: E402

MANUAL = BIN.parent / "manual"
FLAG = re.compile(r"--[a-z][a-z-]*")
PROGRAMS = {"uplinkd": 8, "uplinkctl": 1, "uplink-fleet": 1}


def page_text(name, section):
    """A page as a reader sees it, each run of blanks as one."""
    path = MANUAL / f"man/man{section}/{name}.{section}"
    environment = {"PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8", "MANWIDTH": "500"}
    text = run("man", "-P", "cat", "-l", path, env=environment).stdout
    return " ".join(text.replace("\u2010", "-").split())


def completed(program, *words):
    """What bash offers in place of the last word."""
    script = (
        'source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
        f'_{program.replace("-", "_")}; printf "%s\\n" "${{COMPREPLY[@]}}"'
    )
    path = MANUAL / f"bash-completion/completions/{program}"
    return run("bash", "-c", script, path, program, *words).stdout.split()


def specifications(path, *functions):
    """What the functions of a zsh script hand to _arguments."""
    script = '_arguments() { print -rl -- "$@"; return 1 }; source "$0" >/dev/null; for each; do "$each"; done'
    done = subprocess.run(["zsh", "-f", "-c", script, path, *functions], capture_output=True, text=True, check=False)
    return done.stderr, done.stdout.splitlines()


class Manual(unittest.TestCase):
    def test_man_warns_of_nothing(self):
        pages = sorted(MANUAL.glob("man/man*/*"))
        self.assertGreater(len(pages), len(PROGRAMS) + 1)
        for page in pages:
            with self.subTest(page.name):
                done = subprocess.run(
                    ["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", page],
                    env={"PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8", "MANROFFSEQ": "", "MANWIDTH": "80"},
                    stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=True,
                )  # fmt: skip
                self.assertEqual(done.stderr, "")

    def test_each_command_has_a_page_with_the_flags_of_its_help(self):
        for name, section in PROGRAMS.items():
            program = tree.read(BIN / name)
            for command in (program, *program.leaves()):
                with self.subTest(command.page):
                    text = page_text(command.page, section if command is program else 1)
                    shown = run(BIN / name, *command.words[1:], "--help").stdout
                    self.assertLessEqual(set(FLAG.findall(shown)), set(FLAG.findall(text)))
                    self.assertIn("EXIT STATUS 0", text)

    def test_each_verb_of_uplinkctl_has_an_example(self):
        program = tree.read(BIN / "uplinkctl")
        for command in program.leaves():
            head, *examples = command.footer.strip("\n").split("\n")
            self.assertEqual(head, "Examples:", command.page)
            for example in examples:
                self.assertTrue(example.strip().startswith(" ".join(command.words)), example)

    def test_the_page_of_the_settings_has_every_key_with_its_default(self):
        text = page_text("uplinkd.toml", 5)
        table = (SOURCE / "docs/operate/configuration.md").read_text(encoding="utf-8")
        rows = re.findall(r"^\| `([a-z0-9_.]+)` \| `(.*?)` \|", table, re.MULTILINE)
        self.assertGreater(len(rows), 50)
        for key, default in rows:
            self.assertIn(f"{key} = {default}", text)

    def test_what_the_help_shows_below_the_flags_keeps_its_lines(self):
        command = tree.command_of({"name": "p", "about": "A", "footer": "Examples:\n  p --one\n  .p", "options": [],
                                   "exactlyOneOf": [], "commands": []})  # fmt: skip
        page = program_pages.verb_page(command, lambda name, section: roff.Page(name, section, "1", ""))
        self.assertEqual(page.lines[-6:], [".SH EXAMPLES", ".PP", ".nf", "p \\-\\-one", "\\&.p", ".fi"])

    def test_a_name_in_capitals_keeps_them(self):
        for text, first in (("TLS of it; more", "TLS of it"), ("Show it.", "show it"), ("A server", "a server")):
            self.assertEqual(program_pages.first_lower(text), first)

    def test_an_example_file_that_is_not_understood_is_an_error(self):
        head = "# Opening.\n\n[listen]\n"
        ends = ("# a = 1\n\n# Text without a key.\n", "# a = 1\n# B = 2\n")
        for text in ("", head, *(head + end for end in ends), "# a = 1\n" + head):
            with self.assertRaises(ValueError):
                settings_page.settings_page(text, "1.0.0", "")

    def test_a_key_may_have_digits_and_dots(self):
        page = settings_page.settings_page("# Opening.\n\n[mqtt]\n# What it is.\n# v5.tls_1 = 2\n", "1.0.0", "")
        self.assertIn("mqtt.v5.tls_1", "\n".join(page.lines).replace("\\", ""))


class Completion(unittest.TestCase):
    def test_bash_offers_commands_flags_and_words(self):
        self.assertIn("store", completed("uplinkctl", "st"))
        self.assertNotIn("pki", completed("uplinkctl", "st"))
        self.assertIn("forget", completed("uplinkctl", "store", ""))
        self.assertEqual(completed("uplinkctl", "pki", "robot", "--fl"), ["--fleet"])
        self.assertEqual(completed("uplink-fleet", "--robots", "5", "--report", ""), ["text", "json"])
        self.assertEqual(completed("uplinkd", "--check"), ["--check-config"])

    def test_bash_leaves_a_value_to_the_completion_of_files(self):
        self.assertEqual(completed("uplinkctl", "pki", "init", "--dir", ""), [])

    def test_zsh_reads_the_same(self):
        for name in PROGRAMS:
            run("zsh", "-n", MANUAL / f"zsh/vendor-completions/_{name}")
        for function, argument in (("_uplinkctl_config_check", "1:FILE:_files"), ("_uplinkctl_store_forget", "1:ruri: ")):
            errors, found = specifications(MANUAL / "zsh/vendor-completions/_uplinkctl", function)
            self.assertEqual(errors, "")
            self.assertIn(argument, found)
            self.assertTrue(any(each.startswith("--help[") for each in found), found)

    def test_zsh_numbers_arguments(self):
        option = {"names": [], "takes": "TEXT", "default": "", "required": True, "several": False, "excludes": [], "about": "A"}
        program = tree.command_of({"name": "p", "about": "A", "footer": "", "exactlyOneOf": [], "commands": [],
                                   "options": [{**option, "position": each} for each in ("DIR", "ruri", "it's")]})  # fmt: skip
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "_p")
            path.write_text(completion.zsh(program), encoding="utf-8")
            self.assertEqual(specifications(path, "_p"), ("", ["-C", "1:DIR:_files", "2:ruri: ", "3:it's: "]))


if __name__ == "__main__":
    unittest.main()
