"""Each rule on made-up trees: shown to pass and to fail."""

import pathlib
import sys
import tempfile
import unittest

import alerts
import includes
import prose
import questions
import text
import whole
from tree import Tree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools/dev"))

import reference  # noqa: E402


class RuleTest(unittest.TestCase):
    def find(self, rule, files, *arguments):
        """The findings of `rule` in a tree of `files`, as (path, line, rule) triples."""
        with tempfile.TemporaryDirectory() as folder:
            for name, content in files.items():
                path = pathlib.Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(content, encoding="utf-8")
            found = list(rule(Tree(folder), *arguments))
        return [(each.path, each.line, each.rule) for each in found]

    def assert_clean(self, rule, files, *arguments):
        self.assertEqual(self.find(rule, files, *arguments), [])


class DirectionTest(RuleTest):
    ORDER = ("schema", "metrics", "storage", "server", "tools", "tests")

    def test_takes_every_include_toward_the_schema(self):
        for at, folder in enumerate(self.ORDER):
            for target in self.ORDER[: at + 1]:
                source = f'#include "{target}/x.h"\n'
                self.assert_clean(includes.direction, {f"{folder}/a.cc": source})

    def test_refuses_every_include_away_from_it(self):
        for at, folder in enumerate(self.ORDER):
            for target in self.ORDER[at + 1 :]:
                source = f'\n#include "{target}/x.h"\n'
                found = self.find(includes.direction, {f"{folder}/a.cc": source})
                self.assertEqual(found, [(f"{folder}/a.cc", 2, "include-direction")])


class ForeignTest(RuleTest):
    CASES = (
        ("<grpcpp/grpcpp.h>", "tests/a.cc", "server/front/a.cc"),
        ("<grpc/grpc.h>", "tools/a.cc", "server/http/a.cc"),
        ('"uplink/v1/relay.grpc.pb.h"', "tools/a.h", "server/view/a.h"),
        ('"uplink/v1/relay.pb.h"', "server/session/a.h", "server/fleet/a.h"),
        ("<google/protobuf/message.h>", "server/view/a.cc", "storage/a.cc"),
        ("<nghttp2/nghttp2.h>", "tools/link/a.cc", "server/session/a.cc"),
        ("<sqlite3.h>", "storage/sqlite/a.cc", "storage/a.cc"),
        ("<libpq-fe.h>", "storage/postgres/a.cc", "server/journal/a.cc"),
        ("<capnp/message.h>", "schema/decode.cc", "server/session/a.cc"),
        ("<kj/exception.h>", "schema/decode.cc", "tools/a.cc"),
        ('"schema/uplink.capnp.h"', "schema/decode.cc", "server/view/a.cc"),
        ("<boost/beast/core.hpp>", "server/http/a.cc", "server/loop/a.cc"),
        ("<boost/asio.hpp>", "server/loop/a.cc", "server/run/app.cc"),
        ("<boost/json.hpp>", "schema/json/a.cc", "storage/sqlite/a.cc"),
        ("<toml++/toml.h>", "server/config/load.cc", "server/run/app.cc"),
        ("<mosquitto.h>", "tools/uplink-fleet/broker/a.cc", "server/mqtt/a.cc"),
        ("<CLI/CLI.hpp>", "server/config/flags.cc", "server/main.cc"),
        ("<prometheus/counter.h>", "metrics/registry.cc", "server/session/a.cc"),
    )

    def test_takes_a_library_in_its_own_folder(self):
        for header, good, _ in self.CASES:
            with self.subTest(header):
                self.assert_clean(includes.foreign, {good: f"#include {header}\n"})

    def test_refuses_it_elsewhere(self):
        for header, _, bad in self.CASES:
            with self.subTest(header):
                found = self.find(includes.foreign, {bad: f"#include {header}\n"})
                self.assertEqual(found, [(bad, 1, "foreign-header")])

    def test_every_library_has_a_case(self):
        for library in includes.FOREIGN:
            headers = (header.strip('<>"') for header, _, _ in self.CASES)
            self.assertTrue(any(library.pattern.search(each) for each in headers), library.name)


