// The robots of twins that this process has heard, and the memory that they hold together.
#include "server/cyberwave/twins.h"

#include <memory>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/cyberwave/twin_parts.h"
#include "tests/unit/server/cyberwave/applying.h"

namespace uplink::cyberwave {
namespace {

constexpr const char* kT = "11111111-2222-4333-8444-555555555555";

Applied Publish(Twins& twins, Twin& twin, const std::string& tail, const std::string& payload) {
  return twins.Apply(
      twin, JudgeMessage(fmt::format("cyberwave/twin/{}/{}", kT, tail), payload, JudgeTerms()), {});
}

/// A report of about `bytes`.
std::string Report(const std::string& name, std::size_t bytes) {
  return fmt::format(R"({{"telemetry_type":"{}","data":{{"text":"{}"}}}})", name,
                     std::string(bytes, 'x'));
}

TEST(Twins, AreFoundByTheirRuriUpToTheirNumber) {
  Twins twins(2);
  const model::cyberwave::Uuid id;
  const TwinPtr first = twins.FindOrAdd("a", id);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(twins.FindOrAdd("a", id), first);
  EXPECT_EQ(twins.Find("a"), first);
  EXPECT_EQ(twins.Find("b"), nullptr);
  ASSERT_NE(twins.FindOrAdd("b", id), nullptr);
  EXPECT_EQ(twins.FindOrAdd("c", id), nullptr) << "one more than there may be";
  EXPECT_EQ(twins.FindOrAdd("a", id), first) << "who is there stays";
  twins.Remove("a");
  EXPECT_NE(twins.FindOrAdd("c", id), nullptr);
  EXPECT_EQ(twins.size(), 2U);
}

TEST(Twins, CountTheMemoryThatTheyHold) {
  Twins twins(2);
  Twin& twin = *twins.FindOrAdd("a", {});
  (void)Publish(twins, twin, "telemetry", Report("one", 20'000));
  EXPECT_GT(twins.bytes(), 20'000U);
  EXPECT_EQ(twins.bytes(), twin.bytes());
  twins.Remove("a");
  EXPECT_EQ(twins.bytes(), 0U);
}

TEST(Twins, CountTheFaultsThatTheyHold) {
  constexpr std::size_t kFaults = 64;
  Twins twins(1);
  Twin& twin = *twins.FindOrAdd("a", {});
  (void)Publish(twins, twin, "metrics", R"({"metrics":{"errors":["a"]}})");
  const std::size_t before = twins.bytes();
  std::string errors;
  for (std::size_t i = 0; i < kFaults; ++i) {
    errors += fmt::format(R"({}"{:0>100}")", i == 0 ? "" : ",", i);
  }
  (void)Publish(twins, twin, "metrics", R"({"metrics":{"errors":[)" + errors + "]}}");
  EXPECT_GT(twins.bytes(), before + 100 * kFaults);
}

TEST(Twins, CountInTheTotalOfAllForAsLongAsTheyAreThere) {
  const auto all = std::make_shared<robot::LiveTotal>();
  {
    Twins twins(3, all);
    const TwinPtr kept = twins.FindOrAdd("a", {});
    (void)Publish(twins, *kept, "telemetry", Report("one", 20'000));
    (void)Publish(twins, *twins.FindOrAdd("b", {}), "telemetry", Report("one", 10'000));
    EXPECT_GT(all->bytes(), 30'000U);
    EXPECT_EQ(all->bytes(), twins.bytes());
    twins.Remove("a");
    EXPECT_LT(all->bytes(), 20'000U);
    (void)Publish(twins, *kept, "telemetry", Report("two", 20'000));
    EXPECT_LT(all->bytes(), 20'000U) << "one that was removed counts no more";
    EXPECT_EQ(all->bytes(), twins.bytes());
  }
  EXPECT_EQ(all->bytes(), 0U);
}

TEST(Twins, LoseOneTableAtATimeAndHoldWhatComesNext) {
  Twins twins(1);
  Twin& twin = *twins.FindOrAdd("a", {});
  (void)Publish(twins, twin, "telemetry", Report("one", 40'000));
  (void)Publish(twins, twin, "position", R"({"position":{"x":1,"y":2,"z":3}})");
  (void)Publish(twins, twin, "metrics", R"({"metrics":{"cpu":{"load":0.5}}})");
  const std::size_t before = twin.bytes();
  const std::size_t reports = twin.table_bytes()[static_cast<std::size_t>(TwinTable::kReports)];
  EXPECT_GT(reports, 40'000U);
  EXPECT_EQ(twins.DropTable(twin, TwinTable::kReports), reports);
  EXPECT_EQ(twins.tables_dropped(), 1U);
  EXPECT_EQ(twin.bytes(), before - reports);
  EXPECT_EQ(twins.bytes(), twin.bytes());
  twin.LookAt([](const TwinParts& parts) {
    EXPECT_EQ(parts.reports.size(), 0U);
    EXPECT_TRUE(parts.position.has_value());
  });
  (void)Publish(twins, twin, "telemetry", Report("two", 20'000));
  twin.LookAt([](const TwinParts& parts) { EXPECT_EQ(parts.reports.size(), 1U); });
}

TEST(Twins, EachTableIsEmptyOnceItIsDropped) {
  Twins twins(1);
  Twin& twin = *twins.FindOrAdd("a", {});
  (void)Publish(twins, twin, "telemetry", Report("one", 1'000));
  for (std::size_t i = 0; i < kTwinTables; ++i) {
    (void)twins.DropTable(twin, static_cast<TwinTable>(i));
  }
  EXPECT_EQ(twin.table_bytes(), TwinTableBytes{});
}

}  // namespace
}  // namespace uplink::cyberwave
