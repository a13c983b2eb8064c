#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "schema/model/uncrew/value.h"
#include "storage/samples.h"

namespace uplink::uncrew {

/// The newest sample of a type, or of one key of it. A value.
struct LiveSample {
  /// Empty for types without keys.
  std::optional<std::int64_t> key;
  model::uncrew::Value value;
  model::uncrew::Metadata metadata;
  storage::SampleDigest digest{};
  /// When it arrived.
  SystemTime received;
  SteadyTime received_steady;
};

/// Whether a sample is up to kOlderMax older by boot time than a known one: it is of the same
/// flight, and outdated.
[[nodiscard]] bool IsOlder(const model::uncrew::Metadata& sample,
                           const model::uncrew::Metadata& known);

/// A drone's live samples: the newest of each type, or of each key of a type. One table over the
/// types: a new type needs nothing here.
///
/// Limits: parts_max of each type's row; past it, the key that was heard least recently is evicted.
///
/// Thread: confined to its owner's lock.
class LiveSamples final {
 public:
  /// A sample as it arrived.
  struct Sample {
    const model::uncrew::Value& value;
    const model::uncrew::Metadata& metadata;
    const storage::SampleDigest& digest;
    SystemTime received;
    SteadyTime received_steady;
  };
  /// The same sample is held already.
  [[nodiscard]] bool IsHeld(const Sample& sample) const;
  /// A newer sample is held.
  [[nodiscard]] bool IsOlder(const Sample& sample) const;
  /// Holds the sample in place of the last one.
  void Apply(const Sample& sample);

  /// In the order in which their keys were first heard; empty for a type that was not heard.
  [[nodiscard]] const std::vector<LiveSample>& Of(model::uncrew::SampleType type) const {
    return by_type_[static_cast<std::size_t>(type)];
  }
  /// The newest of a type without keys; null if none was heard.
  [[nodiscard]] const LiveSample* Newest(model::uncrew::SampleType type) const {
    const std::vector<LiveSample>& held = Of(type);
    return held.empty() ? nullptr : &held.back();
  }
  /// Requests that wait for an operator, by id, and when each was first heard here.
  [[nodiscard]] const std::map<std::string, SteadyTime>& requests() const { return requests_; }
  /// Forgets the samples of this type: they are outdated.
  void Forget(model::uncrew::SampleType type);
  void Clear() {
    ++changes_;
    by_type_ = {};
    requests_.clear();
    bytes_ = 0;
  }
  /// Grows with each change of the samples.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  /// About how much memory the samples take.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  [[nodiscard]] const LiveSample* Held(const Sample& sample) const;
  void NoteRequests(const Sample& sample);

  /// By SampleType; the first stays empty.
  std::array<std::vector<LiveSample>, model::uncrew::kTypeRows.size() + 1> by_type_;
  /// By request_id, since when it waits: at most kOperatorRequestsMax.
  std::map<std::string, SteadyTime> requests_;
  std::size_t bytes_ = 0;
  std::uint64_t changes_ = 0;
};

}  // namespace uplink::uncrew
