#include "server/http/routes.h"

#include <set>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/admin/actions.h"
#include "server/http/probe.h"
#include "server/http/rights.h"

namespace uplink::http {
namespace {

using ::testing::ElementsAre;

// Dashboards depend on these.
TEST(Routes, HaveTheLabelsOfTheMetrics) {
  std::vector<std::string_view> names;
  for (std::size_t id = 0; id < RouteIds(); ++id) names.push_back(RouteName({id}));
  EXPECT_THAT(names,
              ElementsAre("livez", "readyz", "metrics", "metrics_robots", "status", "openapi",
                          "config", "robots", "robot", "robot_by_ruri", "robot_story", "watch",
                          "fleets", "top", "candidates", "events", "messages", "connections",
                          "presence", "quarantine", "gaps", "scope_updates", "faults", "missions",
                          "mission_reports", "operator_requests", "shapes", "objects", "audit",
                          "revocations", "robot_block", "robot_unblock", "robot_disconnect",
                          "robot_note", "robot_add", "fault_acknowledge", "certificate_revoke",
                          "certificate_unrevoke", "reload", "other"));
}

TEST(Routes, EachPathAndLabelStandsThereOnce) {
  std::set<std::string_view> patterns;
  std::set<std::string_view> names{RouteName(OtherRoute())};
  for (const Route& route : Routes()) {
    EXPECT_TRUE(patterns.insert(route.pattern).second) << route.pattern;
    EXPECT_TRUE(names.insert(route.name).second) << route.name;
  }
}

// The only place beside the table that says so: who changes one looks at the other.
TEST(Routes, NeedWhatTheTableOfRightsSays) {
  using std::string_view_literals::operator""sv;
  for (const Route& route : Routes()) {
    const bool data = route.pattern.starts_with("/api/v1/");
    Needs needs{data ? Right::kRead : Right::kScrape};
    if (route.pattern == "/livez"sv || route.pattern == "/readyz"sv) needs = {Right::kAnyone};
    if (route.pattern == "/api/v1/config"sv) needs.right = Right::kOperate;
    needs.whole = route.pattern == "/api/v1/config"sv || route.pattern == "/api/v1/status"sv ||
                  route.pattern == "/metrics"sv;
    const bool administers = route.pattern == "/api/v1/audit"sv ||
                             route.pattern == "/api/v1/reload"sv ||
                             route.pattern.starts_with("/api/v1/certificates/");
    if (administers) {
      needs = {Right::kAdminister, true};
    } else if (!route.action.empty()) {
      needs = {Right::kCommand, route.pattern == "/api/v1/robot/add"sv};
    }
    EXPECT_EQ(route.needs.right, needs.right) << route.pattern;
    EXPECT_EQ(route.needs.whole, needs.whole) << route.pattern;
  }
}

TEST(Routes, OperatorsCommandAndAdminsAdminister) {
  using identity::Role;
  EXPECT_FALSE(Has(Role::kMetrics, Right::kCommand));
  EXPECT_FALSE(Has(Role::kViewer, Right::kCommand));
  EXPECT_TRUE(Has(Role::kOperator, Right::kCommand));
  EXPECT_FALSE(Has(Role::kOperator, Right::kAdminister));
  EXPECT_TRUE(Has(Role::kAdmin, Right::kAdminister));
}

// CommandRate goes by the action's class: admins' commands have a share of their own.
TEST(Routes, GiveEachCommandToThoseWhoseShareItTakes) {
  for (const Route& route : Routes()) {
    if (route.action.empty()) continue;
    const bool is_admins = route.needs.right == Right::kAdminister;
    EXPECT_EQ(admin::GivenByOf(route.action),
              is_admins ? admin::GivenBy::kAdmins : admin::GivenBy::kOperators)
        << route.pattern;
  }
}

TEST(Routes, AProbeCountsEachAndAllOthers) {
  HttpProbe probe;
  ASSERT_EQ(probe.requests.size(), RouteIds());
  probe.CountRequest({0}, 200);
  probe.CountRequest({0}, 304);
  probe.CountRequest(OtherRoute(), 404);
  probe.CountRequest(OtherRoute(), 503);
  EXPECT_EQ(probe.requests.front()[0].value(), 1);
  EXPECT_EQ(probe.requests.front()[1].value(), 1);
  EXPECT_EQ(probe.requests.back()[2].value(), 1);
  EXPECT_EQ(probe.requests.back()[3].value(), 1);
}

}  // namespace
}  // namespace uplink::http
