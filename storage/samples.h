#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/epoch.h"

// What a store remembers of a drone's samples, so that one that is sent again is known. Only a
// transaction that has locked the robot's row writes them, or the claim (claim.h).
namespace uplink::storage {

/// Digests of each durable type of samples that are kept of a drone, the oldest go.
inline constexpr std::size_t kSamplesKept = 64;
/// Bytes of SampleMark::last.
inline constexpr std::size_t kSampleLastBytesMax = std::size_t{64} * 1024;
/// Type numbers are below this: a drone has at most as many rows.
inline constexpr std::uint32_t kSampleTypesMax = 64;
/// Records of one sample at most: each alert and each request of two full sets comes or goes.
inline constexpr std::size_t kSampleRecordsMax = 128;

/// Of a sample's type, times and content.
using SampleDigest = std::array<std::uint8_t, 16>;

/// What identifies a sample of a durable type. It decides what becomes of the sample's records, in
/// place of a session's cursor. A value.
struct SampleMark {
  /// ClaimResult.claim under which the sample was judged.
  Epoch claim = 0;
  /// Below kSampleTypesMax (model::uncrew::SampleType).
  std::uint32_t type = 0;
  SampleDigest digest{};
  /// Whether the sample names a time. One that does is a duplicate if it is among the last
  /// kSamplesKept of its type; one that does not, if it equals the last.
  bool timed = false;
  /// The record is no sample: it asks whether the claim holds. kDuplicate if it does; nothing is
  /// written, and nothing else here counts.
  bool is_question = false;
  /// What to remember with it as the last of its type. The bytes are the server's own, and
  /// mean nothing to a store; at most kSampleLastBytesMax.
  std::string last;
};

/// Shared by all records of a sample, 1 to kSampleRecordsMax, which follow each other in one batch:
/// records with the same pointer are of one sample. Null: the record is of no sample.
using SampleRef = std::shared_ptr<const SampleMark>;

/// What is remembered of a drone's samples of one type. A value.
struct SampleMemory {
  std::uint32_t type = 0;
  /// Of those that were stored last, the oldest first; at most kSamplesKept.
  std::vector<SampleDigest> digests;
  /// SampleMark::last of the last of them.
  std::string last;

  friend bool operator==(const SampleMemory&, const SampleMemory&) = default;
};

/// Whether the sample was stored before. `memory` is of its type.
[[nodiscard]] bool IsDuplicate(const SampleMark& mark, const SampleMemory& memory);
/// Takes a sample that is stored into the memory of its type.
void Remember(const SampleMark& mark, SampleMemory& memory);

// As a column holds them: digest after digest, the oldest first.
[[nodiscard]] std::string PackedDigests(const std::vector<SampleDigest>& digests);
/// Nothing if the bytes are no whole digests, or more than kSamplesKept.
[[nodiscard]] std::optional<std::vector<SampleDigest>> DigestsIn(std::string_view packed);

}  // namespace uplink::storage
