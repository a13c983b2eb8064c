// Two servers on one PostgreSQL database: what one commits reaches the other's robots, once each.
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/component/uplinkd/forwarding.h"
#include "tests/component/uplinkd/uplinkd_fixture.h"
#include "tests/support/eventually.h"
#include "tests/support/postgres_database.h"

namespace uplink::testing {
namespace {

using ::testing::ElementsAre;

constexpr const char* kHeard = "uplinkd_forward_heard_total";

std::string Shared(const std::string& id, const std::string& robot) {
  return id + "@" + SharingRuri(robot);
}

class TwoServersTest : public ::testing::Test {
 protected:
  struct Server {
    std::unique_ptr<ServerProcess> process;
    std::uint16_t relay = 0;
    std::uint16_t http = 0;
  };

  void SetUp() override {
    folder_.Write("password", "uplinkd\n");
    for (std::size_t i = 0; i < servers_.size(); ++i) Serve(i);
  }
  void Serve(std::size_t which) {
    Server& server = servers_[which];
    server.process = folder_.Start(
        {}, {"UPLINKD_STORE_URL=postgresql://uplinkd@127.0.0.1:" + database_.cluster().port + "/" +
                 database_.name() + "?sslmode=disable",
             "UPLINKD_STORE_PASSWORD_FILE=" + folder_.Path("password")});
    const auto ports = WaitForPorts(*server.process);
    ASSERT_TRUE(ports) << server.process->text();
    server.relay = ports->relay;
    server.http = ports->http;
  }
  std::unique_ptr<SharingRobot> Connect(std::size_t server, const std::string& robot,
                                        std::uint8_t session = 1) {
    CertificateSpec spec = RobotSpec(SharingRuri(robot));
    return std::make_unique<SharingRobot>(
        MakeChannel({.port = servers_[server].relay,
                     .server_ca = folder_.authority().certificate(),
                     .identity = folder_.authority().Issue(spec)}),
        session);
  }
  double Sample(std::size_t server, const std::string& name) const {
    return SampleIn(HttpGet(servers_[server].http, "/metrics").body, name);
  }

  PostgresDatabase database_;
  UplinkdFolder folder_;
  std::array<Server, 2> servers_;
};

TEST_F(TwoServersTest, WhatOneCommitsReachesTheRobotsOfBothOnce) {
  const auto a = Connect(0, "a");
  const auto b = Connect(0, "b");
  const auto c = Connect(1, "c");
  for (const auto* robot : {&a, &b, &c}) ASSERT_TRUE((*robot)->ReadSnapshot());
  a->Report(model::ShapeOp{SharedShape("pit")});
  c->Report(model::ObjectOp{SharedObject("dog")});
  ASSERT_TRUE(b->ReadUntilHolds({Shared("dog", "c"), Shared("pit", "a")}));
  ASSERT_TRUE(c->ReadUntilHolds({Shared("pit", "a")}));
  ASSERT_TRUE(a->ReadUntilHolds({Shared("dog", "c")}));
  a->Report(model::ShapeOp{model::Deletion{"pit"}});
  ASSERT_TRUE(c->ReadUntilHolds({}));
  ASSERT_TRUE(b->ReadUntilHolds({Shared("dog", "c")}));
  // Of each server: its receivers' share of three changes, and nothing more.
  EXPECT_EQ(Sample(0, "uplinkd_forwards_due_total"), 4) << "pit and its end to b, dog to a and b";
  EXPECT_EQ(Sample(1, "uplinkd_forwards_due_total"), 2) << "pit and its end to c";
}

// Each server also looks by itself each second; that it need not is seen by what it heard.
TEST_F(TwoServersTest, WhatOneCommitsWakesTheOtherAndNotItself) {
  const auto a = Connect(0, "a");
  const auto c = Connect(1, "c");
  ASSERT_TRUE(c->ReadSnapshot());
  for (const std::string name : {kHeard, "uplinkd_forward_listen_failing"}) {
    EXPECT_EQ(Sample(0, name), 0);
    EXPECT_EQ(Sample(1, name), 0);
  }
  a->Report(model::ShapeOp{SharedShape("pit")});
  ASSERT_TRUE(c->ReadUntilHolds({Shared("pit", "a")}));
  EXPECT_TRUE(Eventually([&] { return Sample(1, kHeard) == 1; })) << Sample(1, kHeard);
  EXPECT_EQ(Sample(0, kHeard), 0);
  database_.Shell().Run(
      "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database()"
      " AND application_name LIKE 'uplinkd%'");
  std::size_t reported = 0;
  std::vector<std::string> held{Shared("pit", "a")};
  // Until both listen again.
  EXPECT_TRUE(Eventually([&] {
    const std::string id = "later " + std::to_string(++reported);
    a->Report(model::ShapeOp{SharedShape(id)});
    held.push_back(Shared(id, "a"));
    return c->ReadUntilHolds(held) && Sample(1, kHeard) > 1;
  }));
  EXPECT_EQ(Sample(0, kHeard), 0);
}

TEST_F(TwoServersTest, AServerThatWasAwayHasWhatTheOtherCommittedMeanwhile) {
  const auto a = Connect(0, "a");
  a->Report(model::ShapeOp{SharedShape("before")});
  servers_[1].process->Signal(SIGKILL);
  ASSERT_TRUE(servers_[1].process->WaitForExit());
  a->Report(model::ShapeOp{SharedShape("meanwhile")});
  a->Report(model::ShapeOp{model::Deletion{"before"}});
  Serve(1);
  const auto c = Connect(1, "c");
  ASSERT_TRUE(c->ReadSnapshot());
  EXPECT_THAT(c->held(), ElementsAre(Shared("meanwhile", "a")));
}

TEST_F(TwoServersTest, ARobotThatMovesKeepsARightTable) {
  auto a = Connect(0, "a");
  auto b = Connect(0, "b");
  a->Report(model::ShapeOp{SharedShape("1")});
  ASSERT_TRUE(b->ReadUntilHolds({Shared("1", "a")}));
  b = Connect(1, "b", 2);
  a->Report(model::ShapeOp{SharedShape("2")});
  ASSERT_TRUE(b->ReadUntilHolds({Shared("1", "a"), Shared("2", "a")}));
  a = Connect(1, "a", 2);
  a->Report(model::ShapeOp{model::Deletion{"1"}});
  ASSERT_TRUE(b->ReadUntilHolds({Shared("2", "a")}));
}

TEST_F(TwoServersTest, AForgottenRobotsItemsAreTakenAway) {
  {
    const auto a = Connect(0, "a");
    a->Report(model::ShapeOp{SharedShape("pit")});
  }
  const auto c = Connect(1, "c");
  ASSERT_TRUE(c->ReadUntilHolds({Shared("pit", "a")}));
  EXPECT_EQ(database_.Shell().Read("DELETE FROM uplinkd.shapes WHERE ruri = '" + SharingRuri("a") +
                                   "' RETURNING id"),
            "pit\n");
  ASSERT_TRUE(c->ReadUntilHolds({}));
}

}  // namespace
}  // namespace uplink::testing
