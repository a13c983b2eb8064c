#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "schema/base/check.h"
#include "schema/base/rfc3339.h"
#include "schema/encode.h"
#include "schema/judge.h"
#include "tests/support/eventually.h"
#include "tests/support/raw_http.h"
#include "tests/support/records.h"
#include "tests/support/sqlite_shell.h"
#include "tests/support/test_agent.h"
#include "tests/support/uplinkd_folder.h"
#include "tests/support/vector_files.h"
#include "tests/support/vector_views.h"

// The vendor's payloads through the real program: over mutual TLS into SQLite, out over HTTP.
namespace uplink::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// When the shape and the object of the vectors expire: before today, so that the server leaves
/// them out.
constexpr std::int64_t kExpiryMs = 1'763'686'800'000;

class VectorsOverTheWire : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    server_ = std::make_unique<Server>();
    Start();
  }
  static void Start() {
    server_->process = server_->folder.Start({}, {"UPLINKD_STORE_CHECKPOINT=1s"});
    const auto ports = WaitForPorts(*server_->process);
    ASSERT_TRUE(ports) << server_->process->text();
    server_->http = ports->http;
    server_->relay = ports->relay;
  }
  static void TearDownTestSuite() { server_.reset(); }

  static std::int64_t NowMs() { return UnixMs(SystemClock{}.System()); }

  /// The robot connects with a new session, sends these and waits until all are settled.
  static void Send(const std::string& ruri, const std::vector<std::string>& payloads) {
    const auto channel =
        MakeChannel({.port = server_->relay,
                     .server_ca = server_->folder.authority().certificate(),
                     .identity = server_->folder.authority().Issue(RobotSpec(ruri))});
    TestAgent agent(channel);
    ASSERT_TRUE(agent.Connect(*model::SessionId::FromHex("000102030405060708090a0b0c0d0e0f")));
    std::vector<Sent> messages;
    messages.reserve(payloads.size());
    for (const std::string& payload : payloads) messages.push_back({messages.size() + 1, payload});
    agent.Send(BatchFrame(messages));
    agent.HalfClose();
    ASSERT_TRUE(agent.ReadThrough(messages.size())) << ruri;
    EXPECT_TRUE(agent.End().ok());
    EXPECT_TRUE(agent.rejects().empty()) << agent.rejects().front().ShortDebugString();
  }

  static RawAnswer Get(const std::string& target) { return HttpGet(server_->http, target); }

  static void ExpectViews(const std::string& ruri, const std::string& vector, std::int64_t from) {
    for (const test::VectorView& view : test::ViewsOf(ruri, vector)) {
      const RawAnswer answer = Get(view.target);
      EXPECT_EQ(answer.status, 200) << view.target << answer.body;
      EXPECT_THAT(answer.head, HasSubstr("Content-Type: application/json\r\n"));
      EXPECT_EQ(test::Difference(view, answer.body, {from, NowMs()}), "") << view.target;
    }
  }

  static bool Shows(const std::string& ruri, const std::string& vector, std::int64_t from) {
    const auto views = test::ViewsOf(ruri, vector);
    return std::ranges::all_of(views, [&](const test::VectorView& view) {
      return test::Difference(view, Get(view.target).body, {from, NowMs()}).empty();
    });
  }

  struct Server {
    UplinkdFolder folder;
    std::unique_ptr<ServerProcess> process;
    std::uint16_t http = 0;
    std::uint16_t relay = 0;
  };
  static std::unique_ptr<Server> server_;
};
std::unique_ptr<VectorsOverTheWire::Server> VectorsOverTheWire::server_;

/// The vector's upsert with another expiry, as bytes and as JSON.
struct Prolonged {
  std::string payload;
  std::string json;
};

Prolonged Prolong(const std::string& name, std::int64_t expiry_ms) {
  schema::Judge judge{schema::JudgeLimits()};
  const std::string bytes = test::ReadVector(name, ".bin");
  schema::Judgement judgement = judge.Payload(test::AsPayload(bytes));
  model::Body body = std::get<model::Record>(std::move(judgement.verdict)).TakeBody();
  if (auto* shape = std::get_if<model::ShapeOp>(&body)) {
    std::get<model::ReportedShape>(shape->op).expire_time_ms = expiry_ms;
  } else {
    std::get<model::Object>(std::get<model::ObjectOp>(body).op).expires_unix_time_ms = expiry_ms;
  }
  Prolonged prolonged{schema::Encode(body), test::ReadVector(name, ".json")};
  const std::string old = std::to_string(kExpiryMs);
  const std::size_t at = prolonged.json.find(old);
  UPLINK_CHECK(at != std::string::npos, "the vector names its expiry");
  prolonged.json.replace(at, old.size(), std::to_string(expiry_ms));
  return prolonged;
}

TEST_F(VectorsOverTheWire, AreSeenFieldByField) {
  const std::vector<std::string> names = test::VectorNames();
  ASSERT_EQ(names.size(), 2 * model::kVariants);
  const std::int64_t from = NowMs();
  for (const std::string& name : names) {
    Send(test::RuriOfVector(name), {test::ReadVector(name, ".bin")});
  }
  for (const std::string& name : names) {
    if (name == "shape" || name == "object") continue;
    ExpectViews(test::RuriOfVector(name), test::ReadVector(name, ".json"), from);
  }
}