class RoomsTest(RuleTest):
    ORDER = (("log",), ("robot",), ("session", "view"), ("front", "http"), ("store",))
    ROOMS = [room for here in ORDER for room in here]
    ALL = {f"server/{room}/x.h": "" for room in ROOMS}

    def find_include(self, path, target):
        files = {**self.ALL, path: f'\n#include "server/{target}/x.h"\n'}
        return self.find(includes.rooms, files, self.ORDER)

    def test_takes_includes_of_the_steps_before(self):
        for step, here in enumerate(self.ORDER):
            for room in here:
                for target in [room, *(each for before in self.ORDER[:step] for each in before)]:
                    self.assertEqual(self.find_include(f"server/{room}/a.cc", target), [])

    def test_refuses_those_of_the_same_step_and_after(self):
        for step, here in enumerate(self.ORDER):
            for room in here:
                for target in (each for after in self.ORDER[step:] for each in after):
                    if target != room:
                        found = self.find_include(f"server/{room}/a.cc", target)
                        self.assertEqual(found, [(f"server/{room}/a.cc", 2, "room-order")])

    def test_the_root_and_tests_see_every_room(self):
        for path in ("server/root.cc", "server/main.cc", "tests/e2e/a.cc"):
            for target in self.ROOMS:
                self.assertEqual(self.find_include(path, target), [])

    def test_refuses_an_adapter_outside_the_server(self):
        for target in includes.ADAPTERS:
            found = self.find_include("tools/a.cc", target)
            self.assertEqual(found, [("tools/a.cc", 2, "room-order")])
        self.assertEqual(self.find_include("tools/a.cc", "log"), [])

    def test_refuses_what_joins_the_rooms_in_a_room(self):
        files = {**self.ALL, "server/log/a.cc": '\n#include "server/root.h"\n'}
        found = self.find(includes.rooms, files, self.ORDER)
        self.assertEqual(found, [("server/log/a.cc", 2, "room-order")])

    def test_refuses_a_room_that_the_list_lacks(self):
        files = {**self.ALL, "server/attic/a.h": ""}
        found = self.find(includes.rooms, files, self.ORDER)
        self.assertEqual(found, [("server/attic/a.h", 1, "room")])

    def test_refuses_a_room_that_the_tree_lacks(self):
        files = {path: "" for path in self.ALL if path != "server/view/x.h"}
        found = self.find(includes.rooms, files, self.ORDER)
        self.assertEqual(found, [("tests/tidy/includes.py", 1, "room")])

    def test_a_room_stands_in_the_list_once(self):
        rooms = [room for here in includes.ROOMS for room in here]
        self.assertEqual(len(rooms), len(set(rooms)))
        self.assertLessEqual(set(includes.ADAPTERS), set(rooms))


class FleetRoomsTest(RuleTest):
    HOUSE = "tools/uplink-fleet"
    ORDER = [room for here in includes.FLEET_ROOMS for room in here]

    def all_rooms(self):
        return {f"{self.HOUSE}/{room}/x.h": "" for room in self.ORDER}

    def find_include(self, path, target):
        files = {**self.all_rooms(), path: f'\n#include "{self.HOUSE}/{target}/x.h"\n'}
        return self.find(includes.fleet_rooms, files)

    def test_takes_includes_of_the_rooms_before(self):
        for step, room in enumerate(self.ORDER):
            for target in self.ORDER[: step + 1]:
                self.assertEqual(self.find_include(f"{self.HOUSE}/{room}/a.cc", target), [])

    def test_refuses_those_of_the_rooms_after(self):
        for step, room in enumerate(self.ORDER):
            for target in self.ORDER[step + 1 :]:
                found = self.find_include(f"{self.HOUSE}/{room}/a.cc", target)
                self.assertEqual(found, [(f"{self.HOUSE}/{room}/a.cc", 2, "room-order")])

    def test_a_folder_in_a_room_keeps_the_rooms_order(self):
        path = f"{self.HOUSE}/robot/behaviour/a.h"
        self.assertEqual(self.find_include(path, "scenario"), [])
        self.assertEqual(self.find_include(path, "run"), [(path, 2, "room-order")])

    def test_the_root_tests_and_other_tools_see_every_room(self):
        for path in (f"{self.HOUSE}/main.cc", "tests/unit/a.cc", "tools/uplinkctl/a.cc"):
            for target in self.ORDER:
                self.assertEqual(self.find_include(path, target), [])

    def test_refuses_a_room_that_the_list_or_the_tree_lacks(self):
        files = {**self.all_rooms(), f"{self.HOUSE}/attic/a.h": ""}
        found = self.find(includes.fleet_rooms, files)
        self.assertEqual(found, [(f"{self.HOUSE}/attic/a.h", 1, "room")])
        del files[f"{self.HOUSE}/attic/a.h"], files[f"{self.HOUSE}/report/x.h"]
        found = self.find(includes.fleet_rooms, files)
        self.assertEqual(found, [("tests/tidy/includes.py", 1, "room")])


class FrontRoomsTest(RuleTest):
    STEP_OF = {room: step for step, here in enumerate(includes.FRONT_ROOMS) for room in here}

    def test_a_room_sees_itself_and_the_steps_before(self):
        for room, step in self.STEP_OF.items():
            for target, before in self.STEP_OF.items():
                path = f"server/front/{room}/a.cc"
                files = {f"server/front/{each}/x.h": "" for each in self.STEP_OF}
                files[path] = f'\n#include "server/front/{target}/x.h"\n'
                sees = target == room or before < step
                with self.subTest(f"{room} includes {target}"):
                    found = self.find(includes.front_rooms, files)
                    self.assertEqual(found, [] if sees else [(path, 2, "room-order")])

    def test_the_files_beside_the_rooms_see_them_and_are_not_seen(self):
        files = {f"server/front/{each}/x.h": "" for each in self.STEP_OF}
        for room in self.STEP_OF:
            beside = {**files, "server/front/worker.cc": f'#include "server/front/{room}/x.h"\n'}
            self.assert_clean(includes.front_rooms, beside)
            path = f"server/front/{room}/a.cc"
            found = self.find(includes.front_rooms, {**files, path: '#include "server/front/worker.h"\n'})
            self.assertEqual(found, [(path, 1, "room-order")])


