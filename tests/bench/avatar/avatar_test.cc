// What the drones of the benchmark publish.
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "schema/model/uncrew/types.h"
#include "schema/uncrew/judge.h"
#include "tests/bench/avatar/samples.h"

namespace uplink::bench {
namespace {

using model::uncrew::SampleType;

constexpr std::size_t kTelemetryTypes = 23;

/// Of the type that the sample's path names.
uncrew::Judgement JudgementOf(const AvatarSample& sample, const AvatarMetadata& metadata) {
  const auto type = model::uncrew::TypeOfMethod(sample.path.substr(sample.path.rfind('/') + 1));
  EXPECT_TRUE(type) << sample.path;
  return uncrew::Judge(type.value_or(SampleType::kRejected), RequestOf(sample, metadata));
}

TEST(AvatarSamplesTest, AreOfEachTypeOfTelemetryOnce) {
  std::set<std::string> paths;
  for (const AvatarSample& sample : AllSamples()) paths.insert(sample.path);
  EXPECT_EQ(paths.size(), kTelemetryTypes);
  EXPECT_EQ(AllSamples().size(), kTelemetryTypes);
}

TEST(AvatarSamplesTest, HaveNoFault) {
  for (const AvatarSample& sample : AllSamples()) {
    const uncrew::Judgement judgement = JudgementOf(sample, {.unix_us = 1'795'262'400'000'000});
    EXPECT_EQ(judgement.rejection(), nullptr) << sample.path;
    EXPECT_TRUE(judgement.dropped.empty()) << sample.path;
    EXPECT_EQ(judgement.times_unknown, 0) << sample.path;
  }
}

TEST(AvatarSamplesTest, LiveOnesLeaveOutTypesThatAreAlwaysDurable) {
  std::size_t durable = 0;
  for (const AvatarSample& sample : AllSamples()) durable += sample.durable ? 1 : 0;
  EXPECT_EQ(durable, 3);
  EXPECT_EQ(LiveSamples().size(), kTelemetryTypes - durable);
  for (const AvatarSample& sample : LiveSamples()) EXPECT_FALSE(sample.durable) << sample.path;
}

TEST(AvatarSamplesTest, MetadataIsThatOfTheCall) {
  const uncrew::Judgement judgement = JudgementOf(
      AllSamples().front(),
      {.uav_id = "rcan://bench.local/robots/7", .unix_us = 1'795'262'400'000'001, .boot_us = 42});
  EXPECT_EQ(judgement.metadata.uav_id, "rcan://bench.local/robots/7");
  EXPECT_EQ(judgement.metadata.sampled_at_us, 1'795'262'400'000'001);
  EXPECT_EQ(judgement.metadata.boot_us, 42);
}

}  // namespace
}  // namespace uplink::bench
