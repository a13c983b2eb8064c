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
  /// Nothing of types without.
  std::optional<std::int64_t> key;
  model::uncrew::Value value;
  model::uncrew::Metadata metadata;
  storage::SampleDigest digest{};
  /// When it arrived.
  SystemTime received;
  SteadyTime received_steady;
};

/// Whether a sample is up to kOlderMax older by boot time than one that is known: of the same
/// flight, and of no use any more.
[[nodiscard]] bool IsOlder(const model::uncrew::Metadata& sample,
                           const model::uncrew::Metadata& known);

/// What a drone says now: of each type the newest sample, of types with keys one for each key. One
/// table over the types: a new type needs nothing here.
///
/// Limits: parts_max of each type's row; of a type with more keys the one that was heard least
///         recently goes.
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
  /// It is held: it was sent again.
  [[nodiscard]] bool IsHeld(const Sample& sample) const;
  /// One is held than which it is older.
  [[nodiscard]] bool IsOlder(const Sample& sample) const;
  /// Holds it.
  void Apply(const Sample& sample);

  /// In the order in which their keys were first heard; empty of a type that was not heard.
  [[nodiscard]] const std::vector<LiveSample>& Of(model::uncrew::SampleType type) const {
    return by_type_[static_cast<std::size_t>(type)];
  }
  /// The newest of a type without keys; null if none was heard.
  [[nodiscard]] const LiveSample* Newest(model::uncrew::SampleType type) const {
    const std::vector<LiveSample>& held = Of(type);
    return held.empty() ? nullptr : &held.back();
  }
  /// Requests that wait for an operator, by id, and since when each is heard here.
  [[nodiscard]] const std::map<std::string, SteadyTime>& requests() const { return requests_; }
  /// What is held of the type is not what is.
  void Forget(model::uncrew::SampleType type);
  void Clear() {
    by_type_ = {};
    requests_.clear();
    bytes_ = 0;
  }
  /// What the samples hold in memory, about.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  [[nodiscard]] const LiveSample* Held(const Sample& sample) const;
  void NoteRequests(const Sample& sample);

  /// By SampleType; the first stays empty.
  std::array<std::vector<LiveSample>, model::uncrew::kTypeRows.size() + 1> by_type_;
  /// By request_id, since when it waits: at most kOperatorRequestsMax.
  std::map<std::string, SteadyTime> requests_;
  std::size_t bytes_ = 0;
};

}  // namespace uplink::uncrew
