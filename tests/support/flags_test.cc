#include "tests/support/flags.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kWrongUseMin = 100;

template <typename... Arguments>
std::optional<int> Parse(Flags& flags, Arguments... arguments) {
  const std::array<const char*, sizeof...(arguments) + 1> all = {"program", arguments...};
  return flags.Parse(static_cast<int>(all.size()), all.data());
}

TEST(FlagsTest, AFlagThatIsGivenReplacesItsDefault) {
  std::string store = "fake";
  std::uint64_t seed = 1;
  std::uint32_t steps = 400;
  std::uint16_t port = 1;
  Flags flags("About");
  flags.Add({"--store"}, store);
  flags.Add({"--seed"}, seed);
  flags.Add({"--steps"}, steps);
  flags.Add({"--port"}, port);
  EXPECT_FALSE(Parse(flags, "--seed", "18446744073709551615", "--port", "65535").has_value());
  EXPECT_EQ(seed, 18'446'744'073'709'551'615U);
  EXPECT_EQ(port, 65'535);
  EXPECT_EQ(steps, 400U);
  EXPECT_EQ(store, "fake");
}

TEST(FlagsTest, ANumberKeepsToItsRange) {
  int days = 30;
  std::uint64_t series = 1;
  Flags flags("About");
  flags.Add({"--days"}, days, {1, 250});
  flags.Add({"--series"}, series, {1, 10});
  EXPECT_FALSE(Parse(flags, "--days", "250", "--series", "10").has_value());
  EXPECT_EQ(days, 250);
  EXPECT_EQ(series, 10U);
  ::testing::internal::CaptureStderr();
  EXPECT_GE(Parse(flags, "--days", "251").value_or(0), kWrongUseMin);
  EXPECT_GE(Parse(flags, "--series", "0").value_or(0), kWrongUseMin);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("--days"));
}

TEST(FlagsTest, AChoiceIsOneOfThoseListed) {
  std::string what = "relay";
  Flags flags("About");
  flags.AddChoice({"what"}, what, {"relay", "memory"});
  EXPECT_FALSE(Parse(flags, "memory").has_value());
  EXPECT_EQ(what, "memory");
  ::testing::internal::CaptureStderr();
  EXPECT_GE(Parse(flags, "other").value_or(0), kWrongUseMin);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("other"));
}

TEST(FlagsTest, EachOfSeveralChoicesIsOneOfThoseListed) {
  std::vector<std::string> only;
  Flags flags("About");
  flags.AddChoices({"--only"}, only, {"one", "two", "three"});
  EXPECT_FALSE(Parse(flags, "--only", "two", "--only", "one").has_value());
  EXPECT_THAT(only, ElementsAre("two", "one"));
  ::testing::internal::CaptureStderr();
  EXPECT_GE(Parse(flags, "--only", "one", "--only", "four").value_or(0), kWrongUseMin);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("four"));
}

TEST(FlagsTest, AListTakesEachValueAndASwitchNone) {
  std::vector<std::string> only;
  bool digest = false;
  bool trace = false;
  Flags flags("About");
  flags.Add({"--only"}, only);
  flags.AddSwitch({"--digest"}, digest);
  flags.AddSwitch({"--trace"}, trace);
  EXPECT_FALSE(Parse(flags, "--only", "one", "--only", "two", "--digest").has_value());
  EXPECT_THAT(only, ElementsAre("one", "two"));
  EXPECT_TRUE(digest);
  EXPECT_FALSE(trace);
}

TEST(FlagsTest, WhatIsRequiredAndMissingIsWrongUse) {
  std::string url;
  Flags flags("About");
  flags.Add({"--url", "Where it is", Flag::Need::kRequired}, url);
  ::testing::internal::CaptureStderr();
  EXPECT_GE(Parse(flags).value_or(0), kWrongUseMin);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("--url"));
}

TEST(FlagsTest, HelpIsPrintedAndEndsTheProgramWell) {
  std::string url;
  Flags flags("About it", "uplink_program");
  flags.Add({"--url", "Where it is", Flag::Need::kRequired}, url);
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(Parse(flags, "--help"), 0);
  const std::string help = ::testing::internal::GetCapturedStdout();
  EXPECT_THAT(help, HasSubstr("About it"));
  EXPECT_THAT(help, HasSubstr("uplink_program"));
  EXPECT_THAT(help, HasSubstr("Where it is"));
}

}  // namespace
}  // namespace uplink::testing
