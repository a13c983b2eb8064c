#include <array>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/bench/fair/fair_report.h"
#include "tests/bench/fair/misbehaviour.h"
#include "tests/bench/page.h"
#include "tests/bench/trouble_flags.h"

namespace uplink::bench {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr double kShareMiB = 8;

template <typename... Arguments>
std::optional<int> Parse(FairFlags& flags, Arguments... arguments) {
  const std::array<const char*, sizeof...(arguments) + 1> all = {"program", arguments...};
  return ParseFairFlags(static_cast<int>(all.size()), all.data(), NamesOf(Misdeeds()), flags);
}

/// Figures of a scenario that meets every goal.
FairResult Fair() {
  FairResult result{.misdeed = "texts"};
  result.without = {.ack_p50_ms = 2, .ack_p99_ms = 10, .cpu_percent = 20, .memory_mib = 100};
  result.with = {.ack_p50_ms = 2, .ack_p99_ms = 11, .cpu_percent = 30, .memory_mib = 117};
  return result;
}

TEST(MisdeedTest, EveryOneHasANameByWhichItIsFound) {
  for (const Misdeed& misdeed : Misdeeds()) {
    EXPECT_EQ(MisdeedOf(misdeed.name), &misdeed);
    EXPECT_FALSE(misdeed.about.empty());
    EXPECT_NE(misdeed.make, nullptr);
  }
  EXPECT_EQ(MisdeedOf("politeness"), nullptr);
}

TEST(FairFlagsTest, WithoutAnyAllScenariosRunOnSqlite) {
  FairFlags flags;
  EXPECT_EQ(Parse(flags), std::nullopt);
  EXPECT_THAT(ChosenOf(Misdeeds(), flags.only), SizeIs(Misdeeds().size()));
  EXPECT_EQ(flags.store, "sqlite");
  EXPECT_EQ(flags.robots, 500);
}

TEST(FairFlagsTest, NamesOfScenariosChooseAmongThem) {
  FairFlags flags;
  EXPECT_EQ(Parse(flags, "--only", "gaps", "--only", "shapes", "--seconds", "3", "--server-bin",
                  "old/uplinkd", "--store", "postgres"),
            std::nullopt);
  EXPECT_THAT(ChosenOf(Misdeeds(), flags.only),
              ElementsAre(MisdeedOf("gaps"), MisdeedOf("shapes")));
  EXPECT_EQ(flags.seconds, 3);
  EXPECT_EQ(flags.server_bin, "old/uplinkd");
  EXPECT_EQ(flags.store, "postgres");
}

TEST(FairFlagsTest, AnUnknownScenarioOrStoreIsWrongUse) {
  FairFlags flags;
  EXPECT_NE(Parse(flags, "--only", "politeness").value_or(0), 0);
  EXPECT_NE(Parse(flags, "--store", "paper").value_or(0), 0);
  EXPECT_NE(Parse(flags, "--robots", "0").value_or(0), 0);
}

TEST(QuantileTest, IsTheValueBelowWhichTheShareLies) {
  std::vector<double> values;
  for (int i = 100; i > 0; --i) values.push_back(i);
  EXPECT_EQ(Quantile(values, 0.99), 100);
  EXPECT_EQ(Quantile(values, 0.5), 51);
  EXPECT_EQ(Quantile({7}, 0.99), 7);
  EXPECT_EQ(Quantile({}, 0.99), 0);
}

TEST(ScrapeTest, TheLawHoldsWhereTheSumsAreEqual) {
  const std::string page =
      "# HELP uplinkd_uplinks_received_total Messages.\n"
      "uplinkd_uplinks_received_total 12\n"
      "uplinkd_uplinks_settled_total{outcome=\"stored\"} 4\n"
      "uplinkd_uplinks_settled_total{outcome=\"rejected\"} 5\n"
      "uplinkd_uplinks_in_flight 3\n";
  EXPECT_THAT(SamplesOf(page), SizeIs(4));
  EXPECT_EQ(BrokenLaw(SamplesOf(page)), "");
  EXPECT_EQ(BrokenLaw(SamplesOf(page + "uplinkd_uplinks_settled_total{outcome=\"applied\"} 1")),
            "received 12, settled 10, in flight 3");
}

TEST(ScrapeTest, RobotsOfAPageAreNamed) {
  EXPECT_THAT(RurisOf(R"({"robots":[{"ruri":"rcan://a/b"},{"ruri":"rcan://a/c"}],"total":"2"})"),
              ElementsAre("rcan://a/b", "rcan://a/c"));
  for (const char* page : {"", "[]", "{", R"({"robots":3})", R"({"robots":[{"ruri":4},5]})"}) {
    EXPECT_THAT(RurisOf(page), IsEmpty()) << page;
  }
}

TEST(FairReportTest, AScenarioWithinTheGoalsMissesNone) {
  EXPECT_THAT(FairTable({Fair()}, kShareMiB), HasSubstr(" -\n"));
  // A tenth and the share, to the byte.
  FairResult result = Fair();
  result.with.memory_mib = 118;
  EXPECT_THAT(FairTable({result}, kShareMiB), HasSubstr(" -\n"));
}

TEST(FairReportTest, EachGoalThatIsMissedIsNamed) {
  FairResult result = Fair();
  result.with.ack_p99_ms = 12.1;
  EXPECT_THAT(FairTable({result}, kShareMiB), HasSubstr(" ack\n"));
  result.with.unknown = 1;
  result.with.memory_mib = 119;
  result.with.law_broken = 1;
  EXPECT_THAT(FairTable({result}, kShareMiB), HasSubstr(" ack presence memory law\n"));
  result = Fair();
  result.server_ended = true;
  EXPECT_THAT(FairTable({result}, kShareMiB), HasSubstr(" server\n"));
}

TEST(FairReportTest, AScenarioWithoutFiguresSaysWhyAndHasNoRows) {
  FairResult result{.misdeed = "mute", .failure = "it does not listen"};
  EXPECT_THAT(FairTable({result}, kShareMiB),
              HasSubstr("mute       no figures: it does not listen"));
  EXPECT_THAT(FairRows({result}, kShareMiB), IsEmpty());
}

TEST(FairReportTest, RowsCompareWithAndWithout) {
  const std::vector<Row> rows = FairRows({Fair()}, kShareMiB);
  EXPECT_THAT(rows, Contains(Field(&Row::scenario, "texts_ack_p99")));
  for (const Row& row : rows) {
    if (row.scenario != "texts_ack_p99") continue;
    EXPECT_DOUBLE_EQ(row.ratio(), 1.1);
    EXPECT_EQ(row.comparator, "without it");
  }
  EXPECT_THAT(JsonOf(rows, "abc"), HasSubstr(R"("scenario":"texts_unknown")"));
}

TEST(FairReportTest, FiguresThatCannotBeKeptAreAFailure) {
  EXPECT_TRUE(KeepJson("", {}, "abc"));
  EXPECT_FALSE(KeepJson("/dev/full", {}, "abc"));
  EXPECT_FALSE(KeepJson("/dev/null/figures.json", {}, "abc"));
}

}  // namespace
}  // namespace uplink::bench
