#include "server/admin/command_rate.h"

#include <chrono>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "server/admin/actions.h"
#include "tests/support/manual_clock.h"

namespace uplink::admin {
namespace {

using limits::PolicyId;
using limits::PolicyOf;

Asker Of(const std::string& name, identity::Proof proof = identity::Proof::kToken) {
  return AskerOf({.role = identity::Role::kOperator,
                  .scope = identity::Scope::Of({"north"}),
                  .proof = proof,
                  .name = name},
                 "192.0.2.1");
}

class CommandRateTest : public ::testing::Test {
 protected:
  absl::Status Take(const std::string& name, std::string_view action = kRobotNote) {
    return rate_.Take(Of(name), action, clock_.Steady());
  }
  /// Commands that pass until one does not.
  std::uint64_t Passing(const std::string& name, std::string_view action = kRobotNote) {
    std::uint64_t passed = 0;
    while (Take(name, action).ok()) ++passed;
    return passed;
  }

  testing::ManualClock clock_;
  CommandRate rate_;
};

TEST_F(CommandRateTest, ACallerHasItsShareAndAllTogetherHaveOne) {
  EXPECT_EQ(Passing("a"), PolicyOf(PolicyId::kCommandsOfCaller).at_once);
  EXPECT_TRUE(rate_.Take(Of("a", identity::Proof::kCertificate), kRobotNote, clock_.Steady()).ok())
      << "a certificate of the same name is another caller";
  EXPECT_EQ(Passing("b") + Passing("c"), PolicyOf(PolicyId::kCommands).at_once -
                                             PolicyOf(PolicyId::kCommandsOfCaller).at_once - 1);
  EXPECT_EQ(std::string(Take("d").message()),
            "all callers together may give 20 commands about robots per second, 40 at once");
  clock_.Advance(std::chrono::seconds(1));
  EXPECT_EQ(Passing("a"), PolicyOf(PolicyId::kCommandsOfCaller).most);
}

TEST_F(CommandRateTest, ARefusedCommandTakesNothing) {
  Passing("a");
  for (int i = 0; i < 1'000; ++i) EXPECT_FALSE(Take("a").ok());
  EXPECT_GT(Passing("b"), 0U);
}

TEST_F(CommandRateTest, AHundredRevocationsPassAtOnceWhateverOperatorsDo) {
  Passing("a");
  Passing("b");
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(Take("a", kCertificateRevoke).ok()) << i;
  EXPECT_EQ(Passing("a", kReload), PolicyOf(PolicyId::kAdminCommands).at_once - 100);
  const auto again = RetryAfterOf(Take("a", kCertificateUnrevoke));
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, std::chrono::seconds(1));
}

TEST_F(CommandRateTest, CallersAreForgottenAndAllTogetherStayBounded) {
  for (std::size_t i = 0; i < 2 * PolicyOf(PolicyId::kCommandsOfCaller).keys_max; ++i) {
    clock_.Advance(std::chrono::seconds(1));
    EXPECT_TRUE(Take(std::to_string(i)).ok());
  }
}

TEST(RetryAfter, OtherFailuresHaveNone) {
  EXPECT_FALSE(RetryAfterOf(absl::OkStatus()));
  EXPECT_FALSE(RetryAfterOf(absl::ResourceExhaustedError("a bound")));
}

}  // namespace
}  // namespace uplink::admin
