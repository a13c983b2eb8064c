#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "schema/encode.h"
#include "tests/component/uplinkd/uplinkd_fixture.h"
#include "tests/support/eventually.h"
#include "tests/support/fault_proxy.h"
#include "tests/support/postgres_database.h"

/// The real program on a real PostgreSQL server, through a proxy that makes trouble.
namespace uplink::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kRuri = "rcan://local.rcan/test/pg/1.0/robot-1";
constexpr const char* kRobotPath =
    "/api/v1/robots/rcan%3A%2F%2Flocal.rcan%2Ftest%2Fpg%2F1.0%2Frobot-1";

std::string Message(const std::string& text) {
  model::Message message;
  message.message = text;
  return schema::Encode(message);
}

std::string Motion() {
  model::MotionTelemetry motion;
  motion.unix_time_ms = 1'763'683'200'000;
  motion.pose.emplace();
  return schema::Encode(motion);
}

class PostgresServing : public UplinkdTest {
 protected:
  PostgresServing() : proxy_(static_cast<std::uint16_t>(std::stoul(database_.cluster().port))) {
    folder_.Write("password", "uplinkd\n");
  }

  /// Where a test fails its server's log says what it knew of it, and whether it still ran.
  void TearDown() override {
    if (HasFailure() && process_ != nullptr) {
      process_->Signal(SIGTERM);
      const std::optional<int> code = process_->WaitForExit();
      ADD_FAILURE() << "the server ended with " << code.value_or(-1) << " after\n"
                    << process_->text();
    }
    process_.reset();  // before its database
  }

  std::vector<std::string> Environment() const {
    return {"UPLINKD_STORE_URL=postgresql://uplinkd@127.0.0.1:" + std::to_string(proxy_.port()) +
                "/" + database_.name() + "?sslmode=disable",
            "UPLINKD_STORE_PASSWORD_FILE=" + folder_.Path("password"), "UPLINKD_STORE_TIMEOUT=2s"};
  }
  void Serve(const std::vector<std::string>& more = {}) {
    std::vector<std::string> environment = Environment();
    environment.insert(environment.end(), more.begin(), more.end());
    UplinkdTest::Serve(environment);
  }
  std::unique_ptr<TestAgent> Agent() const {
    return std::make_unique<TestAgent>(Channel(RobotSpec(kRuri)));
  }
  void SendNotes(TestAgent& agent, model::Seq first, model::Seq last) {
    std::vector<Sent> messages;
    for (model::Seq seq = first; seq <= last; ++seq) {
      messages.push_back({seq, Message("note " + std::to_string(seq))});
    }
    ASSERT_TRUE(agent.Send(BatchFrame(messages)));
  }
  bool IsDegraded() const {
    return HttpGet(http_, "/readyz").body.find("\"store\"") != std::string::npos;
  }
  /// The numbers of the notes in the database, each as often as it is there.
  std::string Notes() const {
    return database_.Shell().Read(
        "SELECT string_agg(seq::text, ',' ORDER BY seq) FROM uplinkd.messages");
  }
  static std::string Numbers(model::Seq last) {
    std::string text;
    for (model::Seq seq = 1; seq <= last; ++seq) text += (seq > 1 ? "," : "") + std::to_string(seq);
    return text + "\n";
  }

  const model::SessionId session_{{1, 2, 3}};
  PostgresDatabase database_;
  FaultProxy proxy_;
};

TEST_F(PostgresServing, AnAckIsARowAndAKillLosesNone) {
  Serve();
  {
    const auto agent = Agent();
    ASSERT_TRUE(agent->Connect(session_));
    SendNotes(*agent, 1, 20);
    ASSERT_TRUE(agent->ReadThrough(20));
    EXPECT_EQ(Notes(), Numbers(20));
    process_->Signal(SIGKILL);
    ASSERT_TRUE(process_->WaitForExit());
  }
  Serve();
  EXPECT_THAT(HttpGet(http_, kRobotPath).body, HasSubstr(R"("presence":"unknown")"));
  const auto agent = Agent();
  const auto welcome = agent->Connect(session_);
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->committed_seq(), 20U);
  SendNotes(*agent, 15, 25);
  ASSERT_TRUE(agent->ReadThrough(25));
  EXPECT_EQ(Notes(), Numbers(25));
  EXPECT_THAT(HttpGet(http_, "/api/v1/messages").body, HasSubstr("note 25"));
  process_->Signal(SIGTERM);
  EXPECT_EQ(process_->WaitForExit(), 0);
}

TEST_F(PostgresServing, AStoreThatCannotBeReachedAtTheStartIsWaitedFor) {
  proxy_.Set(ProxyMode::kRefuse);
  Serve();
  EXPECT_THAT(process_->text(), HasSubstr("store_away"));
  EXPECT_TRUE(Eventually([this] { return IsDegraded(); }));
  EXPECT_EQ(HttpGet(http_, "/readyz").status, 200);
  const auto agent = Agent();
  ASSERT_TRUE(agent->Connect(session_));
  SendNotes(*agent, 1, 5);
  const auto judged = agent->ReadJudged(5);
  ASSERT_TRUE(judged);
  EXPECT_EQ(judged->through_seq(), 0U);

  proxy_.Set(ProxyMode::kPass);
  ASSERT_TRUE(agent->ReadThrough(5));
  EXPECT_EQ(Notes(), Numbers(5));
  EXPECT_TRUE(process_->WaitFor("store_works_again")) << process_->text();
  EXPECT_TRUE(process_->WaitFor("robots_read")) << process_->text();
  EXPECT_TRUE(Eventually([this] { return !IsDegraded(); }));
}

