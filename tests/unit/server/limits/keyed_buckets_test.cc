#include "server/limits/keyed_buckets.h"

#include <chrono>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "server/log/rate_limited.h"

namespace uplink::limits {
namespace {

using std::chrono::seconds;
using enum KeyedBuckets::Answer;

constexpr Policy kPolicy{.id = PolicyId::kBytesOfId,
                         .of = "things",
                         .whose = "a key",
                         .most = 10,
                         .at_once = 20,
                         .keys_max = 2,
                         .shown = metrics::MetricId::kMqttRejects};

TEST(KeyedBuckets, AnswerByTheKeysOwnBucket) {
  struct Row {
    seconds at;
    std::optional<std::size_t> key;
    std::size_t amount;
    KeyedBuckets::Answer answer;
    const char* why;
  };
  const std::vector<Row> rows{
      {seconds(0), 1, 20, kPasses, "a full one gives its burst"},
      {seconds(0), 1, 1, kOverAndLog, ""},
      {seconds(0), 1, 1, kOver, "told already"},
      {seconds(0), 2, 20, kPasses, "another key"},
      {seconds(0), 2, 1, kOverAndLog, "each is reported"},
      {seconds(0), 3, 20, kPasses, "the one of all that are beyond"},
      {seconds(0), 4, 1, kOverAndLog, "it is shared"},
      {seconds(0), std::nullopt, 1, kOver, "by what has no key too"},
      {seconds(1), 1, 10, kPasses, "it fills by its rate"},
      {seconds(1), 1, 1, kOver, "told within the span"},
      {seconds(2), 5, 10, kPasses, "2 is full again, and makes room"},
      {seconds(2), 5, 11, kOverAndLog, "a bucket of its own"},
      {log::RateLimited::kSpan, 1, 21, kPasses, "a full one gives more than its burst"},
      {log::RateLimited::kSpan, 1, 1, kOverAndLog, "the span is over"},
  };
  KeyedBuckets buckets(kPolicy);
  for (const Row& row : rows) {
    const SteadyTime now = SteadyTime(std::chrono::hours(1)) + row.at;
    EXPECT_EQ(buckets.Take(row.key, row.amount, now), row.answer)
        << row.at.count() << " s: " << row.key.value_or(0) << ", " << row.amount << ": " << row.why;
  }
}

}  // namespace
}  // namespace uplink::limits
