#include "server/http/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::http {
namespace {

using ::testing::ElementsAre;

TEST(Parameters, ReadsWhatIsThereAndDefaultsTheRest) {
  Parameters parameters(
      "ruri=rcan%3A%2F%2Fa&active=true&pageSize=7&from=1970-01-01T00:00:00.012Z&parts=a,,b&x=y&t=");
  EXPECT_EQ(parameters.Text("ruri"), "rcan://a");
  EXPECT_TRUE(parameters.Flag("active"));
  EXPECT_EQ(parameters.Number("pageSize", 100, 1000), 7U);
  EXPECT_EQ(parameters.Time("from"), FromUnixMs(12));
  EXPECT_EQ(parameters.Time("to"), std::nullopt);
  EXPECT_THAT(parameters.Words("parts"), ElementsAre("a", "b"));
  EXPECT_EQ(parameters.Text("x"), "y");
  EXPECT_EQ(parameters.TextOrEmpty("t"), "");
  EXPECT_EQ(parameters.Text("fleet"), "");
  EXPECT_FALSE(parameters.Problem());
}

TEST(Parameters, NamesAParameterThatNothingReads) {
  Parameters parameters("pagesize=7");
  EXPECT_EQ(parameters.Number("pageSize", 100, 1000), 100U);
  ASSERT_TRUE(parameters.Problem());
  EXPECT_EQ(parameters.Problem()->field, "pagesize");
}

struct NumberCase {
  const char* query;
  bool good;
};
class ParametersNumber : public ::testing::TestWithParam<NumberCase> {};

TEST_P(ParametersNumber, IsAWholeNumberFromOneToTheMost) {
  Parameters parameters(GetParam().query);
  const std::uint32_t number = parameters.Number("pageSize", 100, 1000);
  EXPECT_EQ(parameters.Problem().has_value(), !GetParam().good) << number;
  if (!GetParam().good) {
    EXPECT_EQ(parameters.Problem()->field, "pageSize");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Bounds, ParametersNumber,
    ::testing::Values(NumberCase{"pageSize=1", true}, NumberCase{"pageSize=1000", true},
                      NumberCase{"pageSize=", false}, NumberCase{"pageSize=0", false},
                      NumberCase{"pageSize=1001", false}, NumberCase{"pageSize=-1", false},
                      NumberCase{"pageSize=1x", false}, NumberCase{"pageSize=99999999999", false}));

TEST(Parameters, TakesTimesOfRfc3339Alone) {
  for (const char* query : {"from=1777636800000", "from=2026-05-01", "from=yesterday"}) {
    Parameters parameters(query);
    EXPECT_EQ(parameters.Time("from"), std::nullopt);
    ASSERT_TRUE(parameters.Problem()) << query;
    EXPECT_EQ(parameters.Problem()->message,
              "must be a time of RFC 3339, such as 2026-05-01T12:00:00Z");
  }
  for (const char* query : {"from=2026-05-01T12:00:00Z", "from=2026-05-01T14:00:00%2B02:00",
                            "from=2026-05-01T14:00:00+02:00"}) {
    Parameters parameters(query);
    EXPECT_EQ(parameters.Time("from"), FromUnixMs(1'777'636'800'000)) << query;
    EXPECT_FALSE(parameters.Problem()) << query;
  }
}

TEST(Parameters, RefusesWordsThatAreNoFlag) {
  Parameters parameters("active=yes");
  EXPECT_FALSE(parameters.Flag("active"));
  EXPECT_EQ(parameters.Problem()->field, "active");
}

TEST(Parameters, RefusesANameGivenTwiceAndBrokenEncoding) {
  Parameters twice("a=1&a=2");
  static_cast<void>(twice.Text("a"));
  EXPECT_EQ(twice.Problem()->message, "is given twice");
  EXPECT_EQ(Parameters("a=%4").Problem()->field, "a");
}

TEST(Parameters, TakesOneThatMayBeRepeatedAsOftenAsItsBoundSays) {
  std::string query;
  for (std::size_t i = 0; i < kRepeatsMax; ++i) query += "a=" + std::to_string(i) + "&";
  Parameters most(query + "b=x");
  const std::vector<std::string> texts = most.Texts("a");
  ASSERT_EQ(texts.size(), kRepeatsMax);
  EXPECT_EQ(texts.back(), std::to_string(kRepeatsMax - 1));
  EXPECT_EQ(most.Text("b"), "x");
  EXPECT_FALSE(most.Problem());
  EXPECT_EQ(Parameters(query + "a=more").Problem()->message, "is given more than 100 times");
  EXPECT_TRUE(Parameters("b=x").Texts("a").empty());
}

TEST(Parameters, TellsWhatAPathTakes) {
  Parameters parameters("c=1");
  static_cast<void>(parameters.Text("a"));
  static_cast<void>(parameters.Flag("b"));
  EXPECT_EQ(parameters.Problem()->message, "is not a parameter of this path; this path takes a, b");
  EXPECT_EQ(parameters.Problem()->message, "is not a parameter of this path; this path takes a, b");
  EXPECT_EQ(Parameters("c=1").Problem()->message,
            "is not a parameter of this path, which takes none");
}

TEST(Parameters, AreNotEmpty) {
  const auto problem = [](const char* query, auto read) {
    Parameters parameters(query);
    read(parameters);
    return parameters.Problem().value_or(BadParameter());
  };
  for (const char* query : {"a=", "a"}) {
    for (const BadParameter& each : {
             problem(query, [](auto& from) { EXPECT_EQ(from.Text("a"), ""); }),
             problem(query, [](auto& from) { EXPECT_FALSE(from.Flag("a")); }),
             problem(query, [](auto& from) { EXPECT_EQ(from.Number("a", 7, 9), 7U); }),
             problem(query, [](auto& from) { EXPECT_EQ(from.Time("a"), std::nullopt); }),
             problem(query, [](auto& from) { EXPECT_TRUE(from.Words("a").empty()); }),
         }) {
      EXPECT_EQ(each.field, "a");
      EXPECT_THAT(each.message, ::testing::HasSubstr("is empty"));
    }
    EXPECT_EQ(problem(query, [](auto& from) { EXPECT_EQ(from.TextOrEmpty("a"), ""); }).field, "");
  }
}

TEST(Parameters, ReadsDecimalsAndFlagsThatMayBeAbsent) {
  Parameters good("box=-1.5,2e1&one=0.25&yes=true&no=false");
  EXPECT_THAT(good.Decimals("box", 2), ::testing::ElementsAre(-1.5, 20));
  EXPECT_THAT(good.Decimals("one", 1), ::testing::ElementsAre(0.25));
  EXPECT_TRUE(good.Decimals("absent", 1).empty());
  EXPECT_EQ(good.MaybeFlag("yes"), true);
  EXPECT_EQ(good.MaybeFlag("no"), false);
  EXPECT_EQ(good.MaybeFlag("other"), std::nullopt);
  EXPECT_FALSE(good.Problem());
  for (const char* query :
       {"a=1", "a=1,2,3", "a=1,", "a=,1", "a=1,x", "a=1,inf", "a=nan,1", "a="}) {
    Parameters bad(query);
    EXPECT_TRUE(bad.Decimals("a", 2).empty()) << query;
    EXPECT_TRUE(bad.Problem()) << query;
  }
}

TEST(Parameters, BoundsTheirNumber) {
  std::string query;
  for (std::size_t i = 0; i < kParametersMax; ++i) query += "p" + std::to_string(i) + "=x&";
  Parameters most(query);
  for (std::size_t i = 0; i < kParametersMax; ++i) {
    EXPECT_EQ(most.Text("p" + std::to_string(i)), "x");
  }
  EXPECT_FALSE(most.Problem());
  EXPECT_EQ(Parameters(query + "one=more").Problem()->field, "one");
}

}  // namespace
}  // namespace uplink::http
