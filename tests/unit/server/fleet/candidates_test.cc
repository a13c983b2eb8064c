#include "server/fleet/candidates.h"

#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace uplink::fleet {
namespace {

Claim Of(const std::string& ruri, const std::string& gateway = {}) {
  return {.robot = {.ruri = ruri, .fleet = "f"}, .gateway = gateway};
}

TEST(Candidates, CountsHowOftenOneWasRefusedAndShowsHowItCameLast) {
  Candidates candidates;
  candidates.Note(Of("rcan://f/b"), FromUnixMs(1));
  candidates.Note(Of("rcan://f/a"), FromUnixMs(2));
  candidates.Note(Of("rcan://f/b", "CN=hall"), FromUnixMs(3));
  const auto all = candidates.All();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].robot.ruri, "rcan://f/b") << "it was refused last";
  EXPECT_EQ(all[0].robot.fleet, "f");
  EXPECT_EQ(all[0].gateway, "CN=hall");
  EXPECT_EQ(all[0].first_at, FromUnixMs(1));
  EXPECT_EQ(all[0].last_at, FromUnixMs(3));
  EXPECT_EQ(all[0].refused, 2U);
  EXPECT_EQ(all[1].robot.ruri, "rcan://f/a");
}

TEST(Candidates, OneThatWasAddedIsNone) {
  Candidates candidates;
  candidates.Note(Of("rcan://f/a"), FromUnixMs(1));
  candidates.Remove("rcan://f/a");
  candidates.Remove("rcan://f/b");
  EXPECT_TRUE(candidates.All().empty());
}

TEST(Candidates, AtTheBoundTheOneThatWasRefusedLongestAgoIsForgotten) {
  Candidates candidates;
  for (std::size_t i = 0; i < kCandidatesMax; ++i) {
    candidates.Note(Of(fmt::format("rcan://f/{}", i)), FromUnixMs(1));
  }
  candidates.Note(Of("rcan://f/0"), FromUnixMs(2));
  EXPECT_EQ(candidates.All().size(), kCandidatesMax);
  candidates.Note(Of("rcan://f/new"), FromUnixMs(3));
  const auto all = candidates.All();
  EXPECT_EQ(all.size(), kCandidatesMax);
  EXPECT_EQ(all.front().robot.ruri, "rcan://f/new");
  EXPECT_EQ(all[1].robot.ruri, "rcan://f/0") << "it was refused again";
  for (const Candidate& each : all) EXPECT_NE(each.robot.ruri, "rcan://f/1");
}

TEST(Candidates, AtTheBoundTheFleetThatHasMostForgets) {
  Candidates candidates;
  candidates.Note({.robot = {.ruri = "rcan://n/1", .fleet = "north"}}, FromUnixMs(1));
  for (std::size_t i = 0; i <= kCandidatesMax; ++i) {
    candidates.Note(Of(fmt::format("rcan://f/{}", i)), FromUnixMs(2));
  }
  const auto all = candidates.All();
  EXPECT_EQ(all.size(), kCandidatesMax);
  EXPECT_EQ(all.back().robot.ruri, "rcan://n/1");
  EXPECT_EQ(all[all.size() - 2].robot.ruri, "rcan://f/2") << "its oldest went";
}

}  // namespace
}  // namespace uplink::fleet