class FormTest(RuleTest):
    GOOD = {
        "schema/a.h": "#pragma once\n",
        "schema/a.cc": '#include "schema/a.h"\n#include <vector>\n#include "uplink/v1/x.pb.h"\n',
        "proto/uplink/v1/x.proto": "",
    }

    def with_a(self, source):
        return {**self.GOOD, "schema/a.cc": source}

    def test_takes_the_form(self):
        self.assert_clean(includes.form, self.GOOD)

    def test_refuses_a_path_that_does_not_start_at_the_top(self):
        found = self.find(includes.form, self.with_a('#include "schema/a.h"\n#include "a.h"\n'))
        self.assertEqual(found, [("schema/a.cc", 2, "include-form")])

    def test_refuses_a_header_that_nothing_generates(self):
        source = '#include "schema/a.h"\n#include "uplink/v1/y.pb.h"\n#include "schema/z.capnp.h"\n'
        found = self.find(includes.form, self.with_a(source))
        self.assertEqual([line for _, line, _ in found], [2, 3])

    def test_refuses_our_header_in_angle_brackets(self):
        source = '#include "schema/a.h"\n#include <schema/a.h>\n'
        self.assertEqual(
            self.find(includes.form, self.with_a(source)), [("schema/a.cc", 2, "include-form")]
        )

    def test_refuses_another_header_before_its_own(self):
        source = '#include <vector>\n#include "schema/a.h"\n'
        self.assertEqual(
            self.find(includes.form, self.with_a(source)), [("schema/a.cc", 1, "own-header-first")]
        )

    def test_refuses_a_header_that_may_be_read_twice(self):
        files = {**self.GOOD, "schema/a.h": "#ifndef A_H\n#define A_H\n#endif\n"}
        self.assertEqual(self.find(includes.form, files), [("schema/a.h", 1, "pragma-once")])


class LengthTest(RuleTest):
    @staticmethod
    def lines(count):
        return "int a;\n" * count

    def test_takes_files_at_the_limit(self):
        files = {"server/a.cc": self.lines(300), "tools/a.py": self.lines(300), "tests/a.py": self.lines(500)}
        self.assert_clean(text.length, files, {})

    def test_refuses_files_past_it(self):
        files = {"server/a.cc": self.lines(301), "tools/a.py": self.lines(301), "tests/a.py": self.lines(501)}
        self.assertEqual(len(self.find(text.length, files, {})), 3)

    def test_takes_a_listed_file_up_to_its_own_limit(self):
        long_files = {"server/a.cc": (320, "a table")}
        self.assert_clean(text.length, {"server/a.cc": self.lines(320)}, long_files)
        self.assertEqual(
            len(self.find(text.length, {"server/a.cc": self.lines(321)}, long_files)), 1
        )

    def test_refuses_an_entry_that_is_no_longer_needed(self):
        long_files = {"server/a.cc": (320, "a table"), "server/gone.cc": (320, "a table")}
        found = self.find(text.length, {"server/a.cc": self.lines(300)}, long_files)
        self.assertEqual([path for path, _, _ in found], ["server/a.cc", "server/gone.cc"])


class BannedTest(RuleTest):
    CASES = (
        ("std::this_thread::sleep_for(x);", "tools/a.cc", "tests/a.cc"),
        ("::usleep(5);", "tools/a.cc", "server/a.cc"),
        ("sleep (1);", "tools/a.cc", "tests/a.cc"),
        ("auto t = std::chrono::steady_clock::now();", "schema/base/clock.cc", "tests/a.cc"),
        ("auto t = system_clock::now();", "schema/base/clock.cc", "tools/a.cc"),
        ("auto t = time(nullptr);", "schema/base/clock.cc", "server/a.cc"),
        ('std::getenv("HOME");', "server/config/environment.cc", "server/run/app.cc"),
        ("std::cout << 1;", "server/main.cc", "server/run/app.cc"),
        ("std::cerr << 1;", "tools/a.cc", "storage/a.cc"),
        ('printf("x");', "tools/a.cc", "server/front/a.cc"),
        ("throw 1;", None, "server/a.cc"),
        ("thread.detach();", None, "tools/a.cc"),
        ("int a = rand();", None, "tools/a.cc"),
        ("GTEST_SKIP();", None, "tests/a.cc"),
        ("for (const auto& each : *sorted_.Get()) {", None, "server/a.cc"),
        ("for (const auto& row : store.Rows({})->rows) {", None, "tests/a.cc"),
        ("for (const auto& row : store.Rows({}).value().rows) {", None, "tests/a.cc"),
    )

    def test_refuses_the_call_where_it_is_banned(self):
        for line, _, bad in self.CASES:
            with self.subTest(line):
                found = self.find(text.banned, {bad: f"\n{line}\n"})
                self.assertEqual(found, [(bad, 2, "banned-call")])

    def test_takes_it_where_it_belongs(self):
        for line, good, _ in self.CASES:
            if good:
                with self.subTest(line):
                    self.assert_clean(text.banned, {good: f"{line}\n"})

    def test_every_ban_has_a_case(self):
        for call in text.BANNED:
            self.assertTrue(any(call.pattern.search(line) for line, _, _ in self.CASES))

    def test_takes_comments_strings_and_longer_names(self):
        for line in (
            "// sleep_for(x)",
            "/* throw\n std::cout */",
            'Log("throw sleep(1)");',
            'Log(R"(throw "x" rand())");',
            "std::snprintf(b, 1, f); fprintf(stderr, f);",
            "int asleep(int); rethrow();",
            "const int big = 1'000'000; char c = '\"'; int d = 2'0;",
        ):
            self.assert_clean(text.banned, {"server/a.cc": line + "\n"})

    def test_sees_the_code_after_a_comment_or_a_literal(self):
        for line in ("/* a */ throw 1;", 'Log("\\""); throw 1;', "n = 1'000; throw 1;", "c = '\"'; throw 1;"):
            self.assertEqual(len(self.find(text.banned, {"server/a.cc": line + "\n"})), 1, line)

    def test_a_nolint_names_check_and_reason(self):
        good = "int a;  // NOLINT(bugprone-x): the API asks for it\n"
        self.assert_clean(text.banned, {"server/a.cc": good})
        for bad in ("// NOLINT", "// NOLINTNEXTLINE", "// NOLINT(bugprone-x)", "// NOLINT: because"):
            self.assertEqual(
                self.find(text.banned, {"server/a.cc": bad + "\n"}), [("server/a.cc", 1, "nolint")]
            )


