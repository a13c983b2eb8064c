#include "tools/uplinkctl/verbs/list_verb.h"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/base/rfc3339.h"
#include "tests/unit/tools/uplinkctl/fake_api.h"
#include "tools/uplinkctl/verbs/follow.h"

namespace uplink::ctl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

const SystemTime kNow = *FromRfc3339("2026-05-01T12:30:00Z");

List Named(std::string_view noun, std::string_view verb = "list") {
  const std::vector<List> lists = Lists();
  return *std::ranges::find_if(
      lists, [&](const List& each) { return each.noun == noun && each.verb == verb; });
}

ListFlags FlagsFor(const List& list) {
  ListFlags flags;
  flags.limit = list.limit;
  flags.filters.resize(list.filters.size());
  return flags;
}

FilterValue& ValueOf(const List& list, ListFlags& flags, std::string_view flag) {
  const auto at = std::ranges::find(list.filters, flag, &Filter::flag);
  return flags.filters[static_cast<std::size_t>(at - list.filters.begin())];
}

TEST(Lists, EachHasAPathColumnsAndAnExample) {
  std::set<std::string> verbs;
  for (const List& list : Lists()) {
    const std::string name = std::string(list.noun) + " " + std::string(list.verb);
    EXPECT_TRUE(verbs.insert(name).second) << name;
    EXPECT_TRUE(list.path.starts_with("/api/v1/")) << name;
    EXPECT_FALSE(list.columns.empty()) << name;
    ASSERT_FALSE(list.examples.empty()) << name;
    for (const std::string_view example : list.examples) {
      EXPECT_TRUE(example.starts_with("uplinkctl " + name)) << example;
    }
  }
}

TEST(ListQuery, HasWhatTheFlagsSay) {
  const List list = Named("robots");
  ListFlags flags = FlagsFor(list);
  flags.fleet = "north";
  ValueOf(list, flags, "--battery-below").text = "20";
  ValueOf(list, flags, "--held-back").on = true;
  ValueOf(list, flags, "--offline-before").text = "1h";
  ValueOf(list, flags, "--certificate-expires-within").text = "14d";
  const auto query = QueryOf(list, flags, {}, kNow);
  ASSERT_TRUE(query.ok()) << query.status();
  EXPECT_THAT(*query, ElementsAre(Pair("parts", "none"), Pair("fleet", "north"),
                                  Pair("offlineBefore", "2026-05-01T11:30:00Z"),
                                  Pair("batteryBelow", "20"), Pair("heldBack", "true"),
                                  Pair("certificateExpiresBefore", "2026-05-15T12:30:00Z")));
}

TEST(ListQuery, FaultsAreThoseThatAreActiveUnlessTheHistoryIsWanted) {
  const List list = Named("faults");
  ListFlags flags = FlagsFor(list);
  EXPECT_THAT(*QueryOf(list, flags, {"rcan://a"}, kNow),
              ElementsAre(Pair("ruri", "rcan://a"), Pair("active", "true")));
  ValueOf(list, flags, "--history").on = true;
  flags.since = "2h";
  flags.until = "1h";
  flags.oldest = true;
  EXPECT_THAT(*QueryOf(list, flags, {}, kNow),
              ElementsAre(Pair("from", "2026-05-01T10:30:00Z"), Pair("to", "2026-05-01T11:30:00Z"),
                          Pair("orderBy", "oldest")));
}

TEST(ListQuery, ATimeThatCannotBeReadSaysHowToWriteIt) {
  const List list = Named("events");
  ListFlags flags = FlagsFor(list);
  flags.since = "yesterday";
  const absl::Status status = QueryOf(list, flags, {}, kNow).status();
  EXPECT_TRUE(absl::IsInvalidArgument(status));
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("--since yesterday: it is no time; write 2h"));
}

class ShowListTest : public ::testing::Test {
 protected:
  ShowListTest() { screen_.clock.SetSystem(kNow); }

  absl::Status Show(const List& list, const ListFlags& flags) {
    Api api = server_.MakeApi();
    return ShowList(list, flags, api, screen_.Make());
  }

