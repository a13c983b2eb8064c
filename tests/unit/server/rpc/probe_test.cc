#include "server/rpc/probe.h"

#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/server_world.h"

namespace uplink::rpc {
namespace {

using ::testing::HasSubstr;

TEST(RpcProbe, CountsACallByWhatCameOfIt) {
  EXPECT_EQ(OutcomeOf(absl::StatusCode::kOk), CallOutcome::kOk);
  EXPECT_EQ(OutcomeOf(absl::StatusCode::kUnauthenticated), CallOutcome::kDenied);
  EXPECT_EQ(OutcomeOf(absl::StatusCode::kPermissionDenied), CallOutcome::kDenied);
  EXPECT_EQ(OutcomeOf(absl::StatusCode::kNotFound), CallOutcome::kWrong);
  EXPECT_EQ(OutcomeOf(absl::StatusCode::kUnavailable), CallOutcome::kFailed);
  EXPECT_EQ(OutcomeOf(absl::StatusCode::kResourceExhausted), CallOutcome::kFailed);
  EXPECT_EQ(OutcomeOf(absl::StatusCode::kCancelled), CallOutcome::kBroken);
  EXPECT_EQ(OutcomeOf(std::nullopt), CallOutcome::kBroken);
}

TEST(RpcProbe, EachMethodHasItsSeries) {
  testing::ServerWorld world;
  CountedIn(world.rpc_probe.view[0])(absl::StatusCode::kOk);
  CountedIn(world.rpc_probe.Of(OtherMethod::kWatchRobots))(std::nullopt);
  world.rpc_probe.listener.connections.Set(3);
  const std::string text = world.ScrapeText();
  for (const std::string line : {
           R"(uplinkd_fleet_rpc_calls_total{method="ListRobots",outcome="ok"} 1)",
           R"(uplinkd_fleet_rpc_calls_total{method="ListRobots",outcome="denied"} 0)",
           R"(uplinkd_fleet_rpc_calls_total{method="Reload",outcome="wrong"} 0)",
           R"(uplinkd_fleet_rpc_calls_total{method="WatchRobots",outcome="broken"} 1)",
           R"(uplinkd_fleet_rpc_calls_total{method="HealthCheck",outcome="failed"} 0)",
           "uplinkd_fleet_rpc_connections 3",
           R"(uplinkd_fleet_rpc_connections_turned_away_total{cause="untrusted"} 0)",
       }) {
    EXPECT_THAT(text, HasSubstr("\n" + line + "\n"));
  }
}

TEST(RpcProbe, DeniedCertificatesAreCountedOverBothListenersOfGrpc) {
  testing::ServerWorld world;
  world.relay_probe.denied_total[0].Add();
  world.rpc_probe.listener.denied_total[0].Add(2);
  EXPECT_THAT(world.ScrapeText(),
              HasSubstr("\nuplinkd_certificates_denied_total{why=\"revoked\"} 3\n"));
}

}  // namespace
}  // namespace uplink::rpc
