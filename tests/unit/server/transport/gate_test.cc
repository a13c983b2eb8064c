#include "server/transport/gate.h"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::transport {
namespace {

using ::testing::HasSubstr;

TEST(Gate, AdmitsUpToItsBound) {
  RelayProbe probe;
  Gate gate({.streams_max = 2}, probe);
  EXPECT_TRUE(gate.Enter({}).ok());
  EXPECT_TRUE(gate.Enter({}).ok());
  const absl::Status status = gate.Enter({});
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("admits no more streams"));
  EXPECT_EQ(gate.streams(), 2U);
}

TEST(Gate, AdmitsAFewOfOneCertificate) {
  RelayProbe probe;
  Gate gate({.streams_max = 100}, probe);
  for (std::size_t i = 0; i < kStreamsPerCertificateMax; ++i)
    EXPECT_TRUE(gate.Enter({.robot = "a"}).ok());
  const absl::Status status = gate.Enter({.robot = "a"});
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("of this certificate: it has 8"));
  EXPECT_TRUE(gate.Enter({.robot = "b"}).ok()) << "others are not refused for it";
  gate.Leave({.robot = "a"});
  EXPECT_TRUE(gate.Enter({.robot = "a"}).ok());
  EXPECT_EQ(gate.streams(), kStreamsPerCertificateMax + 1);
}

TEST(Gate, AdmitsAsManyOfAGatewayAsFourFullConnectionsHold) {
  RelayProbe probe;
  Gate gate({.streams_max = 100, .gateway_streams_max = 2}, probe);
  const Entrant gateway{.gateway = "g"};
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(gate.Enter(gateway).ok());
  const absl::Status status = gate.Enter(gateway);
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(std::string(status.message()),
            "the server admits no more streams of gateway g: it has 8 (limits.gateway_streams_max, "
            "limits.robots_max)");
  EXPECT_EQ(probe.refused_gateway_total.value(), 1);
  EXPECT_EQ(probe.gateway_streams.value(), 8);
  EXPECT_TRUE(gate.Enter({.gateway = "another"}).ok());
  EXPECT_TRUE(gate.Enter({.robot = "a"}).ok()) << "others are not refused for it";
  EXPECT_EQ(probe.gateway_streams.value(), 9);
  gate.Leave(gateway);
  EXPECT_EQ(probe.gateway_streams.value(), 8);
  EXPECT_TRUE(gate.Enter(gateway).ok());
}

TEST(Gate, CallsTakeNoPlacesOfStreamsAndAreBoundedBesides) {
  RelayProbe probe;
  Gate gate({.streams_max = 1}, probe);
  const Entrant robot{.robot = "a"};
  for (std::size_t i = 0; i < kCallsPerCertificateMax; ++i) {
    ASSERT_TRUE(gate.Enter(robot, Admission::kCall).ok()) << i;
  }
  const absl::Status status = gate.Enter(robot, Admission::kCall);
  EXPECT_EQ(std::string(status.message()),
            "the server admits no more calls of this certificate: it has 256");
  EXPECT_TRUE(gate.Enter(robot).ok());
  EXPECT_EQ(gate.streams(), kCallsPerCertificateMax + 1);
  gate.Leave(robot, Admission::kCall);
  EXPECT_TRUE(gate.Enter(robot, Admission::kCall).ok());
}

TEST(Gate, ChecksOfTheHealthTakeNoPlacesOfOthers) {
  RelayProbe probe;
  Gate gate({.streams_max = 1}, probe);
  for (std::size_t i = 0; i < kCallsMaxAtLeast; ++i) {
    ASSERT_TRUE(gate.Enter({}, Admission::kHealth).ok()) << i;
  }
  EXPECT_EQ(std::string(gate.Enter({}, Admission::kHealth).message()),
            "the server admits no more health checks: it has 1024");
  EXPECT_TRUE(gate.Enter({}, Admission::kCall).ok());
  EXPECT_TRUE(gate.Enter({}).ok());
  EXPECT_EQ(gate.streams(), kCallsMaxAtLeast + 2);
  gate.Leave({}, Admission::kHealth);
  EXPECT_TRUE(gate.Enter({}, Admission::kHealth).ok());
}

TEST(Gate, AGatewayHasAsManyCallsAsFourFullConnectionsHold) {
  RelayProbe probe;
  Gate gate({.streams_max = 10'000, .gateway_streams_max = 256}, probe);
  const Entrant gateway{.gateway = "g"};
  for (int i = 0; i < 1024; ++i) ASSERT_TRUE(gate.Enter(gateway, Admission::kCall).ok());
  EXPECT_EQ(gate.Enter(gateway, Admission::kCall).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(probe.gateway_streams.value(), 0);
  EXPECT_TRUE(gate.Enter(gateway).ok());
}

TEST(Gate, LeavesAQuarterOfTheStreamsToOthers) {
  RelayProbe probe;
  EXPECT_EQ(Gate({.streams_max = 1, .gateway_streams_max = 256}, probe).per_gateway_max(), 1U);
  EXPECT_EQ(Gate({.streams_max = 100, .gateway_streams_max = 256}, probe).per_gateway_max(), 75U);
  EXPECT_EQ(Gate({.streams_max = 40'000, .gateway_streams_max = 256}, probe).per_gateway_max(),
            1'024U);
}

TEST(Gate, KnowsWhoseCertificateItIs) {
  using identity::Role;
  const identity::PeerIdentity robot{.role = Role::kRobot, .fleet = "f", .ruri = "rcan://a"};
  EXPECT_EQ(EntrantOf(robot).robot, "rcan://a");
  EXPECT_EQ(EntrantOf(robot).gateway, "");
  const identity::PeerIdentity gateway{
      .role = Role::kGateway, .fleet = "f", .gateway = {.subject = "CN=g", .ruris = {"rcan://a"}}};
  EXPECT_EQ(EntrantOf(gateway).robot, "");
  EXPECT_EQ(EntrantOf(gateway).gateway, "CN=g");
  EXPECT_EQ(EntrantOf({.role = Role::kViewer, .fleet = "f"}).robot, "");
}

TEST(Gate, AdmitsAgainWhenOneLeft) {
  RelayProbe probe;
  Gate gate({.streams_max = 1}, probe);
  EXPECT_TRUE(gate.Enter({}).ok());
  gate.Leave({});
  EXPECT_TRUE(gate.Enter({}).ok());
}

TEST(Gate, ClosedAdmitsNobody) {
  RelayProbe probe;
  Gate gate({.streams_max = 2}, probe);
  gate.Close();
  const absl::Status status = gate.Enter({});
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(std::string(status.message()), "the server drains");
  EXPECT_EQ(gate.streams(), 0U);
}

TEST(Gate, WaitsUntilTheLastHasLeft) {
  RelayProbe probe;
  Gate gate({.streams_max = 2}, probe);
  ASSERT_TRUE(gate.Enter({}).ok());
  EXPECT_FALSE(gate.WaitEmpty(milliseconds(1)));
  const std::jthread leaver([&gate] { gate.Leave({}); });
  EXPECT_TRUE(gate.WaitEmpty(std::chrono::seconds(20)));
}

}  // namespace
}  // namespace uplink::transport
