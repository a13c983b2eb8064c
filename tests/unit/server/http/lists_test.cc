#include <string>
#include <tuple>
#include <vector>

#include <boost/json.hpp>
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/base/rfc3339.h"
#include "server/http/site.h"
#include "tests/support/exact_json.h"
#include "tests/support/server_world.h"

// The lists of the site: their parameters, and walks through pages.
namespace uplink::http {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kA = "rcan%3A%2F%2Fa";

class ListsTest : public ::testing::Test {
 protected:
  Response Get(const std::string& target) { return world_.Get(target); }
  boost::json::object Body(const std::string& target) {
    const Response answer = Get(target);
    EXPECT_EQ(answer.status, 200) << target << answer.body;
    return test::ParseExact(answer.body).value_or(boost::json::object());
  }
  /// The text that a JSON pointer names in each row of the answer's one list.
  std::vector<std::string> Texts(const std::string& target, const std::string& pointer) {
    std::vector<std::string> texts;
    for (const auto& [name, member] : Body(target)) {
      if (!member.is_array()) continue;
      for (const auto& row : member.get_array()) {
        texts.emplace_back(row.at_pointer(pointer).as_string().c_str());
      }
    }
    return texts;
  }
  std::string Token(const std::string& target) {
    return Body(target).at("nextPageToken").as_string().c_str();
  }

  /// Two robots of two fleets, a millisecond a message: a's at 1 and 2, b's at 3.
  void SayThings() {
    start_ms_ = UnixMs(world_.clock.System());
    world_.AddRobot("rcan://a", "north");
    world_.AddRobot("rcan://b", "south");
    Say("rcan://a", "one");
    Say("rcan://a", "two");
    Say("rcan://b", "three");
  }
  void Say(const std::string& ruri, const std::string& text) {
    world_.clock.Advance(milliseconds(1));
    world_.CommitBody(ruri, model::Message{1, model::MessageLevel::kInfo, text});
    world_.CommitBody(ruri, model::EventTelemetry{1, model::MissionStartedEvent{text}});
    world_.CommitPresence(ruri, model::Presence::kOnline);
    model::MissionRunStatus report;
    report.mission_id = "m-" + text;
    report.run_id = "r-" + text;
    report.status =
        text == "one" ? model::MissionStatus::kComplete : model::MissionStatus::kRunning;
    world_.CommitBody(ruri, report);
    model::ReportedShape shape;
    shape.identity.id = text;
    shape.data = model::GeoPoint2{8, 47};
    if (text == "one") shape.expire_time_ms = start_ms_ + 2;
    world_.CommitBody(ruri, model::ShapeOp{shape});
    model::Object object;
    object.id = text;
    if (text == "one") object.expires_unix_time_ms = start_ms_ + 2;
    world_.CommitBody(ruri, model::ObjectOp{object});
  }
  /// A time as answers show it and parameters take it.
  [[nodiscard]] std::string At(int offset) const { return Rfc3339(FromUnixMs(start_ms_ + offset)); }