  FakeServer server_;
  FakeScreen screen_;
};

std::string EventAt(const std::string& time, const std::string& kind) {
  return R"({"ruri":"rcan://a/b/c/1/r1","kind":")" + kind + R"(","receivedAt":")" + time + R"("})";
}

std::string Events(const std::string& rows, const std::string& token = "") {
  return R"({"events":[)" + rows + R"(],"nextPageToken":")" + token + R"("})";
}

TEST_F(ShowListTest, ATableHasAgesAndShortNames) {
  server_.Answer(200, Events(EventAt("2026-05-01T12:28:00Z", "estopEngaged"), "more"));
  ListFlags flags = FlagsFor(Named("events"));
  flags.limit = 1;
  ASSERT_TRUE(Show(Named("events"), flags).ok());
  EXPECT_EQ(screen_.printed,
            "TIME                  AGO    ROBOT  KIND          DETAIL\n"
            "2026-05-01 12:28:00Z  2 min  r1     estopEngaged\n");
  EXPECT_EQ(screen_.notes, "the first 1; --limit shows more\n");
}

TEST_F(ShowListTest, AShortNameIsNoOtherRobotsOfTheServer) {
  server_.Answer(200, Events(EventAt("2026-05-01T12:28:00Z", "estopEngaged")));
  server_.Answer(200, R"({"robots":[{"ruri":"rcan://a/b/c/1/r1"},{"ruri":"rcan://a/b/c/2/r1"}],)"
                      R"("nextPageToken":""})");
  ASSERT_TRUE(Show(Named("events"), FlagsFor(Named("events"))).ok());
  EXPECT_THAT(screen_.printed, HasSubstr(" 1/r1 "));
  EXPECT_EQ(server_.asked.at(1), "/api/v1/robots?parts=none&pageSize=1000");
}

TEST(NotEmpty, RefusesAnEmptyTextAlone) {
  EXPECT_THAT(NotEmpty().problem(""), HasSubstr("it is empty"));
  EXPECT_EQ(NotEmpty().problem(" "), "");
}

TEST_F(ShowListTest, NothingIsSaidApart) {
  server_.Answer(200, Events(""));
  ASSERT_TRUE(Show(Named("events"), FlagsFor(Named("events"))).ok());
  EXPECT_EQ(screen_.printed, "");
  EXPECT_EQ(screen_.notes, "nothing matches\n");
}

TEST_F(ShowListTest, JsonHasTheServersMembers) {
  server_.Answer(200, R"({"quarantined":[],"nextPageToken":"","droppedByReason":{"x":"1"}})");
  ListFlags flags = FlagsFor(Named("quarantine"));
  flags.common.output = kJsonWord;
  ASSERT_TRUE(Show(Named("quarantine"), flags).ok());
  EXPECT_EQ(boost::json::parse(screen_.printed),
            boost::json::parse(R"({"quarantined":[],"droppedByReason":{"x":"1"}})"));
}

TEST_F(ShowListTest, FollowAddsEachNewRowOnceAlsoOneThatCameLate) {
  const std::string first = EventAt("2026-05-01T12:29:00Z", "one");
  const std::string second = EventAt("2026-05-01T12:29:50Z", "two");
  const std::string late = EventAt("2026-05-01T12:29:45Z", "late");
  const std::string third = EventAt("2026-05-01T12:30:01Z", "three");
  server_.Answer(200, Events(second + "," + first));
  server_.Answer(200, Events(late + "," + second));
  server_.Answer(503, R"({"error":{"code":"UNAVAILABLE","message":"the store is away"}})");
  server_.Answer(200, Events(late + "," + second + "," + third));
  ListFlags flags = FlagsFor(Named("events"));
  flags.common.follow = true;
  flags.common.output = kCsvWord;
  flags.since = "1h";
  screen_.waits = 3;
  ASSERT_TRUE(Show(Named("events"), flags).ok());
  EXPECT_EQ(screen_.printed,
            "receivedAt,ruri,kind,detail\n"
            "2026-05-01T12:29:00Z,rcan://a/b/c/1/r1,one,\n"
            "2026-05-01T12:29:50Z,rcan://a/b/c/1/r1,two,\n"
            "2026-05-01T12:29:45Z,rcan://a/b/c/1/r1,late,\n"
            "2026-05-01T12:30:01Z,rcan://a/b/c/1/r1,three,\n");
  EXPECT_THAT(screen_.notes, HasSubstr("the store is away"));
  EXPECT_EQ(server_.asked.at(0), "/api/v1/events?from=2026-05-01T11%3A30%3A00Z&pageSize=100");
  EXPECT_EQ(server_.asked.at(1),
            "/api/v1/events?from=2026-05-01T12%3A29%3A40Z&orderBy=oldest&pageSize=1000");
}