class WordsTest(RuleTest):
    def test_takes_ordinary_text(self):
        files = {
            "docs/a.md": "An issue of trust. See /var/lib/uplinkd, $HOME/work/ and build/work/x.\n",
            "server/a.cc": "// TODO(perf): batch it\n",
            "dev": "cd /tmp/x\n",
        }
        self.assert_clean(text.words, files)

    def test_refuses_what_does_not_belong(self):
        for line in ("FIXME", "TODO: later", "TODO(me): x", "see issue 3", "Issue #12",
                     "cd /work/main", '"/home/me/x"', "(/root/x)"):  # fmt: skip
            for path in ("server/a.cc", "docs/a.md", "tools/dev/a.sh", "dev"):
                self.assertEqual(self.find(text.words, {path: line + "\n"}), [(path, 1, "word")], line)

    def test_leaves_files_alone_that_are_not_text(self):
        self.assert_clean(text.words, {"tests/fuzz/corpus/a.bin": "FIXME\n"})


class ProseTest(RuleTest):
    PLAIN = (
        "The writer wakes the stream; otherwise slow strangers would fill it. It does nothing else.",
        "Is it somebody else? Somewhere else; `nobody` is a quoted name, [here](nobody.md).",
        "Simple words, shallow waters and thoughts are allowed.",
    )
    AVOIDED = (
        "whoever sends", "for whomever", "Nobody sends.", "send what of it is due", "what is of it that counts",
        "robots of which two are late", "as far as it goes", "would gather there else.", "it waits else; so",
        "it is to be sent", "they are to be sent", "lines not told of elsewhere", "for want of room",
        "is nothing but a file", "in order to send", "it ought to", "it shall", "lest it fall", "thereof",
        "whilst it runs", "utilizes memory", "Simply send",
    )  # fmt: skip

    def test_takes_plain_words(self):
        for path in ("docs/a.md", "server/log/README.md", "CHANGELOG.md"):
            self.assert_clean(prose.avoided, {path: "\n".join(self.PLAIN) + "\n"})

    def test_refuses_each_word_in_pages_and_in_code(self):
        for phrase in self.AVOIDED:
            for path, before in (("docs/a.md", ""), ("server/log/README.md", ""), ("CHANGELOG.md", ""),
                                 ("server/a.h", "/// "), ("tools/dev/a.sh", "# "), ("proto/a.proto", "// "),
                                 ("deploy/a.toml", "# "), ("tests/e2e/a.py", "# "),
                                 ("server/CMakeLists.txt", "# ")):  # fmt: skip
                with self.subTest(phrase, path=path):
                    found = self.find(prose.avoided, {path: f"\n{before}{phrase}\n"})
                    self.assertEqual(found, [(path, 2, "prose")])

    def test_every_word_has_a_case(self):
        for pattern, _ in prose.PATTERNS:
            self.assertTrue(any(pattern.search(each) for each in self.AVOIDED), pattern.pattern)

    def test_looks_at_the_comments_and_texts_of_cpp_alone(self):
        self.assert_clean(prose.avoided, {"server/a.cc": "int nobody;  // none\nint whilst;\n"})
        for source in ("// It waits whilst it runs.", 'Log("whilst");', "/* a\n whilst */"):
            found = self.find(prose.avoided, {"server/a.cc": f"int a;\n\n{source}\n"})
            line = 3 + source.count("\n")
            self.assertEqual(found, [("server/a.cc", line, "prose")])

    def test_finds_a_phrase_that_goes_on_in_the_next_line(self):
        for path, lines in (("docs/a.md", "robots of\nwhich two"), ("server/a.h", "/// robots of\n/// which two"),
                            ("a.sh", "# robots of\n  # which two"), ("a.py", "robots of\n    which two")):  # fmt: skip
            self.assertEqual(self.find(prose.avoided, {path: f"{lines}\n"}), [(path, 1, "prose")])
        self.assert_clean(prose.avoided, {"docs/a.md": "robots it knows of\n\nwhich two?\n"})

    def test_leaves_alone_what_is_listed_or_quoted(self):
        files = {path if path.endswith(".md") else f"{path}0001_a.sql": "-- nobody\n" for path in prose.EXEMPT}
        files["docs/a.md"] = "```\n# whoever\n```\n"
        self.assert_clean(prose.avoided, files)
        found = self.find(prose.avoided, {"docs/operate/configuration.md": "| `a.b` | Nobody sees them. |\n"})
        self.assertEqual(found, [("docs/operate/configuration.md", 1, "prose")])