TEST_F(PostgresServing, AWrongPasswordStopsTheStart) {
  folder_.Write("password", "wrong\n");
  process_ = folder_.Start({}, Environment());
  EXPECT_EQ(process_->WaitForExit(), 1);
  EXPECT_THAT(process_->text(), HasSubstr("password authentication failed"));
  EXPECT_EQ(proxy_.connections(), 1) << "it is not tried again";
}

struct Trouble {
  const char* name;
  ProxyMode mode;
  /// Nothing can be committed while it lasts.
  bool stops;
};

class PostgresTrouble : public PostgresServing, public ::testing::WithParamInterface<Trouble> {};

TEST_P(PostgresTrouble, DurableWaitsLiveGoesOnAndNothingIsLostOrDoubled) {
  // A server that is slow must have the time that it takes, on a busy machine too.
  const std::string patience = GetParam().stops ? "2s" : "10s";
  Serve({"UPLINKD_PRESENCE_TIMEOUT=2s", "UPLINKD_STORE_TIMEOUT=" + patience});
  const auto agent = Agent();
  ASSERT_TRUE(agent->Connect(session_));
  SendNotes(*agent, 1, 3);
  ASSERT_TRUE(agent->ReadThrough(3));

  proxy_.Set(GetParam().mode);
  SendNotes(*agent, 4, 6);
  ASSERT_TRUE(agent->Send(BatchFrame({{7, Motion()}})));
  const auto judged = agent->ReadJudged(7);
  ASSERT_TRUE(judged);
  EXPECT_THAT(HttpGet(http_, kRobotPath).body, HasSubstr(R"("presence":"online")"));
  if (GetParam().stops) {
    EXPECT_EQ(judged->through_seq(), 3U);
    EXPECT_TRUE(Eventually([this] { return IsDegraded(); }));
    EXPECT_EQ(Notes(), Numbers(3));
    proxy_.Set(ProxyMode::kPass);
  }
  // The Ack of the live message may have covered the commit already.
  if (judged->through_seq() < 7) {
    ASSERT_TRUE(agent->ReadThrough(7));
  }
  proxy_.Set(ProxyMode::kPass);
  SendNotes(*agent, 8, 9);
  ASSERT_TRUE(agent->ReadThrough(9));
  EXPECT_EQ(Notes(), "1,2,3,4,5,6,8,9\n");
  EXPECT_TRUE(Eventually([this] { return !IsDegraded(); }));
  EXPECT_THAT(HttpGet(http_, "/metrics").body, HasSubstr("uplinkd_uplinks_in_flight 0\n"));
}

INSTANTIATE_TEST_SUITE_P(Modes, PostgresTrouble,
                         ::testing::Values(Trouble{"Refuse", ProxyMode::kRefuse, true},
                                           Trouble{"BlackHole", ProxyMode::kBlackHole, true},
                                           Trouble{"Delay", ProxyMode::kDelay, false},
                                           Trouble{"Trickle", ProxyMode::kTrickle, false}),
                         [](const auto& trouble) { return trouble.param.name; });

TEST_F(PostgresServing, CutsWithinRepliesAndBehindCommitsDoubleNothing) {
  Serve();
  const auto agent = Agent();
  ASSERT_TRUE(agent->Connect(session_));
  for (model::Seq seq = 1; seq <= 10; ++seq) {
    if (seq <= 5) {
      proxy_.CutNextReply();
    } else {
      proxy_.CutNextCommit();
    }
    SendNotes(*agent, seq, seq);
    ASSERT_TRUE(agent->ReadThrough(seq));
  }
  EXPECT_GE(proxy_.cuts(), 10);
  EXPECT_EQ(Notes(), Numbers(10));
}

TEST_F(PostgresServing, AtTheLimitsStreamsAreHeldBackAndTheirRobotsUnknown) {
  Serve({"UPLINKD_JOURNAL_BYTES_MAX=8KiB", "UPLINKD_STORE_SHARDS=1", "UPLINKD_PRESENCE_TIMEOUT=1s",
         "UPLINKD_PRESENCE_STARTUP_GRACE=1s"});
  const auto agent = Agent();
  ASSERT_TRUE(agent->Connect(session_));
  ASSERT_TRUE(agent->Send(BatchFrame({{1, Motion()}})));
  ASSERT_TRUE(agent->ReadJudged(1));
  proxy_.Set(ProxyMode::kRefuse);
  constexpr model::Seq kLast = 60;
  SendNotes(*agent, 2, kLast);
  const auto held_back_by = [&](const std::string& reason) {
    return Sample("uplinkd_streams_held_back{reason=\"" + reason + "\"}");
  };
  ASSERT_TRUE(
      Eventually([&] { return held_back_by("journal") + held_back_by("journal_share") == 1; }));
  EXPECT_EQ(held_back_by("ending"), 0);
  // One record may go over the bound, since it is looked at before each.
  EXPECT_LE(Sample("uplinkd_journal_bytes"), 8 * 1024 + 2048);
  ASSERT_TRUE(Eventually([this] {
    const std::string body = HttpGet(http_, kRobotPath).body;
    EXPECT_THAT(body, Not(HasSubstr(R"("presence":"offline")")));
    return body.find(R"("presence":"unknown")") != std::string::npos;
  }));
  proxy_.Set(ProxyMode::kPass);
  ASSERT_TRUE(agent->ReadThrough(kLast));
  EXPECT_EQ(database_.Shell().Read("SELECT count(*), count(DISTINCT seq) FROM uplinkd.messages"),
            "59|59\n");
}

}  // namespace
}  // namespace uplink::testing
