#include "server/transport/gate.h"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::transport {
namespace {

using ::testing::HasSubstr;

TEST(Gate, AdmitsUpToItsBound) {
  RelayProbe probe;
  Gate gate(2, probe);
  EXPECT_TRUE(gate.Enter("").ok());
  EXPECT_TRUE(gate.Enter("").ok());
  const absl::Status status = gate.Enter("");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("admits no more streams"));
  EXPECT_EQ(gate.streams(), 2U);
}

TEST(Gate, AdmitsAFewOfOneCertificate) {
  RelayProbe probe;
  Gate gate(100, probe);
  for (std::size_t i = 0; i < kStreamsPerCertificateMax; ++i) EXPECT_TRUE(gate.Enter("a").ok());
  const absl::Status status = gate.Enter("a");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("of this certificate: it has 8"));
  EXPECT_TRUE(gate.Enter("b").ok()) << "others are not refused for it";
  gate.Leave("a");
  EXPECT_TRUE(gate.Enter("a").ok());
  EXPECT_EQ(gate.streams(), kStreamsPerCertificateMax + 1);
}

TEST(Gate, AdmitsAgainWhenOneLeft) {
  RelayProbe probe;
  Gate gate(1, probe);
  EXPECT_TRUE(gate.Enter("").ok());
  gate.Leave("");
  EXPECT_TRUE(gate.Enter("").ok());
}

TEST(Gate, ClosedAdmitsNobody) {
  RelayProbe probe;
  Gate gate(2, probe);
  gate.Close();
  const absl::Status status = gate.Enter("");
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(std::string(status.message()), "the server drains");
  EXPECT_EQ(gate.streams(), 0U);
}

TEST(Gate, WaitsUntilTheLastHasLeft) {
  RelayProbe probe;
  Gate gate(2, probe);
  ASSERT_TRUE(gate.Enter("").ok());
  EXPECT_FALSE(gate.WaitEmpty(milliseconds(1)));
  const std::jthread leaver([&gate] { gate.Leave(""); });
  EXPECT_TRUE(gate.WaitEmpty(std::chrono::seconds(20)));
}

}  // namespace
}  // namespace uplink::transport