TEST_F(VectorsOverTheWire, UpsertsThatExpiredBeforeTheyCameAreNotKept) {
  for (const std::string name : {"shape", "object"}) {
    const std::string ruri = "rcan://late/" + name;
    Send(ruri, {test::ReadVector(name, ".bin")});
    EXPECT_THAT(
        Get(fmt::format("/api/v1/{}s?includeExpired=true&ruri=rcan%3A%2F%2Flate%2F{}", name, name))
            .body,
        HasSubstr(fmt::format(R"("{}s":[])", name)));
  }
}

TEST_F(VectorsOverTheWire, UpsertsAreSeenUntilTheyAreDeleted) {
  const std::int64_t from = NowMs();
  for (const std::string name : {"shape", "object"}) {
    const Prolonged upsert = Prolong(name, from + 3'600'000);
    const std::string ruri = "rcan://present/" + name;
    Send(ruri, {upsert.payload});
    ExpectViews(ruri, upsert.json, from);

    const std::string gone = "rcan://gone/" + name;
    const std::string id = name + "-vec";
    const std::string deletion = name == "shape"
                                     ? schema::Encode(model::ShapeOp{model::Deletion{id}})
                                     : schema::Encode(model::ObjectOp{model::Deletion{id}});
    Send(gone, {upsert.payload, deletion});
    ExpectViews(gone, test::ReadVector(name + "-min", ".json"), from);
  }
}

TEST_F(VectorsOverTheWire, ASignOfLifeIsAPresenceChange) {
  const std::int64_t from = NowMs();
  Send("rcan://alive", {test::ReadVector("motionTelemetry", ".bin")});
  // The server's own records are not acked.
  const std::string target = "/api/v1/presence?ruri=rcan%3A%2F%2Falive";
  std::string body;
  ASSERT_TRUE(Eventually([&] {
    body = Get(target).body;
    return body.find(R"("presence":"online")") != std::string::npos;
  })) << body;
  EXPECT_THAT(Get("/api/v1/robots/rcan%3A%2F%2Falive").body, HasSubstr(R"("presence":"online")"));
  constexpr std::string_view kMember = R"("at":")";
  const std::size_t begin = body.find(kMember) + kMember.size();
  const auto at = FromRfc3339(body.substr(begin, body.find('"', begin) - begin));
  ASSERT_TRUE(at) << body;
  EXPECT_GE(UnixMs(*at), from);
}

TEST_F(VectorsOverTheWire, WholeNumbersAreExactTo2To53) {
  Send("rcan://exact",
       {schema::Encode(model::AgentInfo{.agent_version = "1", .uptime_s = 9'007'199'254'740'992})});
  EXPECT_THAT(Get("/api/v1/robots/rcan%3A%2F%2Fexact").body,
              HasSubstr(R"("uptimeS":9007199254740992)"));
}

/// After a kill what was checkpointed is there, and after a stop in order all is.
TEST_F(VectorsOverTheWire, LiveStateIsBackAfterARestart) {
  for (const int signal : {SIGKILL, SIGTERM}) {
    const std::int64_t from = NowMs();
    const auto live = [](const std::string& name) {
      const std::string payload = test::ReadVector(name, ".bin");
      schema::Judge judge{schema::JudgeLimits()};
      return !judge.Payload(test::AsPayload(payload)).record()->durable();
    };
    const auto ruri = [&](const std::string& name) {
      return "rcan://restart" + std::to_string(signal) + "/" + name;
    };
    const auto written = [&] {
      return SqliteShell(server_->folder.Path("uplinkd.db"))
          .Read("SELECT count(*) FROM live WHERE ruri LIKE 'rcan://restart" +
                std::to_string(signal) +
                "/%' AND coalesce(motion, status, extras, health, usage, consumables, directives)"
                " IS NOT NULL");
    };
    int sent = 0;
    for (const std::string& name : test::VectorNames()) {
      if (!live(name)) continue;
      Send(ruri(name), {test::ReadVector(name, ".bin")});
      ++sent;
    }
    ASSERT_EQ(sent, 14);
    if (signal == SIGKILL) {
      ASSERT_TRUE(Eventually([&] { return written() == std::to_string(sent) + "\n"; }));
    }
    server_->process->Signal(signal);
    ASSERT_TRUE(server_->process->WaitForExit());
    Start();
    // Adopted by another thread, robots are restored within half a second.
    for (const std::string& name : test::VectorNames()) {
      if (!live(name)) continue;
      const std::string vector = test::ReadVector(name, ".json");
      EXPECT_TRUE(Eventually([&] { return Shows(ruri(name), vector, from); })) << ruri(name);
    }
    EXPECT_TRUE(Eventually([&] {
      const RawAnswer robot = Get("/api/v1/robots/" + std::string("rcan%3A%2F%2Frestart") +
                                  std::to_string(signal) + "%2FmotionTelemetry");
      return robot.body.find(R"("presence":"unknown")") != std::string::npos &&
             robot.body.find(R"("lastSignOfLife":"2)") != std::string::npos;
    }));
  }
}

}  // namespace
}  // namespace uplink::testing