  testing::ServerWorld world_;
  std::int64_t start_ms_ = 0;
};

TEST_F(ListsTest, HistoriesAreNewestFirstAndWithinTheTimesThatAreAsked) {
  SayThings();
  for (const auto& [list, name] :
       {std::pair{"events", "/detail/missionId"}, std::pair{"messages", "/message"}}) {
    const std::string path = fmt::format("/api/v1/{}?ruri={}", list, kA);
    EXPECT_THAT(Texts(path, name), ElementsAre("two", "one"));
    EXPECT_THAT(Texts(path + "&from=" + At(2), name), ElementsAre("two"));
    EXPECT_THAT(Texts(path + "&to=" + At(1), name), ElementsAre("one"));
    EXPECT_THAT(Texts(path + "&from=" + At(3), name), IsEmpty());
    EXPECT_THAT(Texts(path + "&orderBy=oldest", name), ElementsAre("one", "two"));
    EXPECT_THAT(Texts(path + "&orderBy=newest", name), ElementsAre("two", "one"));
    EXPECT_THAT(Texts(path + "&ruri=rcan%3A%2F%2Fb", name), ElementsAre("three", "two", "one"));
    EXPECT_THAT(Texts(fmt::format("/api/v1/{}?fleet=south", list), name), ElementsAre("three"));
  }
  const std::string presence = "/api/v1/presence?ruri=" + kA;
  EXPECT_THAT(Texts(presence, "/at"), ElementsAre(At(2), At(1)));
  EXPECT_THAT(Texts(presence + "&from=" + At(1) + "&to=" + At(1), "/at"), ElementsAre(At(1)));
}

TEST_F(ListsTest, EachListHasFiltersOfItsOwn) {
  SayThings();
  world_.CommitBody("rcan://b", model::Message{1, model::MessageLevel::kError, "hot"});
  world_.CommitBody("rcan://b", model::EventTelemetry{1, model::EstopEngagedEvent{}});
  world_.CommitFault("rcan://a", {.unix_time_ms = 1,
                                  .fault_id = "1",
                                  .source = "arm",
                                  .severity = model::FaultSeverity::kCritical,
                                  .active = true});
  world_.CommitFault("rcan://b", {.unix_time_ms = 1, .fault_id = "2", .source = "bms"});
  world_.CommitQuarantine("rcan://a", {model::RejectReason::kMalformed, "", ""}, "bytes");
  world_.CommitQuarantine("rcan://b", {model::RejectReason::kOutOfRange, "x", ""}, "bytes");
  for (const auto& [query, pointer, found] :
       {std::tuple{"messages?level=error", "/message", "hot"},
        std::tuple{"events?kind=estopEngaged", "/ruri", "rcan://b"},
        std::tuple{"faults?severity=critical", "/faultId", "1"},
        std::tuple{"faults?severity=critical&active=true", "/faultId", "1"},
        std::tuple{"faults?faultId=2", "/source", "bms"},
        std::tuple{"faults?source=arm", "/faultId", "1"},
        std::tuple{"missions?status=complete", "/runId", "r-one"},
        std::tuple{"mission-reports?status=complete", "/runId", "r-one"},
        std::tuple{"mission-reports?missionId=m-two", "/report/runId", "r-two"},
        std::tuple{"mission-reports?runId=r-three", "/ruri", "rcan://b"},
        std::tuple{"quarantine?reason=out_of_range", "/ruri", "rcan://b"}}) {
    EXPECT_THAT(Texts(fmt::format("/api/v1/{}", query), pointer), ElementsAre(found)) << query;
  }
  EXPECT_THAT(Texts("/api/v1/messages?level=info&fleet=north", "/message"),
              ElementsAre("two", "one"));
}

TEST_F(ListsTest, ConnectionsAreFiltered) {
  SayThings();
  const auto connect = [this](std::uint8_t id, const std::string& ruri,
                              std::optional<model::ConnectionEnd> why) {
    storage::ConnectionItem item;
    item.robot = world_.fleet.Find(ruri)->id();
    item.id = {id};
    item.began_at = world_.clock.System();
    item.address = std::to_string(id);
    if (id == 3) item.source = model::MessageSource::kUncrew;
    if (why) item.ended = storage::ConnectionEnded{world_.clock.System(), *why, "", ""};
    world_.CommitConnection(std::move(item));
    world_.clock.Advance(milliseconds(1));
  };
  connect(1, "rcan://a", model::ConnectionEnd::kSilent);
  connect(2, "rcan://a", std::nullopt);
  connect(3, "rcan://b", model::ConnectionEnd::kBroken);
  const std::string path = "/api/v1/connections";
  EXPECT_THAT(Texts(path, "/address"), ElementsAre("3", "2", "1"));
  EXPECT_THAT(Texts(path + "?orderBy=oldest&fleet=north", "/address"), ElementsAre("1", "2"));
  EXPECT_THAT(Texts(path + "?open=true", "/address"), ElementsAre("2"));
  EXPECT_THAT(Texts(path + "?why=silent", "/end/why"), ElementsAre("silent"));
  EXPECT_THAT(Texts(path + "?source=uncrew", "/address"), ElementsAre("3"));
  EXPECT_THAT(Get(path + "?why=tired").body, HasSubstr("why is none of the reasons of an end"));
  EXPECT_THAT(Texts("/api/v1/robot/story?ruri=" + kA + "&orderBy=oldest&from=" + At(4), "/kind"),
              ElementsAre("connected"));
  EXPECT_EQ(Get("/api/v1/robot/story").status, 400);
  EXPECT_EQ(Get("/api/v1/robot/story?ruri=rcan://x").status, 404);
}

TEST_F(ListsTest, ARobotIsNamedByParameterAsWell) {
  SayThings();
  EXPECT_EQ(Get("/api/v1/robot?ruri=" + kA).body, Get("/api/v1/robots/" + kA).body);
  EXPECT_EQ(Get("/api/v1/robot?ruri=rcan://a").body, Get("/api/v1/robots/" + kA).body)
      << "as a proxy leaves it";
  EXPECT_EQ(Get("/api/v1/robot?ruri=rcan://x").status, 404);
}

TEST_F(ListsTest, AnUnknownOrEmptyParameterIsToldWhichThereAre) {
  constexpr const char* kTaken =
      "this path takes fleet, ruri, from, to, orderBy, pageSize, pageToken, level";
  EXPECT_THAT(Get("/api/v1/messages?severity=info").body,
              HasSubstr(std::string("severity is not a parameter of this path; ") + kTaken));
  EXPECT_THAT(Get("/api/v1/messages?ruri=").body, HasSubstr(kTaken));
  EXPECT_THAT(Get("/api/v1/messages?level=").body, HasSubstr(kTaken));
  EXPECT_THAT(Get("/api/v1/status?x=1").body,
              HasSubstr("x is not a parameter of this path, which takes none"));
}

TEST_F(ListsTest, SoManyRobotsAreTakenAndNoMore) {
  SayThings();
  std::string query = "/api/v1/events?";
  for (std::size_t i = 0; i < storage::kRurisMax; ++i) query += fmt::format("ruri=r{}&", i);
  EXPECT_EQ(Get(query).status, 200);
  const Response answer = Get(query + "ruri=one-more");
  EXPECT_EQ(answer.status, 400);
  EXPECT_THAT(answer.body, HasSubstr("ruri is given more than 100 times"));
}

TEST_F(ListsTest, MissionsAreFiltered) {
  SayThings();
  const std::string path = "/api/v1/missions";
  EXPECT_THAT(Texts(path, "/status"), ElementsAre("running", "running", "complete"));
  EXPECT_THAT(Texts(path + "?ruri=" + kA, "/missionId"), ElementsAre("m-two", "m-one"));
  EXPECT_THAT(Texts(path + "?fleet=south", "/ruri"), ElementsAre("rcan://b"));
  EXPECT_THAT(Texts(path + "?open=true&fleet=north", "/ruri"), ElementsAre("rcan://a"));
  EXPECT_THAT(Texts(path + "?open=false&fleet=north", "/ruri"),
              ElementsAre("rcan://a", "rcan://a"));
  EXPECT_THAT(Texts(path + "?missionId=m-one", "/status"), ElementsAre("complete"));
  EXPECT_THAT(Texts(path + "?runId=r-three", "/ruri"), ElementsAre("rcan://b"));
  EXPECT_THAT(Texts(path + "?runId=r-three&missionId=m-one", "/ruri"), IsEmpty());
}

TEST_F(ListsTest, ShapesAndObjectsAreFiltered) {
  SayThings();
  for (const std::string path : {"/api/v1/shapes", "/api/v1/objects"}) {
    EXPECT_THAT(Texts(path, "/id"), ElementsAre("three", "two"));
    EXPECT_THAT(Texts(path + "?includeExpired=true", "/id"), ElementsAre("three", "two", "one"));
    EXPECT_THAT(Texts(fmt::format("{}?includeExpired=false&ruri={}", path, kA), "/id"),
                ElementsAre("two"));
    EXPECT_THAT(Texts(path + "?fleet=south", "/id"), ElementsAre("three"));
    EXPECT_THAT(Texts(fmt::format("{}?ruri={}&fleet=south", path, kA), "/id"), IsEmpty());
  }
}

struct Walk {
  std::string target;
  /// What tells its rows apart, as a JSON pointer.
  std::string key;
};

class WalksTest : public ListsTest, public ::testing::WithParamInterface<Walk> {};

TEST_P(WalksTest, SeeEachRowOnceWhileRowsAreAdded) {
  SayThings();
  Say("rcan://a", "four");
  const std::vector<std::string> before = Texts(GetParam().target, GetParam().key);
  ASSERT_EQ(before.size(), 3U);
  const std::string page = GetParam().target + "pageSize=1";
  std::vector<std::string> seen = Texts(page, GetParam().key);
  std::string token = Token(page);
  while (!token.empty() && seen.size() <= before.size()) {
    // Something new, and something that is there already and changes.
    Say("rcan://a", "later" + std::to_string(seen.size()));
    Say("rcan://a", "two");
    const std::string next = fmt::format("{}&pageToken={}", page, token);
    for (std::string& key : Texts(next, GetParam().key)) seen.push_back(std::move(key));
    token = Token(next);
  }
  EXPECT_EQ(seen, before);
}

INSTANTIATE_TEST_SUITE_P(
    Lists, WalksTest,
    ::testing::Values(Walk{"/api/v1/events?ruri=rcan%3A%2F%2Fa&", "/detail/missionId"},
                      Walk{"/api/v1/messages?ruri=rcan%3A%2F%2Fa&", "/message"},
                      Walk{"/api/v1/presence?ruri=rcan%3A%2F%2Fa&", "/at"},
                      Walk{"/api/v1/missions?fleet=north&", "/runId"},
                      Walk{"/api/v1/shapes?includeExpired=true&fleet=north&", "/id"},
                      Walk{"/api/v1/objects?includeExpired=true&fleet=north&", "/id"}));

TEST_F(ListsTest, ATokenOfAnotherListIsRefused) {
  SayThings();
  world_.CommitFault("rcan://a", {.unix_time_ms = 1, .fault_id = "1", .source = "s"});
  world_.CommitFault("rcan://a", {.unix_time_ms = 1, .fault_id = "2", .source = "s"});
  const std::vector<std::string> lists = {"/api/v1/events?",
                                          "/api/v1/messages?",
                                          "/api/v1/presence?",
                                          "/api/v1/events?orderBy=oldest&",
                                          "/api/v1/missions?",
                                          "/api/v1/mission-reports?",
                                          "/api/v1/shapes?includeExpired=true&",
                                          "/api/v1/objects?includeExpired=true&",
                                          "/api/v1/faults?",
                                          "/api/v1/robots?"};
  for (const std::string& from : lists) {
    const std::string token = Token(from + "pageSize=1");
    ASSERT_NE(token, "") << from;
    for (const std::string& to : lists) {
      const Response answer = Get(fmt::format("{}pageToken={}", to, token));
      EXPECT_EQ(answer.status, to == from ? 200 : 400) << from << to;
      if (to != from) {
        EXPECT_THAT(answer.body, HasSubstr(R"("field":"pageToken")"));
      }
    }
  }
}

TEST_F(ListsTest, ARobotThatWasNeverSeenHasNoRows) {
  for (const char* list : {"events", "messages", "presence", "quarantine", "gaps", "faults",
                           "missions", "mission-reports", "shapes", "objects"}) {
    EXPECT_THAT(Texts(fmt::format("/api/v1/{}?ruri=rcan%3A%2F%2Fx", list), "/ruri"), IsEmpty())
        << list;
  }
}

class ScopeUpdatesTest : public ListsTest {
 protected:
  void Say(model::ScopeKind scope, const std::string& id, const std::string& type,
           const std::string& fleet = "north") {
    world_.clock.Advance(milliseconds(1));
    world_.CommitScopeUpdate({scope, id, type, "{}", 0}, fleet);
  }
  ScopeUpdatesTest() {
    start_ms_ = UnixMs(world_.clock.System());
    Say(model::ScopeKind::kEnvironment, kId, "a");
    Say(model::ScopeKind::kWorkflowRun, kId, "b");
    Say(model::ScopeKind::kEnvironment, kOtherId, "c", "south");
  }
  static constexpr const char* kId = "eeeeeeee-eeee-4eee-8eee-eeeeeeeeeeee";
  static constexpr const char* kOtherId = "11111111-1111-4111-8111-111111111111";
  const std::string path_ = "/api/v1/scope-updates";
};

TEST_F(ScopeUpdatesTest, AreNewestFirstAndFiltered) {
  EXPECT_THAT(Texts(path_, "/type"), ElementsAre("c", "b", "a"));
  EXPECT_THAT(Texts(path_ + "?scope=environment", "/type"), ElementsAre("c", "a"));
  EXPECT_THAT(Texts(path_ + "?scope=workflow_run", "/type"), ElementsAre("b"));
  EXPECT_THAT(Texts(path_ + "?id=" + kId, "/type"), ElementsAre("b", "a"));
  EXPECT_THAT(Texts(path_ + "?id=EEEEEEEE-EEEE-4EEE-8EEE-EEEEEEEEEEEE", "/type"),
              ElementsAre("b", "a"));
  EXPECT_THAT(Texts(path_ + "?scope=environment&id=" + kId, "/type"), ElementsAre("a"));
  EXPECT_THAT(Texts(path_ + "?fleet=south", "/type"), ElementsAre("c"));
  EXPECT_THAT(Texts(path_ + "?from=" + At(2) + "&to=" + At(2), "/type"), ElementsAre("b"));
  const std::string page = path_ + "?pageSize=2";
  EXPECT_THAT(Texts(page + "&pageToken=" + Token(page), "/type"), ElementsAre("a"));
}

TEST_F(ScopeUpdatesTest, TheParameterAtFaultIsNamed) {
  for (const auto& [query, field, words] :
       {std::tuple{"scope=twin", "scope", "must be environment or workflow_run"},
        std::tuple{"id=x", "id", "must be a UUID: 8-4-4-4-12 hex digits"},
        std::tuple{"ruri=x", "ruri", "is not a parameter of this path"}}) {
    const Response answer = Get(path_ + "?" + query);
    EXPECT_EQ(answer.status, 400) << query;
    EXPECT_THAT(answer.body, HasSubstr(R"("field":")" + std::string(field) + '"'));
    EXPECT_THAT(answer.body, HasSubstr(words));
  }
}

class QuarantineTest : public ListsTest {
 protected:
  void Reject(const std::string& ruri, const std::string& topic) {
    world_.clock.Advance(milliseconds(1));
    world_.CommitQuarantine(ruri, {model::RejectReason::kMalformed, "", ""}, "bytes",
                            storage::OriginOf(model::MessageSource::kCyberwave, topic));
  }
  QuarantineTest() {
    start_ms_ = UnixMs(world_.clock.System());
    world_.AddRobot("rcan://a", "north");
    world_.AddRobot("rcan://b", "south");
    world_.clock.Advance(milliseconds(1));
    world_.CommitQuarantine("rcan://a", {model::RejectReason::kOutOfRange, "x", "far"}, "bytes");
    Reject("rcan://b", "cyberwave/twin/T/event");
    Reject(storage::NoRobotOf("local"), "localcyberwave/twin/x/event");
  }
  const std::string path_ = "/api/v1/quarantine";
};

TEST_F(QuarantineTest, ShowsWhatBelongsToRobotsAndToNone) {
  EXPECT_THAT(Texts(path_, "/topic"),
              ElementsAre("localcyberwave/twin/x/event", "cyberwave/twin/T/event", ""));
  EXPECT_THAT(Texts(path_, "/ruri"), ElementsAre("", "rcan://b", "rcan://a"));
  EXPECT_THAT(Texts(path_, "/source"), ElementsAre("cyberwave", "cyberwave", "uplink"));
}

TEST_F(QuarantineTest, IsFilteredAndWalked) {
  EXPECT_THAT(Texts(path_ + "?source=uplink", "/ruri"), ElementsAre("rcan://a"));
  const std::string cyberwave = path_ + "?source=cyberwave";
  EXPECT_THAT(Texts(cyberwave, "/ruri"), ElementsAre("", "rcan://b"));
  EXPECT_THAT(Texts(cyberwave + "&fleet=south", "/ruri"), ElementsAre("rcan://b"));
  EXPECT_THAT(Texts(cyberwave + "&from=" + At(3), "/ruri"), ElementsAre(""));
  EXPECT_THAT(Texts(cyberwave + "&to=" + At(2), "/ruri"), ElementsAre("rcan://b"));
  EXPECT_THAT(Texts(cyberwave + "&ruri=" + kA, "/ruri"), IsEmpty());
  const std::string page = cyberwave + "&pageSize=1";
  EXPECT_THAT(Texts(page + "&pageToken=" + Token(page), "/ruri"), ElementsAre("rcan://b"));
}

TEST_F(QuarantineTest, RefusesASourceThatDoesNotExist) {
  const Response answer = Get(path_ + "?source=mqtt");
  EXPECT_EQ(answer.status, 400);
  EXPECT_THAT(answer.body, HasSubstr(R"("field":"source")"));
  EXPECT_THAT(answer.body, HasSubstr("must be uplink, cyberwave or uncrew"));
}

TEST_F(QuarantineTest, WhatStandsForNoRobotIsNone) {
  EXPECT_EQ(Get("/api/v1/robots/cyberwave%3Alocal").status, 404);
}

TEST_F(ListsTest, ListsOfRobotsShowTheStoredPartsThatTheyAreAskedFor) {
  world_.AddRobot("rcan://a");
  world_.CommitBody("rcan://a", model::AgentInfo{.agent_version = "7"});
  EXPECT_THAT(Get("/api/v1/robots?parts=agentInfo").body,
              HasSubstr(R"("agentInfo":{"agentVersion":"7"})"));
  EXPECT_EQ(Get("/api/v1/robots").body.find("agentInfo"), std::string::npos);
  EXPECT_THAT(Get("/api/v1/robots/" + kA).body, HasSubstr(R"("agentVersion":"7")"));
}

struct BadCase {
  std::string target;
  std::string field;
};

/// What every list refuses, and what each alone does.
std::vector<BadCase> BadCases() {
  std::vector<BadCase> cases = {{"/livez?a=b", "a"},
                                {"/readyz?verbose", "verbose"},
                                {"/metrics?name=x", "name"},
                                {"/api/v1/status?x=1", "x"},
                                {"/api/v1/robots?presence=ONLINE", "presence"},
                                {"/api/v1/robots?parts=motion,wheels", "parts"},
                                {"/api/v1/robots?ruri=x", "ruri"},
                                {"/api/v1/robots?from=1", "from"},
                                {"/api/v1/robots/" + kA + "?parts=motion", "parts"},
                                {"/api/v1/robot", "ruri"},
                                {"/api/v1/robot?ruri=", "ruri"},
                                {"/api/v1/robot?ruri=a&ruri=b", "ruri"},
                                {"/api/v1/faults?active=1", "active"},
                                {"/api/v1/faults?severity=bad", "severity"},
                                {"/api/v1/messages?level=notice", "level"},
                                {"/api/v1/missions?status=done", "status"},
                                {"/api/v1/quarantine?reason=bad", "reason"},
                                {"/api/v1/missions?open=yes", "open"},
                                {"/api/v1/missions?missionid=x", "missionid"},
                                {"/api/v1/missions?includeExpired=true", "includeExpired"},
                                {"/api/v1/shapes?includeExpired=1", "includeExpired"},
                                {"/api/v1/objects?includeExpired=TRUE", "includeExpired"}};
  std::vector<std::string> lists = {"/api/v1/robots", "/api/v1/shapes", "/api/v1/objects"};
  for (const char* history :
       {"events", "messages", "presence", "quarantine", "gaps", "faults", "missions",
        "mission-reports", "operator-requests", "scope-updates"}) {
    const std::string path = fmt::format("/api/v1/{}", history);
    lists.push_back(path);
    cases.push_back({path + "?from=1777636800000", "from"});
    cases.push_back({path + "?to=today", "to"});
    cases.push_back({path + "?orderBy=ruri", "orderBy"});
  }
  for (const char* path : {"/api/v1/shapes", "/api/v1/objects"}) {
    cases.push_back({std::string(path) + "?from=1", "from"});
    cases.push_back({std::string(path) + "?to=1", "to"});
  }
  // An empty filter would show everything.
  for (const char* filter :
       {"quarantine?source=",     "quarantine?ruri=",     "quarantine?fleet=",
        "quarantine?from=",       "scope-updates?scope=", "scope-updates?id=",
        "scope-updates?fleet=",   "faults?active=",       "faults?ruri=",
        "faults?fleet=",          "faults?to=",           "missions?open=",
        "missions?ruri=",         "missions?fleet=",      "missions?missionId=",
        "missions?runId=",        "shapes?ruri=",         "shapes?fleet",
        "shapes?includeExpired=", "objects?fleet=",       "robots?fleet=",
        "robots?presence=",       "robots?parts="}) {
    const std::string text(filter);
    const std::size_t mark = text.find('?') + 1;
    cases.push_back({"/api/v1/" + text, text.substr(mark, text.find('=') - mark)});
  }
  for (const std::string& list : lists) {
    cases.push_back({list + "?pageSize=", "pageSize"});
    cases.push_back({list + "?pageSize=0", "pageSize"});
    cases.push_back({list + "?pageSize=1001", "pageSize"});
    cases.push_back({list + "?pageSize=ten", "pageSize"});
    cases.push_back({list + "?pageToken=x", "pageToken"});
    cases.push_back({list + "?pageSize=1&pageSize=1", "pageSize"});
    cases.push_back({list + "?nonsense=1", "nonsense"});
  }
  return cases;
}

TEST_F(ListsTest, TheParameterAtFaultIsNamed) {
  world_.AddRobot("rcan://a");
  for (const BadCase& bad : BadCases()) {
    const Response response = Get(bad.target);
    EXPECT_EQ(response.status, 400) << bad.target << response.body;
    EXPECT_THAT(response.body, HasSubstr(R"("code":"INVALID_ARGUMENT")")) << bad.target;
    EXPECT_THAT(response.body, HasSubstr(R"("field":")" + bad.field + '"')) << bad.target;
  }
}

TEST_F(ListsTest, ThePageSizesAtTheBoundsAreTaken) {
  world_.AddRobot("rcan://a");
  for (const std::string list :
       {"/api/v1/missions", "/api/v1/shapes", "/api/v1/objects", "/api/v1/events"}) {
    EXPECT_EQ(Get(list + "?pageSize=1").status, 200);
    EXPECT_EQ(Get(list + "?pageSize=1000").status, 200);
  }
}

}  // namespace
}  // namespace uplink::http
