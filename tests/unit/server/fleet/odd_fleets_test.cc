#include "server/fleet/odd_fleets.h"

#include <string>

#include <gtest/gtest.h>

namespace uplink::fleet {
namespace {

using Verdict = OddFleets::Verdict;

const std::string kOdd = "no\xE2\x80\x8Brth";  // U+200B

TEST(OddFleets, APlainNameFitsWhateverIsKnown) {
  OddFleets fleets;
  EXPECT_EQ(fleets.Judge("north"), Verdict::kFits);
  fleets.SetRead();
  EXPECT_EQ(fleets.Judge("north"), Verdict::kFits);
}

TEST(OddFleets, AnOddNameFitsIfTheStoreHasIt) {
  OddFleets fleets;
  EXPECT_EQ(fleets.Judge(kOdd), Verdict::kUnread);
  fleets.Know(kOdd);
  EXPECT_EQ(fleets.Judge(kOdd), Verdict::kFits) << "before all was read";
  fleets.SetRead();
  EXPECT_EQ(fleets.Judge(kOdd), Verdict::kFits);
  EXPECT_EQ(fleets.Judge(kOdd + "2"), Verdict::kRefused);
}

TEST(OddFleets, AnOddNameIsNotComparedWithPlainOnes) {
  OddFleets fleets;
  fleets.Know("north");
  fleets.SetRead();
  EXPECT_EQ(fleets.Judge(kOdd), Verdict::kRefused);
}

TEST(OddFleets, KnowSoManyAndNoMore) {
  OddFleets fleets;
  fleets.SetRead();
  for (std::size_t i = 0; i <= kOddFleetsMax; ++i) fleets.Know(kOdd + std::to_string(i));
  EXPECT_EQ(fleets.Judge(kOdd + std::to_string(kOddFleetsMax - 1)), Verdict::kFits);
  EXPECT_EQ(fleets.Judge(kOdd + std::to_string(kOddFleetsMax)), Verdict::kRefused);
}

}  // namespace
}  // namespace uplink::fleet