TEST_F(ShowListTest, FollowGoesOnWhereOneLookDoesNotReachTheNewest) {
  server_.Answer(200, Events(EventAt("2026-05-01T12:29:00Z", "first")));
  // Ten pages of one second, and further ones.
  std::string full;
  for (std::size_t i = 0; i < kPageRowsMax; ++i) {
    full += (i == 0 ? "" : ",") + EventAt("2026-05-01T12:29:01Z", "k" + std::to_string(i));
  }
  for (std::size_t page = 0; page < kFollowRowsMax / kPageRowsMax; ++page) {
    server_.Answer(200, Events(full, "more"));
  }
  server_.Answer(200, Events(EventAt("2026-05-01T12:29:01Z", "k7") + "," +
                             EventAt("2026-05-01T12:29:02Z", "after")));
  ListFlags flags = FlagsFor(Named("events"));
  flags.common.follow = true;
  flags.common.output = kCsvWord;
  screen_.waits = 2;
  ASSERT_TRUE(Show(Named("events"), flags).ok());
  EXPECT_THAT(server_.asked.back(), HasSubstr("from=2026-05-01T12%3A29%3A01Z&"));
  EXPECT_TRUE(screen_.printed.ends_with("2026-05-01T12:29:02Z,rcan://a/b/c/1/r1,after,\n"));
}

TEST_F(ShowListTest, FollowShowsAListThatDoesNotGrowAgain) {
  const std::string one = R"({"ruri":"rcan://a/b/c/1/r1","faultId":"f","severity":"major"})";
  server_.Answer(200, R"({"faults":[)" + one + R"(],"nextPageToken":""})");
  server_.Answer(200, R"({"faults":[],"nextPageToken":""})");
  server_.Answer(200, R"({"faults":[)" + one + R"(],"nextPageToken":""})");
  ListFlags flags = FlagsFor(Named("faults"));
  flags.common.follow = true;
  flags.common.output = kJsonWord;
  screen_.waits = 2;
  ASSERT_TRUE(Show(Named("faults"), flags).ok());
  EXPECT_EQ(screen_.printed, R"({"faults":[)" + one + "]}\n\n" + R"({"faults":[]})" + "\n\n" +
                                 R"({"faults":[)" + one + "]}\n");
}

TEST_F(ShowListTest, AnErrorAtTheFirstLookEndsIt) {
  server_.Answer(503, R"({"error":{"code":"UNAVAILABLE","message":"the store is away"}})");
  ListFlags flags = FlagsFor(Named("events"));
  flags.common.follow = true;
  screen_.waits = 1;
  EXPECT_TRUE(absl::IsUnavailable(Show(Named("events"), flags)));
}

TEST_F(ShowListTest, AStoryResolvesItsRobot) {
  server_.Answer(200, R"({"robots":[{"ruri":"rcan://a/b/c/1/r1"}],"nextPageToken":""})");
  server_.Answer(200, R"({"entries":[],"nextPageToken":""})");
  ListFlags flags = FlagsFor(Named("robots", "story"));
  flags.robot = "r1";
  ASSERT_TRUE(Show(Named("robots", "story"), flags).ok());
  EXPECT_EQ(server_.asked.at(1),
            "/api/v1/robot/story?ruri=rcan%3A%2F%2Fa%2Fb%2Fc%2F1%2Fr1&pageSize=100");
}

}  // namespace
}  // namespace uplink::ctl
