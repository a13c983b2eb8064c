#include "server/uncrew/stored_samples.h"

#include <gtest/gtest.h>

namespace uplink::uncrew {
namespace {

using model::uncrew::SampleType;

storage::SampleMark Mark(std::uint8_t digest, bool timed = true) {
  return {.type = NumberOf(SampleType::kAlerts),
          .digest = {digest},
          .timed = timed,
          .last = "set " + std::to_string(digest)};
}

TEST(StoredSamples, KnowWhatAClaimReturned) {
  StoredSamples stored;
  stored.Set({{.type = NumberOf(SampleType::kAlerts), .digests = {{1}, {2}}, .last = "set 2"}});
  EXPECT_TRUE(stored.IsDuplicate(Mark(1)));
  EXPECT_FALSE(stored.IsDuplicate(Mark(1, false))) << "without a time only the last is known";
  EXPECT_TRUE(stored.IsDuplicate(Mark(2, false)));
  EXPECT_FALSE(stored.IsDuplicate(Mark(3)));
  EXPECT_EQ(stored.Last(SampleType::kAlerts), "set 2");
  EXPECT_EQ(stored.Last(SampleType::kArmed), "");
}

TEST(StoredSamples, KnowWhatWasGivenToTheJournalSince) {
  StoredSamples stored;
  stored.Add(Mark(1));
  stored.Add(Mark(2));
  EXPECT_TRUE(stored.IsDuplicate(Mark(1)));
  EXPECT_EQ(stored.Last(SampleType::kAlerts), "set 2");
}

TEST(StoredSamples, ForgetByTheNextClaimWhatItDoesNotReturn) {
  StoredSamples stored;
  stored.Add(Mark(1));
  stored.Set({});
  EXPECT_FALSE(stored.IsDuplicate(Mark(1)));
  EXPECT_EQ(stored.Last(SampleType::kAlerts), "");
}

TEST(StoredSamples, PassOverATypeOfALaterVersion) {
  StoredSamples stored;
  stored.Set({{.type = 1'000'000, .digests = {{1}}, .last = "x"},
              {.type = NumberOf(SampleType::kAlerts), .digests = {{1}}, .last = "set 1"}});
  EXPECT_TRUE(stored.IsDuplicate(Mark(1)));
}

}  // namespace
}  // namespace uplink::uncrew
