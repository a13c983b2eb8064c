#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/simulation/backends.h"

namespace uplink::simulation {
namespace {

constexpr std::uint64_t kSeeds = 10'000;

TEST(Simulation, KeepsEveryPromiseOnTheFakeStore) {
  const Payloads payloads;
  metrics::MessageCounts uplinks;
  forward::Counts forwards;
  std::uint64_t kills = 0;
  std::uint64_t deletions = 0;
  std::uint64_t floods = 0;
  std::uint64_t held_back = 0;
  std::uint64_t held_back_by_share = 0;
  std::uint64_t held_back_by_flow = 0;
  std::map<absl::StatusCode, std::uint64_t> ends;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    FakeBackend backend;
    World world(payloads, backend, {.seed = seed, .steps = 400});
    const RunResult result = world.Run();
    ASSERT_EQ(result.violation, "");
    uplinks += result.uplinks;
    forwards += result.forwards;
    kills += result.kills;
    deletions += result.deletions;
    floods += result.floods;
    held_back += result.held_back;
    held_back_by_share += result.held_back_by_share;
    held_back_by_flow += result.held_back_by_flow;
    for (const auto& [code, count] : result.ends) ends[code] += count;
  }
  // The schedules must really have exercised what they claim to.
  EXPECT_GT(uplinks.stored, kSeeds * 10);
  EXPECT_GT(uplinks.applied, kSeeds * 3);
  EXPECT_GT(uplinks.rejected, kSeeds * 5);
  EXPECT_GT(uplinks.superseded, kSeeds);
  EXPECT_GT(uplinks.duplicate, kSeeds);
  EXPECT_GT(uplinks.missing, kSeeds);
  EXPECT_GT(forwards.written, kSeeds);
  EXPECT_GT(forwards.coalesced, kSeeds / 100);
  EXPECT_GT(forwards.replaced, kSeeds);
  EXPECT_GT(forwards.dropped, kSeeds / 20);
  EXPECT_GT(forwards.snapshots, kSeeds);
  EXPECT_GT(forwards.snapshot_items, kSeeds);
  EXPECT_GT(kills, kSeeds / 10);
  EXPECT_GT(deletions, kSeeds / 10);
  EXPECT_GT(uplinks.rejects[static_cast<std::size_t>(model::RejectReason::kRateLimited)], kSeeds);
  EXPECT_GT(floods, kSeeds / 50);
  EXPECT_GT(held_back, kSeeds);
  EXPECT_GT(held_back_by_share, kSeeds / 10);
  EXPECT_GT(held_back_by_flow, kSeeds / 10);
  EXPECT_GT(ends[absl::StatusCode::kOk], kSeeds / 10);
  EXPECT_GT(ends[absl::StatusCode::kAborted], kSeeds / 10);
  EXPECT_GT(ends[absl::StatusCode::kUnavailable], kSeeds / 10);
  fmt::print(
      "{} seeds: forwards written {} coalesced {} replaced {} dropped {} snapshots {} of {}; "
      "stored {} applied {} superseded {} duplicate {} rejected {} missing {}; "
      "{} kills, {} rows deleted, held back after {} steps; ended OK {} ABORTED {} UNAVAILABLE "
      "{}\n",
      kSeeds, forwards.written, forwards.coalesced, forwards.replaced, forwards.dropped,
      forwards.snapshots, forwards.snapshot_items, uplinks.stored, uplinks.applied,
      uplinks.superseded, uplinks.duplicate, uplinks.rejected, uplinks.missing, kills, deletions,
      held_back, ends[absl::StatusCode::kOk], ends[absl::StatusCode::kAborted],
      ends[absl::StatusCode::kUnavailable]);
}

TEST(Simulation, ReplaysASeedToTheSameStep) {
  const Payloads payloads;
  const auto run = [&payloads] {
    FakeBackend backend;
    return World(payloads, backend, {.seed = 77, .steps = 400}).Run();
  };
  const RunResult first = run();
  EXPECT_GT(first.uplinks.received, 0U);
  EXPECT_EQ(ToText(first), ToText(run()));
}

}  // namespace
}  // namespace uplink::simulation