class AlertsTest(RuleTest):
    PATH = "deploy/prometheus/alerts.rules.yml"

    def rules(self, summary, description):
        return {
            self.PATH: "groups:\n      - alert: A\n"
            f'          summary: "{summary}"\n          description: "{description}"\n'
        }

    def test_takes_texts_within_their_words(self):
        place = "{{ $value | printf `%.0f` }}"
        self.assert_clean(alerts.short, self.rules(place + " a" * 10, "a " * 39))
        self.assert_clean(alerts.short, {"deploy/a.yml": 'summary: "' + "a " * 99 + '"\n'})

    def test_refuses_a_word_more(self):
        found = self.find(alerts.short, self.rules("a " * 12, "a"))
        self.assertEqual(found, [(self.PATH, 3, "alert-text")])
        found = self.find(alerts.short, self.rules("a", "a " * 40))
        self.assertEqual(found, [(self.PATH, 4, "alert-text")])

    def test_refuses_an_alert_without_a_text(self):
        found = self.find(alerts.short, {self.PATH: '      - alert: A\n          summary: "a"\n'})
        self.assertEqual(found, [(self.PATH, 1, "alert-text")])


class BuiltTest(RuleTest):
    GOOD = {
        "CMakeLists.txt": "add_subdirectory(server)\n",
        "server/CMakeLists.txt": "lib(a.cc\n  sub/b.cc) # c.cc\n",
        "server/a.cc": '#include "server/a.h"\n',
        "server/a.h": "",
        "server/sub/b.cc": "",
    }

    def test_takes_a_tree_that_is_all_built(self):
        self.assert_clean(whole.built, self.GOOD)

    def test_refuses_a_source_that_no_list_names(self):
        for name in ("server/c.cc", "server/sub/a.cc"):
            found = self.find(whole.built, {**self.GOOD, name: ""})
            self.assertEqual(found, [(name, 1, "not-built")])

    def test_refuses_a_header_that_nothing_includes(self):
        found = self.find(whole.built, {**self.GOOD, "server/x.h": ""})
        self.assertEqual(found, [("server/x.h", 1, "not-built")])

    def test_refuses_a_list_that_nothing_enters(self):
        found = self.find(whole.built, {**self.GOOD, "server/sub/CMakeLists.txt": ""})
        self.assertEqual(found, [("server/sub/CMakeLists.txt", 1, "not-built")])


class TargetsTest(RuleTest):
    def test_takes_what_is_named_after_its_room(self):
        files = {
            "server/http/CMakeLists.txt": "uplink_library(\n  uplink_http\n)\nuplink_library(uplink_http_site)\n",
            "server/CMakeLists.txt": "uplink_library(uplink_app)\n",
            "schema/json/CMakeLists.txt": "uplink_library(uplink_text)\n",
        }
        self.assert_clean(whole.targets, files)

    def test_refuses_the_name_of_another_room(self):
        files = {"server/session/CMakeLists.txt": "uplink_library(\n  uplink_robot_sessions\n)\n"}
        found = self.find(whole.targets, files)
        self.assertEqual(found, [("server/session/CMakeLists.txt", 1, "target")])


