#include "server/rpc/callers.h"

#include <memory>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/http/probe.h"
#include "server/log/logger.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::rpc {
namespace {

using identity::Role;
using ::testing::HasSubstr;

class Callers : public ::testing::Test {
 protected:
  static transport::CallerProof Certificate(Role role) {
    return {.identity = identity::PeerIdentity{.role = role, .fleet = "north"},
            .subject = "CN=anna",
            .expiry = FromUnixMs(4'000'000'000'000),
            .from = "192.0.2.7:4711"};
  }
  [[nodiscard]] absl::StatusOr<identity::Caller> Ask(const transport::CallerProof& proof,
                                                     std::string_view path = "/api/v1/robots") {
    return CallerOf(guard_, nullptr, RouteOf(path), proof);
  }

  testing::ManualClock clock_;
  log::Logger logger_{std::make_unique<testing::NoLines>(), clock_, log::Format::kText,
                      log::Level::kInfo};
  http::HttpProbe probe_;
  /// HTTP itself asks for no proof: it listens on this machine alone.
  http::Guard guard_{{clock_, logger_, probe_}, {.asks = false}};
};

TEST_F(Callers, ShowWhoTheyAreThoughHttpDoesNotAsk) {
  EXPECT_EQ(Ask({}).status().code(), absl::StatusCode::kUnauthenticated);
  EXPECT_EQ(Ask({.authorization = "Bearer uplinkd_x"}).status().code(),
            absl::StatusCode::kUnauthenticated);
  EXPECT_TRUE(Ask({}, "/livez").ok());
}

TEST_F(Callers, AnOperatorsCertificateSaysWhoAndWhichFleet) {
  const auto caller = Ask(Certificate(Role::kViewer));
  ASSERT_TRUE(caller.ok()) << caller.status();
  EXPECT_EQ(caller->name, "CN=anna");
  EXPECT_EQ(caller->scope, identity::Scope::Of({"north"}));
  EXPECT_EQ(Ask(Certificate(Role::kViewer), "/api/v1/config").status().code(),
            absl::StatusCode::kPermissionDenied);
}

TEST_F(Callers, ARobotsCertificateIsToldItsRole) {
  for (const Role role : {Role::kRobot, Role::kGateway}) {
    const auto caller = Ask(Certificate(role));
    EXPECT_EQ(caller.status().code(), absl::StatusCode::kPermissionDenied);
    EXPECT_THAT(std::string(caller.status().message()),
                HasSubstr("has the role " + std::string(ToText(role))));
  }
}

TEST_F(Callers, AFlawOfTheCertificateIsTold) {
  transport::CallerProof proof = Certificate(Role::kViewer);
  proof.identity = absl::UnauthenticatedError("client certificate: it has a flaw");
  EXPECT_EQ(Ask(proof).status(), absl::UnauthenticatedError("client certificate: it has a flaw"));
}

TEST_F(Callers, ATokenGoesBeforeACertificate) {
  transport::CallerProof proof = Certificate(Role::kViewer);
  proof.authorization = "Bearer uplinkd_x";
  EXPECT_EQ(Ask(proof).status().code(), absl::StatusCode::kUnauthenticated);
}

TEST(CallersText, AnAddressComesWithoutItsPort) {
  EXPECT_EQ(WithoutPort("192.0.2.7:4711"), "192.0.2.7");
  EXPECT_EQ(WithoutPort("[2001:db8::7]:4711"), "2001:db8::7");
  EXPECT_EQ(WithoutPort("unknown"), "unknown");
}

}  // namespace
}  // namespace uplink::rpc
