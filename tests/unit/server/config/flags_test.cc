#include "server/config/flags.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::config {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kWrongUse = 2;

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

/// What Parse complains of.
template <typename... Arguments>
std::string WrongUse(Flags& flags, Arguments... arguments) {
  const std::array<const char*, sizeof...(arguments) + 1> all = {"program", arguments...};
  std::string wrong;
  EXPECT_EQ(flags.Parse(static_cast<int>(all.size()), all.data(),
                        [&wrong](const std::string& text) { wrong = text; }),
            kWrongUse);
  return wrong;
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
  EXPECT_EQ(Parse(flags, "--days", "251"), kWrongUse);
  EXPECT_EQ(Parse(flags, "--series", "0"), kWrongUse);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("--days"));
}

TEST(FlagsTest, AChoiceIsOneOfThoseListed) {
  std::string what = "relay";
  Flags flags("About");
  flags.AddChoice({"what"}, what, {"relay", "memory"});
  EXPECT_FALSE(Parse(flags, "memory").has_value());
  EXPECT_EQ(what, "memory");
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(Parse(flags, "other"), kWrongUse);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("other"));
}

TEST(FlagsTest, EachOfSeveralChoicesIsOneOfThoseListed) {
  std::vector<std::string> only;
  Flags flags("About");
  flags.AddChoices({"--only"}, only, {"one", "two", "three"});
  EXPECT_FALSE(Parse(flags, "--only", "two", "--only", "one").has_value());
  EXPECT_THAT(only, ElementsAre("two", "one"));
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(Parse(flags, "--only", "one", "--only", "four"), kWrongUse);
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
  EXPECT_EQ(Parse(flags), kWrongUse);
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

TEST(FlagsTest, HelpShowsDefaultsThatAreInRange) {
  std::string store = "fake";
  int days = 30;
  int count = 0;
  Flags flags("About");
  flags.Add({"--store"}, store);
  flags.Add({"--days"}, days, {1, 250});
  flags.Add({"--count"}, count, {1, 5});
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(Parse(flags, "--help"), 0);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("=fake"), HasSubstr("[1 - 250]=30"), HasSubstr("[1 - 5]"),
                    Not(HasSubstr("[1 - 5]="))));
}

TEST(FlagsTest, TheTreeOfTheHelpIsJsonWithFlagsGroupsAndCommands) {
  std::string url;
  std::string file = "a \"b\" \\";
  int days = 30;
  bool force = false;
  Flags flags("About\nit", "uplink_program");
  Flags& verb = flags.AddCommand("verb", "A verb", [] { return 1; });
  verb.Add({"--url", "Where it is"}, url);
  verb.Add({"--file"}, file);
  verb.ExactlyOne("target", {"--url", "--file"});
  verb.Add({"--days", "How long", Flag::Need::kRequired}, days, {1, 250});
  verb.AddSwitch({"--force"}, force);
  std::string ruri;
  verb.Add({"RURI", "The robot"}, ruri);
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(Parse(flags, "--help-tree"), 0);
  const std::string tree = ::testing::internal::GetCapturedStdout();
  EXPECT_THAT(tree,
              AllOf(HasSubstr(R"("about":"About\nit")"), HasSubstr(R"("default":"a \"b\" \\")"),
                    HasSubstr(R"("takes":"INT:INT in [1 - 250]","default":"","required":true)"),
                    HasSubstr(R"({"names":["--force"],"position":"","takes":"","default":"")"),
                    HasSubstr(R"("position":"RURI")"), HasSubstr(R"("exactlyOneOf":[{"name":"")")));
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(Parse(flags, "verb", "--help-tree"), kWrongUse);
  ::testing::internal::GetCapturedStderr();
}

TEST(FlagsTest, TheVersionIsOneLine) {
  Flags flags("About", "uplink_program", "1.2.3");
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(Parse(flags, "--version"), 0);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "uplink_program 1.2.3\n");
}

TEST(FlagsTest, ATextKeepsToItsForm) {
  std::string port = "1";
  std::string wrong;
  Flags flags("About");
  flags.Add({"--port"}, port, {"PORT", [](const std::string& text) {
                                 return text == "2" ? std::string() : text + " is no port";
                               }});
  EXPECT_EQ(Parse(flags), std::nullopt);
  EXPECT_FALSE(flags.Given("--port"));
  EXPECT_EQ(Parse(flags, "--port", "2"), std::nullopt);
  EXPECT_TRUE(flags.Given("--port"));
  const std::array<const char*, 3> arguments = {"program", "--port", "3"};
  EXPECT_EQ(flags.Parse(3, arguments.data(), [&wrong](const std::string& text) { wrong = text; }),
            kWrongUse);
  EXPECT_THAT(wrong, HasSubstr("--port: 3 is no port"));
}