class SettingsTest(RuleTest):
    TABLE = '{.section = "log", .key = "level"},\n{.section = "log",\n .key = "format"},\n'
    EXAMPLE = '# [none] of this = prose\n[log]\n# level = "info"\nformat = "text"\n'

    def files(self, table, example):
        return {whole.SETTINGS: table, whole.EXAMPLE: example}

    def test_takes_equal_lists(self):
        self.assert_clean(whole.settings, self.files(self.TABLE, self.EXAMPLE))

    def test_takes_the_two_keys_of_a_rate(self):
        table = self.TABLE + '    UPLINK_RATE(shape, "shape"),\n'
        example = self.EXAMPLE + "[rates]\n# shape = 50\n"
        self.assert_clean(whole.settings, self.files(table, example + "# shape_burst = 2000\n"))
        found = self.find(whole.settings, self.files(table, example))
        self.assertEqual(found, [(whole.SETTINGS, 4, "settings")])

    def test_refuses_a_setting_that_the_example_lacks(self):
        found = self.find(whole.settings, self.files(self.TABLE, '[log]\n# level = "info"\n'))
        self.assertEqual(found, [(whole.SETTINGS, 2, "settings")])

    def test_knows_keys_with_digits_and_dots(self):
        table = self.TABLE + '{.section = "mqtt5",\n .key = "v5.tls_1"},\n'
        self.assert_clean(whole.settings, self.files(table, self.EXAMPLE + "[mqtt5]\n# v5.tls_1 = 2\n"))
        self.assertEqual(self.find(whole.settings, self.files(table, self.EXAMPLE)), [(whole.SETTINGS, 4, "settings")])

    def test_wants_no_example_of_a_setting_without_effect(self):
        table = self.TABLE + '{.section = "log",\n .key = "later",\n .effect = Effect::kNone},\n'
        self.assert_clean(whole.settings, self.files(table, self.EXAMPLE))
        found = self.find(whole.settings, self.files(table, self.EXAMPLE + "# later = 1\n"))
        self.assertEqual(found, [(whole.EXAMPLE, 5, "settings")])

    def test_refuses_a_key_that_is_no_setting(self):
        found = self.find(whole.settings, self.files(self.TABLE, self.EXAMPLE + "# more = 1\n"))
        self.assertEqual(found, [(whole.EXAMPLE, 5, "settings")])

    def test_refuses_a_missing_file_and_an_unreadable_table(self):
        self.assertEqual(len(self.find(whole.settings, {whole.SETTINGS: self.TABLE})), 1)
        self.assertEqual(len(self.find(whole.settings, {whole.EXAMPLE: self.EXAMPLE})), 1)
        self.assertEqual(len(self.find(whole.settings, self.files("nothing", ""))), 1)


class DocumentsTest(RuleTest):
    def test_takes_links_that_lead_somewhere(self):
        page = "[a](b.md) [c](../server/) [d](https://x.y/z) [e](#here) [f](b.md#part)\n"
        files = {"docs/a.md": page, "docs/b.md": "", "server/x.h": ""}
        self.assert_clean(whole.links, files)

    def test_refuses_links_that_lead_nowhere(self):
        files = {"docs/a.md": "\n[a](c.md)\n[b](../nowhere/)\n"}
        found = self.find(whole.links, files)
        self.assertEqual(found, [("docs/a.md", 2, "link"), ("docs/a.md", 3, "link")])

    def test_takes_pages_and_headings_that_messages_name(self):
        files = {"docs/a.md": "# A\n## It fills\n", "server/a.cc": 'DocPage("docs/a.md") DocPage("docs/a.md",\n "It fills")\n'}
        self.assert_clean(whole.doc_pages, files)
        files["docs/a.md"] = "# A\n"
        self.assertEqual(self.find(whole.doc_pages, files), [("server/a.cc", 1, "doc-page")])
        del files["docs/a.md"]
        self.assertEqual(len(self.find(whole.doc_pages, files)), 2)

    def test_takes_names_of_what_is_there(self):
        page = "`server/a.cc` `server/` `AckTest.Holds` `test_x.py` (`test_it`) `Ack::Next` `ack`\n"
        files = {
            "server/a.cc": "",
            "tests/a_test.cc": "TEST_F(AckTest, Holds) {}\n",
            "tests/e2e/test_x.py": "class X:\n    def test_it(self):\n",
        }
        for name in whole.NAMING_PAGES:
            self.assert_clean(whole.named, {**files, name: page})

    def test_refuses_names_of_what_is_gone(self):
        page = "`server/b.cc`\n`server/c/`\n`AckTest.Gone`\n`test_y.py`\n`test_gone`\n"
        files = {"server/a.cc": "", "tests/a_test.cc": "TEST(A, B) {}\n"}
        for name in whole.NAMING_PAGES:
            found = self.find(whole.named, {**files, name: page})
            self.assertEqual(found, [(name, line, "named") for line in range(1, 6)])

    def test_asks_each_top_folder_for_its_readme(self):
        self.assert_clean(whole.readmes, {"server/a.cc": "", "server/README.md": ""})
        found = self.find(whole.readmes, {"server/a.cc": ""})
        self.assertEqual(found, [("server/README.md", 1, "readme")])

    def test_asks_each_room_of_server_and_storage_for_its_readme(self):
        readmes = {f"{folder}/README.md": "" for folder in ("server", "tools", "server/http")}
        self.assert_clean(whole.readmes, {"server/http/a.cc": "", "tools/pki/a.cc": "", **readmes})
        files = {"server/http/a.cc": "", "server/README.md": ""}
        self.assertEqual(
            self.find(whole.readmes, files), [("server/http/README.md", 1, "readme")]
        )


