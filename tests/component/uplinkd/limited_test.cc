// A robot over its shape rate that never hears the answers: what it is told after it comes back.
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "schema/encode.h"
#include "tests/support/eventually.h"
#include "tests/support/postgres_database.h"
#include "tests/support/raw_http.h"
#include "tests/support/test_agent.h"
#include "tests/support/uplinkd_folder.h"
#include "tests/unit/schema/samples.h"

namespace uplink::testing {
namespace {

using ::testing::HasSubstr;

constexpr const char* kRuri = "rcan://test/1";
/// What a shape's bucket holds by default.
constexpr model::Seq kBurst = 2'000;
constexpr model::Seq kPerFrame = 250;

std::string Shape(model::Seq id) {
  model::ReportedShape shape = test::SampleShape();
  shape.identity.id = "hazard-" + std::to_string(id);
  shape.expire_time_ms = 0;
  return schema::Encode(model::ShapeOp{shape});
}

std::string RaisedFault() {
  model::Fault fault;
  fault.fault_id = "F";
  fault.source = "drive";
  fault.active = true;
  return schema::Encode(fault);
}

std::string MotionAt(double latitude) {
  model::MotionTelemetry motion;
  motion.pose = model::Pose{.lat_deg = latitude, .lon_deg = 8};
  return schema::Encode(motion);
}

/// By the store.
class LimitedTest : public ::testing::TestWithParam<const char*> {
 protected:
  struct Server {
    std::unique_ptr<ServerProcess> process;
    Ports ports;
  };

  LimitedTest() {
    folder_.Write("password", "uplinkd\n");
    if (GetParam() == std::string("postgres")) database_.emplace();
  }
  Server Serve() const {
    std::vector<std::string> environment;
    if (database_) {
      environment = {"UPLINKD_STORE_URL=postgresql://uplinkd@127.0.0.1:" +
                         database_->cluster().port + "/" + database_->name() + "?sslmode=disable",
                     "UPLINKD_STORE_PASSWORD_FILE=" + folder_.Path("password")};
    }
    Server server{folder_.Start({}, environment), {}};
    const auto ports = WaitForPorts(*server.process);
    EXPECT_TRUE(ports) << server.process->text();
    if (ports) server.ports = *ports;
    return server;
  }
  static void Kill(Server& server) {
    server.process->Signal(SIGKILL);
    ASSERT_TRUE(server.process->WaitForExit());
  }
  std::unique_ptr<TestAgent> Agent(const Server& server) const {
    return std::make_unique<TestAgent>(
        MakeChannel({.port = server.ports.relay,
                     .server_ca = folder_.authority().certificate(),
                     .identity = folder_.authority().Issue(RobotSpec(kRuri))}));
  }
  /// The bucket's shapes, `more` shapes and a fault. Returns the fault's number. All of it is
  /// decided, and no answer read.
  model::Seq Flood(const Server& server, TestAgent& agent, model::Seq more) {
    EXPECT_TRUE(agent.Connect(session_));
    const model::Seq last = kBurst + more + 1;
    for (model::Seq first = 1; first <= last; first += kPerFrame) {
      std::vector<Sent> messages;
      for (model::Seq seq = first; seq < first + kPerFrame && seq <= last; ++seq) {
        messages.push_back({seq, seq == last ? RaisedFault() : Shape(seq)});
      }
      EXPECT_TRUE(agent.Send(BatchFrame(messages)));
    }
    EXPECT_TRUE(Eventually([&] {
      const std::string metrics = HttpGet(server.ports.http, "/metrics").body;
      return Sample(metrics, "uplinkd_uplinks_in_flight") == 0 &&
             Outcomes(metrics, "stored") + Outcomes(metrics, "rejected") == last;
    }));
    const std::string metrics = HttpGet(server.ports.http, "/metrics").body;
    limited_ = Outcomes(metrics, "rejected");
    EXPECT_GT(limited_, more / 2) << "the bucket fills while shapes come";
    EXPECT_EQ(Outcomes(metrics, "stored") + limited_, last);
    return last;
  }
  static std::uint64_t Sample(const std::string& metrics, const std::string& name) {
    const std::size_t line = metrics.find("\n" + name + " ");
    if (line == std::string::npos) return 0;
    return static_cast<std::uint64_t>(std::stod(metrics.substr(line + name.size() + 2)));
  }
  static std::uint64_t Outcomes(const std::string& metrics, const std::string& outcome) {
    return Sample(metrics, "uplinkd_uplinks_settled_total{outcome=\"" + outcome + "\"}");
  }
  /// The robot comes back and is told each limited number before the Ack that covers it.
  void ExpectAllTold(const Server& server, model::Seq last) {
    const auto agent = Agent(server);
    ASSERT_TRUE(agent->Connect(session_));
    ASSERT_TRUE(agent->ReadThrough(last));
    std::set<std::uint64_t> told;
    std::uint64_t acked_untold = 0;
    for (const v1::RelayResponse& frame : agent->frames()) {
      if (frame.has_reject()) {
        EXPECT_EQ(frame.reject().reason(), v1::REJECT_REASON_RATE_LIMITED);
        EXPECT_GT(frame.reject().retry_after_ms(), 0);
        told.insert(frame.reject().seq());
      } else if (frame.has_ack() && frame.ack().through_seq() == last) {
        acked_untold = limited_ - told.size();
      }
    }
    EXPECT_EQ(acked_untold, 0U) << "of " << limited_;
    EXPECT_EQ(told.size(), limited_);
  }