TEST(FlagsTest, AGroupOfFlagsTakesAtMostOneOrExactlyOne) {
  std::string url;
  std::string file;
  bool check = false;
  bool print = false;
  Flags flags("About");
  flags.Add({"--url"}, url);
  flags.Add({"--file"}, file);
  flags.ExactlyOne("target", {"--url", "--file"});
  flags.AddSwitch({"--check"}, check);
  flags.AddSwitch({"--print"}, print);
  flags.AtMostOne({"--check", "--print"});
  EXPECT_EQ(Parse(flags, "--url", "here", "--check"), std::nullopt);
  EXPECT_EQ(url, "here");
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(Parse(flags), kWrongUse);
  EXPECT_EQ(Parse(flags, "--url", "here", "--file", "there"), kWrongUse);
  EXPECT_EQ(Parse(flags, "--url", "here", "--check", "--print"), kWrongUse);
  ::testing::internal::GetCapturedStderr();
}

TEST(FlagsTest, ParseRunsTheCommandThatIsChosenWithItsFlags) {
  int count = 0;
  Flags flags("About");
  Flags& noun = flags.AddCommand("noun", "A noun");
  noun.AddCommand("verb", "A verb", [&count] { return count; }).Add({"--count"}, count);
  noun.AddCommand("other", "Another one", [] { return 1; });
  EXPECT_EQ(Parse(flags, "noun", "verb", "--count", "7"), 7);
  EXPECT_EQ(Parse(flags, "noun", "other"), 1);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(Parse(flags), kWrongUse);
  EXPECT_EQ(Parse(flags, "noun"), kWrongUse);
  ::testing::internal::GetCapturedStderr();
}

TEST(FlagsTest, AnUnknownFlagIsToldTheNearestOrWhereTheListIs) {
  std::string url;
  Flags flags("About", "program");
  flags.Add({"--url", "Where it is", Flag::Need::kRequired}, url);
  EXPECT_EQ(WrongUse(flags, "--ulr", "here"),
            "program: --ulr: unknown flag; did you mean --url?\n");
  EXPECT_EQ(WrongUse(flags, "--nonsense=1"),
            "program: --nonsense: unknown flag; program --help lists those that it has\n");
  EXPECT_EQ(Parse(flags, "--url", "--nonsense"), std::nullopt) << "a value may look like a flag";
}

TEST(FlagsTest, AnUnknownCommandIsToldTheNearestOrWhereTheListIs) {
  std::string url;
  std::string file;
  Flags flags("About", "program");
  Flags& noun = flags.AddCommand("robots", "Robots");
  Flags& verb = noun.AddCommand("show", "Show them", [] { return 0; });
  verb.Add({"--url"}, url);
  verb.Add({"--file"}, file);
  verb.ExactlyOne("target", {"--url", "--file"});
  EXPECT_EQ(WrongUse(flags, "robot"), "program: robot: unknown command; did you mean robots?\n");
  EXPECT_EQ(WrongUse(flags, "robots", "destroy"),
            "program: robots destroy: unknown command; program robots --help lists those that it "
            "has\n");
  EXPECT_EQ(WrongUse(flags, "robots", "show", "--flie", "x"),
            "program: --flie: unknown flag; did you mean --file?\n");
  EXPECT_EQ(WrongUse(flags, "robots"),
            "program: a command is missing; program robots --help shows what it takes\n");
}

TEST(FlagsTest, WrongUseSaysWhatIsAllowed) {
  std::string url;
  std::string file;
  std::string what = "relay";
  int days = 30;
  double rate = 1;
  bool check = false;
  bool print = false;
  Flags flags("About", "program");
  flags.Add({"--days"}, days, {1, 250});
  flags.Add({"--rate"}, rate, {0.1, 1'000'000});
  flags.AddChoice({"--what"}, what, {"relay", "memory"});
  flags.Add({"--url"}, url);
  flags.Add({"--file"}, file);
  flags.ExactlyOne("target", {"--url", "--file"});
  flags.AddSwitch({"--check"}, check);
  flags.AddSwitch({"--print"}, print);
  flags.AtMostOne({"--check", "--print"});
  EXPECT_THAT(WrongUse(flags, "--days", "251"),
              HasSubstr("--days: 251 is not allowed; it must be a number from 1 to 250"));
  EXPECT_THAT(WrongUse(flags, "--rate", "none"), HasSubstr("a number from 0.1 to 1000000"));
  EXPECT_THAT(WrongUse(flags, "--what", "mem0ry"), HasSubstr("; did you mean memory?"));
  EXPECT_THAT(WrongUse(flags, "--what", "disk"), HasSubstr("it must be one of relay, memory"));
  EXPECT_THAT(WrongUse(flags), HasSubstr("program: give either --url or --file; program --help"));
  EXPECT_THAT(WrongUse(flags, "--url", "a", "--file", "b"),
              HasSubstr("give either --url or --file"));
  EXPECT_THAT(WrongUse(flags, "--url", "a", "--check", "--print"),
              HasSubstr("--check excludes --print: give one of the two"));
  EXPECT_THAT(WrongUse(flags, "--url"), HasSubstr("--url: a value is missing behind it"));
}

TEST(FlagsTest, HelpEndsWithTheExamples) {
  Flags flags("About", "program");
  Flags& verb = flags.AddCommand("verb", "A verb", [] { return 0; });
  verb.Example("program verb --count 3");
  verb.Example("program verb --count 4");
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(Parse(flags, "verb", "--help"), 0);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(),
              HasSubstr("Examples:\n  program verb --count 3\n  program verb --count 4\n"));
}

}  // namespace
}  // namespace uplink::config
