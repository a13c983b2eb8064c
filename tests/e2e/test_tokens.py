"""uplinkctl tokens: what it prints, and what it leaves in the file."""

import concurrent.futures
import csv
import datetime
import hashlib
import io
import json
import os
import stat
import subprocess
import unittest

from harness import BIN, EndToEnd, run, uplinkctl

NEW = ("tokens", "new", "--fleet", "north")


class Tokens(EndToEnd):
    def setUp(self):
        super().setUp()
        self.file = self.folder / "tokens"
        self.where = ("--tokens-file", self.file)

    def new(self, *arguments):
        return uplinkctl(*NEW, *self.where, *arguments).stdout.removesuffix("\n")

    def lines(self):
        return [json.loads(line) for line in self.file.read_text(encoding="utf-8").splitlines()]

    def test_a_token_is_printed_once_and_its_hash_is_kept(self):
        done = uplinkctl(*NEW, *self.where, "--role", "operator", "--fleet", "south", "--note", "ann's 'laptop' ü")
        token = done.stdout.removesuffix("\n")
        self.assertRegex(token, r"^uplinkd_[A-Za-z0-9_-]{43}$")
        self.assertNotIn(token[8:], done.stderr)
        self.assertIn("it is shown this once", done.stderr)
        (line,) = self.lines()
        digest = hashlib.sha256(token.encode()).hexdigest()
        created = datetime.datetime.fromisoformat(line.pop("created"))
        expires = datetime.datetime.fromisoformat(line.pop("expires"))
        self.assertEqual(expires - created, datetime.timedelta(days=90))
        self.assertEqual(line, {
            "id": digest[:8], "role": "operator", "fleets": ["north", "south"], "note": "ann's 'laptop' ü",
            "sha256": digest,
        })  # fmt: skip
        self.assertEqual(stat.S_IMODE(self.file.stat().st_mode), 0o640)

    def test_the_list_shows_no_hash_and_tells_what_has_expired(self):
        self.new("--role", "metrics", "--expires", "never")
        self.new("--expires", "90d", "--note", "x")
        past = {**self.lines()[1], "expires": "2020-01-01T00:00:00Z"}
        with self.file.open("r+", encoding="utf-8") as file:
            first = file.readline()
            file.seek(0)
            file.truncate()
            file.write(first + json.dumps(past) + "\n")
        text = uplinkctl("tokens", "list", *self.where, "-o", "json").stdout
        listed = json.loads(text)["tokens"]
        self.assertEqual([(each["role"], each["expires"], each["expired"]) for each in listed],
                         [("metrics", None, False), ("viewer", "2020-01-01T00:00:00Z", True)])  # fmt: skip
        table = uplinkctl("tokens", "list", *self.where).stdout
        for shown in (text, table):
            for line in self.lines():
                self.assertIn(line["id"], shown)
                self.assertNotIn(line["sha256"][9:], shown)
        self.assertRegex(table, r"metrics +north +never")
        rows = list(csv.DictReader(io.StringIO(uplinkctl("tokens", "list", *self.where, "-o", "csv").stdout)))
        self.assertEqual([row["note"] for row in rows], ["", "x"])

    def test_a_revoked_token_leaves_the_file(self):
        self.file.write_text("# ours\n", encoding="utf-8")
        self.file.chmod(0o600)
        self.new()
        uplinkctl(*NEW, *self.where, "--note", "stays")
        gone, stays = (json.loads(line) for line in self.file.read_text(encoding="utf-8").splitlines()[1:])
        uplinkctl("tokens", "revoke", *self.where, gone["id"])
        text = self.file.read_text(encoding="utf-8")
        self.assertEqual(text, "# ours\n" + json.dumps(stays, separators=(",", ":")) + "\n")
        self.assertEqual(stat.S_IMODE(self.file.stat().st_mode), 0o600)
        self.assertIn("there is no token", uplinkctl("tokens", "revoke", *self.where, gone["id"], code=1).stderr)
        self.assertEqual(self.file.read_text(encoding="utf-8"), text)

    def test_calls_at_once_lose_none(self):
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            tokens = list(pool.map(lambda _: self.new(), range(24)))
        self.assertEqual(
            {hashlib.sha256(token.encode()).hexdigest() for token in tokens},
            {line["sha256"] for line in self.lines()},
        )
        self.assertEqual(sorted(os.listdir(self.folder)), ["tokens"])

    def test_a_broken_file_stays_as_it_is(self):
        self.file.write_text("uplinkd_secret\n", encoding="utf-8")
        for verb in (NEW, ("tokens", "list"), ("tokens", "revoke", "00000000")):
            done = uplinkctl(*verb, *self.where, code=2)
            self.assertIn(f"{self.file}: line 1: is no JSON object of a token", done.stderr)
            self.assertNotIn("uplinkd_secret", done.stdout + done.stderr)
        self.assertEqual(self.file.read_text(encoding="utf-8"), "uplinkd_secret\n")

    def test_a_token_that_cannot_be_printed_is_named(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([BIN / "uplinkctl", *NEW, *self.where], stdout=full, stderr=subprocess.PIPE,
                                  text=True, timeout=60, check=False)  # fmt: skip
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"uplinkctl tokens revoke {self.lines()[0]['id']}", done.stderr)

    def test_the_configuration_names_the_file(self):
        config = self.folder / "uplinkd.toml"
        config.write_text(f'[http]\ntokens_file = "{self.file}"\n', encoding="utf-8")
        uplinkctl(*NEW, "--config", config)
        self.assertEqual(len(self.lines()), 1)
        config.write_text("", encoding="utf-8")
        done = uplinkctl("tokens", "list", "--config", config, code=2)
        self.assertIn("names no http.tokens_file; set that, or name the file by --tokens-file", done.stderr)

    def test_wrong_use_ends_with_2_and_makes_no_file(self):
        for arguments in (
            (), ("new",), ("new", "--fleet", "a", "--role", "robot"), ("new", "--fleet", "*", "--fleet", "a"),
            ("new", "--fleet", ""), ("new", "--fleet", "a", "--expires", "0"), ("revoke",),
        ):  # fmt: skip
            with self.subTest(arguments):
                run(BIN / "uplinkctl", "tokens", *arguments, *(self.where if arguments else ()), code=2)
                self.assertFalse(self.file.exists())


if __name__ == "__main__":
    unittest.main()