  const model::SessionId session_{{1, 2, 3}};
  std::optional<PostgresDatabase> database_;
  UplinkdFolder folder_;
  std::uint64_t limited_ = 0;
};

TEST_P(LimitedTest, AfterAKillEachIsToldAgain) {
  Server server = Serve();
  const auto agent = Agent(server);
  const model::Seq last = Flood(server, *agent, 100);
  Kill(server);
  const Server next = Serve();
  ExpectAllTold(next, last);
  EXPECT_THAT(HttpGet(next.ports.http, "/api/v1/faults").body, HasSubstr("\"F\""));
}

TEST_P(LimitedTest, AfterACutEachIsToldAgainThoughMemoryLetGoOfSome) {
  const Server server = Serve();
  auto agent = Agent(server);
  const model::Seq last = Flood(server, *agent, 600);
  agent.reset();
  ExpectAllTold(server, last);
}

TEST_P(LimitedTest, AFloodOfMotionIsCountedAndDelaysNoFault) {
  constexpr model::Seq kMotions = 20'000;
  const Server server = Serve();
  const auto agent = Agent(server);
  ASSERT_TRUE(agent->Connect(session_));
  for (model::Seq first = 1; first <= kMotions; first += kPerFrame) {
    std::vector<Sent> messages;
    for (model::Seq seq = first; seq < first + kPerFrame; ++seq) {
      messages.push_back({seq, MotionAt(seq == kMotions ? 12.625 : 47)});
    }
    ASSERT_TRUE(agent->Send(BatchFrame(messages)));
  }
  ASSERT_TRUE(agent->Send(BatchFrame({{kMotions + 1, RaisedFault()}})));
  ASSERT_TRUE(agent->ReadThrough(kMotions + 1));
  const std::string robot = "/api/v1/robots/rcan%3A%2F%2Ftest%2F1";
  EXPECT_TRUE(Eventually([&] {
    return HttpGet(server.ports.http, robot).body.find("1.2625E1") != std::string::npos;
  })) << "the latest wins: "
      << HttpGet(server.ports.http, robot).body;
  const std::string metrics = HttpGet(server.ports.http, "/metrics").body;
  const std::string of_motion = "{kind=\"motionTelemetry\"}";
  const std::uint64_t decoded = Sample(metrics, "uplinkd_records_total" + of_motion);
  const std::uint64_t over = Sample(metrics, "uplinkd_telemetry_over_rate_total" + of_motion);
  EXPECT_GT(over, 0U);
  EXPECT_EQ(decoded + over, kMotions);
  EXPECT_EQ(Sample(metrics, "uplinkd_uplinks_received_total"), kMotions + 1);
  EXPECT_EQ(Outcomes(metrics, "applied") + Outcomes(metrics, "superseded"), kMotions);
  EXPECT_EQ(Outcomes(metrics, "stored"), 1U);
  EXPECT_THAT(HttpGet(server.ports.http, robot).body,
              HasSubstr("\"motionTelemetry\":\"" + std::to_string(over) + "\""));
}

class LimitedMoveTest : public LimitedTest {};

TEST_P(LimitedMoveTest, AnotherServerOfTheDatabaseTellsThem) {
  const Server server = Serve();
  const auto agent = Agent(server);
  const model::Seq last = Flood(server, *agent, 100);
  const Server other = Serve();
  ExpectAllTold(other, last);
}

INSTANTIATE_TEST_SUITE_P(Stores, LimitedTest, ::testing::Values("sqlite", "postgres"));
// A file of SQLite has one server.
INSTANTIATE_TEST_SUITE_P(Stores, LimitedMoveTest, ::testing::Values("postgres"));

}  // namespace
}  // namespace uplink::testing
