#include "tests/bench/avatar/samples.h"

#include <algorithm>
#include <array>

#include "schema/model/uncrew/types.h"
#include "tests/unit/schema/uncrew/requests.h"
#include "tests/unit/schema/uncrew/samples.h"
#include "uncrew/v1/avatar.pb.h"

namespace uplink::bench {
namespace {

using model::uncrew::SampleKind;
using model::uncrew::SampleType;

/// Sets, and results of commands, are no telemetry.
constexpr std::array kNoTelemetry = {SampleType::kAlerts, SampleType::kOperatorRequests,
                                     SampleType::kCommandResult};

std::vector<AvatarSample> SamplesOf(bool with_durable) {
  std::vector<AvatarSample> samples;
  for (const uncrew::test::Sample& each : uncrew::test::kSamples) {
    const model::uncrew::TypeRow& row = model::uncrew::RowOf(each.type);
    const bool durable = row.kind == SampleKind::kDurable;
    if (std::ranges::count(kNoTelemetry, each.type) > 0 || (durable && !with_durable)) continue;
    samples.push_back({.path = std::string("/uncrew.v1.AvatarService/").append(row.method),
                       .durable = durable,
                       .content = uncrew::test::RequestOf(each.type, each.text)});
  }
  return samples;
}

}  // namespace

std::vector<AvatarSample> LiveSamples() { return SamplesOf(false); }

std::vector<AvatarSample> AllSamples() { return SamplesOf(true); }

std::string RequestOf(const AvatarSample& sample, const AvatarMetadata& metadata) {
  // All requests have their metadata in the same field, and fields come in any order.
  ::uncrew::v1::PublishHeadingRequest head;
  ::uncrew::v1::Metadata& its = *head.mutable_metadata();
  its.set_uav_id(std::string(metadata.uav_id));
  its.set_sampled_at_unix_us(metadata.unix_us);
  its.set_sampled_at_boot_us(metadata.boot_us);
  return head.SerializeAsString().append(sample.content);
}

}  // namespace uplink::bench
