#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "schema/model/uncrew/types.h"
#include "schema/uncrew/limits.h"
#include "storage/bounds.h"
#include "storage/samples.h"

namespace uplink::uncrew {

/// The number of a type in stores.
[[nodiscard]] constexpr std::uint32_t NumberOf(model::uncrew::SampleType type) {
  return static_cast<std::uint32_t>(type);
}
static_assert(model::uncrew::kTypeRows.size() < storage::kSampleTypesMax);
static_assert(kRequestBytesMax <= storage::kSampleLastBytesMax, "a store keeps a whole request");
static_assert(2 * kAlertsMax <= storage::kSampleRecordsMax, "each alert of two sets comes or goes");
static_assert(kOperatorRequestsMax <= storage::kOpenRequestsPerRobotMax,
              "a store keeps a whole set open");

/// What this process knows of the store's memory of a drone's samples: the answer to the claim, and
/// samples that went to the journal since, which may still wait there.
///
/// Thread: confined to its owner's lock.
class StoredSamples final {
 public:
  /// Takes the answer to a claim.
  void Set(std::vector<storage::SampleMemory> memories);
  void Add(const storage::SampleMark& mark);

  [[nodiscard]] bool IsDuplicate(const storage::SampleMark& mark) const {
    return storage::IsDuplicate(mark, Of(mark.type));
  }
  /// Whether the sample was stored, and a later one of its type after it.
  [[nodiscard]] bool IsPast(const storage::SampleMark& mark) const {
    return IsDuplicate(mark) && Of(mark.type).digests.back() != mark.digest;
  }
  /// The bytes that were stored with the last sample of the type; empty if there is none.
  [[nodiscard]] std::string_view Last(model::uncrew::SampleType type) const {
    return Of(NumberOf(type)).last;
  }
  /// About how much memory that takes.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  [[nodiscard]] const storage::SampleMemory& Of(std::uint32_t number) const {
    return by_number_[number];
  }

  /// By SampleType; the first stays empty.
  std::array<storage::SampleMemory, model::uncrew::kTypeRows.size() + 1> by_number_;
  std::size_t bytes_ = 0;
};

}  // namespace uplink::uncrew
