"""Each rule on made-up trees: shown to pass and to fail."""

import pathlib
import tempfile
import unittest

import includes
import text
import whole
from tree import Tree


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
        files = {"server/a.cc": self.lines(300), "tests/a.cc": self.lines(500)}
        self.assert_clean(text.length, files, {})

    def test_refuses_files_past_it(self):
        files = {"server/a.cc": self.lines(301), "tests/a.cc": self.lines(501)}
        self.assertEqual(len(self.find(text.length, files, {})), 2)

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

    def test_takes_names_of_what_is_there(self):
        page = "`server/a.cc` `server/` `AckTest.Holds` `test_x.py` (`test_it`) `Ack::Next` `ack`\n"
        files = {
            whole.ARCHITECTURE: page,
            "server/a.cc": "",
            "tests/a_test.cc": "TEST_F(AckTest, Holds) {}\n",
            "tests/e2e/test_x.py": "class X:\n    def test_it(self):\n",
        }
        self.assert_clean(whole.named, files)

    def test_refuses_names_of_what_is_gone(self):
        page = "`server/b.cc`\n`server/c/`\n`AckTest.Gone`\n`test_y.py`\n`test_gone`\n"
        files = {whole.ARCHITECTURE: page, "server/a.cc": "", "tests/a_test.cc": "TEST(A, B) {}\n"}
        found = self.find(whole.named, files)
        self.assertEqual(found, [(whole.ARCHITECTURE, line, "named") for line in range(1, 6)])

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


class WholeTest(unittest.TestCase):
    def test_every_rule_of_the_program_is_tested_here(self):
        import tidy

        tested = pathlib.Path(__file__).read_text(encoding="utf-8")
        for rule in tidy.RULES:
            name = f"{rule.__module__}.{rule.__name__}"
            self.assertIn(name, tested)


if __name__ == "__main__":
    unittest.main()
