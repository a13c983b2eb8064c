#include "server/relay/gate.h"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::relay {
namespace {

using ::testing::HasSubstr;

TEST(Gate, AdmitsUpToItsBound) {
  Gate gate(2);
  EXPECT_TRUE(gate.Enter().ok());
  EXPECT_TRUE(gate.Enter().ok());
  const absl::Status status = gate.Enter();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("admits no more streams"));
  EXPECT_EQ(gate.streams(), 2U);
}

TEST(Gate, AdmitsAgainWhenOneLeft) {
  Gate gate(1);
  EXPECT_TRUE(gate.Enter().ok());
  gate.Leave();
  EXPECT_TRUE(gate.Enter().ok());
}

TEST(Gate, ClosedAdmitsNobody) {
  Gate gate(2);
  gate.Close();
  const absl::Status status = gate.Enter();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(std::string(status.message()), "the server drains");
  EXPECT_EQ(gate.streams(), 0U);
}

TEST(Gate, WaitsUntilTheLastHasLeft) {
  Gate gate(2);
  ASSERT_TRUE(gate.Enter().ok());
  EXPECT_FALSE(gate.WaitEmpty(milliseconds(1)));
  const std::jthread leaver([&gate] { gate.Leave(); });
  EXPECT_TRUE(gate.WaitEmpty(std::chrono::seconds(20)));
}

}  // namespace
}  // namespace uplink::relay
