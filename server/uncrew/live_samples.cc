#include "server/uncrew/live_samples.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "schema/model/held_bytes.h"
#include "server/uncrew/limits.h"

namespace uplink::uncrew {
namespace {

constexpr std::uint64_t kOlderMaxUs =
    static_cast<std::uint64_t>(std::chrono::microseconds(kOlderMax).count());

std::size_t BytesOf(const LiveSample& sample) {
  return sizeof(LiveSample) + model::HeldBytes(sample.value);
}

}  // namespace

bool IsOlder(const model::uncrew::Metadata& sample, const model::uncrew::Metadata& known) {
  const std::uint64_t now = sample.boot_us;
  const std::uint64_t then = known.boot_us;
  return now != 0 && now < then && then - now <= kOlderMaxUs;
}

const LiveSample* LiveSamples::Held(const Sample& sample) const {
  const std::vector<LiveSample>& held = Of(model::uncrew::TypeOf(sample.value));
  const auto found = std::ranges::find(held, model::uncrew::KeyOf(sample.value), &LiveSample::key);
  return found == held.end() ? nullptr : &*found;
}

bool LiveSamples::IsHeld(const Sample& sample) const {
  const LiveSample* held = Held(sample);
  return held != nullptr && held->digest == sample.digest;
}

bool LiveSamples::IsOlder(const Sample& sample) const {
  const LiveSample* held = Held(sample);
  return held != nullptr && uncrew::IsOlder(sample.metadata, held->metadata);
}

void LiveSamples::Forget(model::uncrew::SampleType type) {
  ++changes_;
  std::vector<LiveSample>& held = by_type_[static_cast<std::size_t>(type)];
  for (const LiveSample& sample : held) bytes_ -= BytesOf(sample);
  held.clear();
  if (type == model::uncrew::SampleType::kOperatorRequests) requests_.clear();
}

void LiveSamples::NoteRequests(const Sample& sample) {
  std::map<std::string, SteadyTime> now;
  for (const auto& request : std::get<model::uncrew::OperatorRequests>(sample.value).items) {
    const auto since = requests_.find(request.request_id);
    now.emplace(request.request_id,
                since == requests_.end() ? sample.received_steady : since->second);
  }
  requests_ = std::move(now);
}

void LiveSamples::Apply(const Sample& sample) {
  ++changes_;
  const model::uncrew::SampleType type = model::uncrew::TypeOf(sample.value);
  if (type == model::uncrew::SampleType::kOperatorRequests) NoteRequests(sample);
  std::vector<LiveSample>& held = by_type_[static_cast<std::size_t>(type)];
  LiveSample fresh{.key = model::uncrew::KeyOf(sample.value),
                   .value = sample.value,
                   .metadata = sample.metadata,
                   .digest = sample.digest,
                   .received = sample.received,
                   .received_steady = sample.received_steady};
  const auto found = std::ranges::find(held, fresh.key, &LiveSample::key);
  bytes_ += BytesOf(fresh);
  if (found != held.end()) {
    bytes_ -= BytesOf(*found);
    *found = std::move(fresh);
    return;
  }
  if (held.size() >= model::uncrew::RowOf(type).parts_max) {
    const auto oldest = std::ranges::min_element(held, {}, &LiveSample::received_steady);
    bytes_ -= BytesOf(*oldest);
    held.erase(oldest);
  }
  held.push_back(std::move(fresh));
}

}  // namespace uplink::uncrew