class ReferenceTest(RuleTest):
    PAGES = {page.path.removeprefix(reference.FOLDER): page for page in reference.PAGES}
    LOG = """void F() {
  logger_.Warn("store_fails", {{"why", Text("a, b")}, {"n", g(1, 2)}});  // logger_.Warn("no", {});
  logger_.Write(slow ? log::Level::kInfo : log::Level::kWarn, bad ? "left" : "kept", {});
}
"""
    LOG_ROWS = (
        "| `kept` | info, warn |  | store | K. |",
        "| `left` | info, warn |  | store | L. |",
        "| `store_fails` | warn | `why` `n` | store | S. |",
    )
    READINESS = """readiness.refuses.emplace_back("starting");
constexpr auto kWords = std::to_array<DegradedWord>({
    {"store", [](const Facts& facts) { return facts.store_failing; }},
    {"clock", Expires},
});
"""
    DEGRADED_ROWS = (
        "| `starting` | refuses | A. | B. |",
        "| `store` | degraded | A. | B. |",
        "| `clock` | degraded | A. | B. |",
    )
    TURNED_AWAY = 'constexpr std::array<std::string_view, 2> kTurnedAwayTexts = {"full",\n"key"};\n'

    def pages(self, name, rows, code):
        """The findings of one page with these rows, as (line, text)."""
        page = self.PAGES[name]
        header = reference.line_of(page.columns)
        ruler = reference.line_of("---" for _ in page.columns)
        table = "\n".join(("# A", "", header, ruler, *rows, "", "B"))
        with tempfile.TemporaryDirectory() as folder:
            for path, content in {page.path: table + "\n", **code}.items():
                path = pathlib.Path(folder, path)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(content, encoding="utf-8")
            return [(each.line, each.text) for each in reference.pages(Tree(folder), (page,))]

    def log(self, rows, text=LOG):
        return self.pages("log-events.md", rows, {"server/store/a.cc": text})

    def degraded(self, rows):
        return self.pages("degraded.md", rows, {reference.READINESS: self.READINESS})

    def test_takes_pages_that_say_what_the_code_says(self):
        self.assertEqual(self.log(self.LOG_ROWS), [])
        self.assertEqual(self.degraded(self.DEGRADED_ROWS), [])

    def test_refuses_a_word_too_few(self):
        for rows, find in ((self.LOG_ROWS, self.log), (self.DEGRADED_ROWS, self.degraded)):
            for left_out in rows:
                found = find([row for row in rows if row != left_out])
                self.assertEqual(found[0][0], 3)
                self.assertIn(reference.cells_of(left_out)[0] + ": write its", found[0][1])

    def test_refuses_a_word_too_many(self):
        for rows, find in ((self.LOG_ROWS, self.log), (self.DEGRADED_ROWS, self.degraded)):
            gone = rows[0].replace(reference.cells_of(rows[0])[0], "`gone`")
            self.assertEqual(find((gone, *rows)), [(5, "`gone` is not in the code any more")])

    def test_refuses_a_row_without_its_sentence(self):
        rows = (self.LOG_ROWS[0].replace("K.", ""), *self.LOG_ROWS[1:])
        self.assertEqual(self.log(rows), [(5, "`kept`: write its 'means'")])

    def test_refuses_another_level_key_room_or_order(self):
        for was, then in ((" warn | `why`", " error | `why`"), (" `n`", ""), ("| store |", "| run |")):
            rows = [row.replace(was, then) for row in self.LOG_ROWS]
            self.assertEqual(len(self.log(rows)), 1, then)
        self.assertEqual(len(self.log(self.LOG_ROWS[::-1])), 1)
        self.assertEqual(len(self.degraded(self.DEGRADED_ROWS[::-1])), 1)

    def test_refuses_a_log_line_whose_event_it_does_not_know(self):
        for call in ("logger_.Warn(event, {});", 'logger_->Write(level, "a", {});',
                     'logger_.Warn("store_fails", {{key, "a"}});'):  # fmt: skip
            found = self.log(self.LOG_ROWS, self.LOG + f"void G() {{\n  {call}\n}}\n")
            self.assertEqual([line for line, _ in found], [1], call)
            self.assertIn("G logs", found[0][1])

    def test_finds_events_behind_a_function(self):
        code = {
            "server/front/door/debug_lines.cc":
                'void DebugLines::TellStream(std::string_view event) const {\n'
                '  logger_->Debug(event, {{"stream", stream}});\n}\n',
            "server/front/door/debug_lines.h": '  if (On()) TellStream("stream_opened", stream);\n',
        }  # fmt: skip
        row = "| `stream_opened` | debug | `stream` | front | O. |"
        self.assertEqual(self.pages("log-events.md", (row,), code), [])

    def test_reads_causes_reasons_and_exit_codes(self):
        rows = ("| `full` | A. | B. |", "| `key` | A. | B. |")
        code = {reference.TURNED_AWAY: self.TURNED_AWAY}
        self.assertEqual(self.pages("causes.md", rows, code), [])
        reasons = {
            reference.REASONS: "enum class RejectReason {\n  kNotFinite = 9,\n};\n",
            reference.REASON_TEXTS: 'case RejectReason::kNotFinite:\n  return "not_finite";\n',
            reference.CONTRACT: "REJECT_REASON_UNSPECIFIED = 0;\nREJECT_REASON_NOT_FINITE = 9;\n",
        }
        row = "| `NOT_FINITE` | `not_finite` | 9 | A. |  |"
        self.assertEqual(self.pages("rejects.md", (row,), reasons), [])
        reasons[reference.CONTRACT] += "REJECT_REASON_ODD = 10;\n"
        self.assertEqual(len(self.pages("rejects.md", (row,), reasons)), 1)
        exits = {path: "constexpr int kExitDone = 0;\n" for _, path in reference.EXITS}
        rows = [f"| `{program}` | 0 | A. |" for program, _ in reference.EXITS]
        self.assertEqual(self.pages("exit-codes.md", rows, exits), [])

    def test_refuses_a_missing_page_table_or_source(self):
        self.assertEqual(self.find(reference.pages, {}), [
            (page.path, 1, "reference") for page in reference.PAGES
        ])  # fmt: skip
        page = self.PAGES["causes.md"]
        files = {page.path: "# A\n", reference.TURNED_AWAY: self.TURNED_AWAY}
        found = self.find(reference.pages, files, (page,))
        self.assertEqual(found, [(page.path, 1, "reference")])
        self.assertEqual(len(self.pages("causes.md", (), {})), 1)
        self.assertEqual(len(self.pages("causes.md", (), {reference.TURNED_AWAY: "nothing"})), 1)


class QuestionsTest(RuleTest):
    LEAST = {"operator": 1, "agent": 1}
    HEAD = "who\tquestion\tpage\tanchor\tquote\n"
    AGENT = "agent\tWhen?\tdocs/c.md\tits-title\t| now | `go` |\n"
    GOOD = {
        "docs/README.md": "[b](b.md)\n",
        "docs/b.md": "# B\n[c](c.md#x)\n## What is `b`, now?\nIt is b. It is.\n### More\nMore.\n## Next\nIt is next.\n",
        "docs/c.md": "# Its title\n```\n# no heading\n```\n| now | `go` |\n[d](d.md)\n",
        "docs/d.md": "# D\nIt is d.\n",
    }

    def ask(self, page, anchor, quote):
        row = f"operator\tWhy?\t{page}\t{anchor}\t{quote}\n"
        files = {**self.GOOD, questions.QUESTIONS: self.HEAD + self.AGENT + row}
        return self.find(questions.answered, files, self.LEAST)

    def test_takes_a_quote_under_its_anchor(self):
        for quote in ("It is b.", "More."):
            self.assertEqual(self.ask("docs/b.md", "what-is-b-now", quote), [])
        self.assertEqual(self.ask("docs/b.md", "b", "It is next."), [])

    def test_refuses_another_page_anchor_or_quote(self):
        bad = [(questions.QUESTIONS, 3, "question")]
        for answer in (
            ("docs/b.md", "what-is-b-now", "It is next."),
            ("docs/b.md", "what-is-b-now", "It is B."),
            ("docs/b.md", "what-is-b-now", ""),
            ("docs/b.md", "what-is-it", "It is b."),
            ("docs/c.md", "no-heading", "| now | `go` |"),
            ("docs/gone.md", "b", "It is b."),
        ):
            with self.subTest(answer):
                self.assertEqual(self.ask(*answer), bad)

    def test_refuses_a_page_three_links_away(self):
        self.assertEqual(self.ask("docs/d.md", "d", "It is d."), [(questions.QUESTIONS, 3, "question")])

    def test_refuses_a_long_quote(self):
        for length, found in ((questions.QUOTE_MAX, 0), (questions.QUOTE_MAX + 1, 1)):
            quote = "x" * length
            files = {**self.GOOD, "docs/c.md": self.GOOD["docs/c.md"] + quote + "\n"}
            row = f"operator\tWhy?\tdocs/c.md\tits-title\t{quote}\n"
            files[questions.QUESTIONS] = self.HEAD + self.AGENT + row
            self.assertEqual(len(self.find(questions.answered, files, self.LEAST)), found)

    def test_refuses_a_list_of_another_form_or_too_short(self):
        for text in (
            "who\tquestion\n" + self.AGENT + self.AGENT.replace("agent", "operator").replace("When", "Why"),
            self.HEAD + self.AGENT,
            self.HEAD + self.AGENT + self.AGENT.replace("agent", "operator"),
            self.HEAD + self.AGENT + self.AGENT.replace("agent", "operator").replace("When", "Why") + "nobody\n",
        ):
            found = self.find(questions.answered, {**self.GOOD, questions.QUESTIONS: text}, self.LEAST)
            self.assertEqual(len(found), 1, text)
        self.assertEqual(len(self.find(questions.answered, self.GOOD, self.LEAST)), 1)


class WholeTest(unittest.TestCase):
    def test_every_rule_of_the_program_is_tested(self):
        import tidy

        here = pathlib.Path(__file__)
        tested = "".join(path.read_text(encoding="utf-8") for path in (here, here.with_name("test_deployed.py")))
        for rule in tidy.RULES:
            name = f"{rule.__module__}.{rule.__name__}"
            self.assertIn(name, tested)


if __name__ == "__main__":
    unittest.main()
