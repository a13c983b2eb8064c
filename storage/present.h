#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "schema/model/rejection.h"

// What is present of a robot, by key: its active faults, its shapes, its objects. How the three
// differ is defined here once, for every store.
namespace uplink::storage {

struct CommitRecord;
struct StoreRules;

enum class PresentKind : std::uint8_t { kFault, kShape, kObject };
inline constexpr std::size_t kPresentKinds = 3;

/// What identifies an entry. The views lead into a record, or into texts of the caller.
struct PresentKey {
  PresentKind kind = PresentKind::kFault;
  std::string_view ruri;
  std::string_view id;
  /// Of a fault; empty otherwise.
  std::string_view source;
};

/// What a record does to what is present.
struct PresentChange {
  PresentKey key;
  /// False: the entry goes.
  bool is_upsert = false;
  /// Of an upsert, Unix milliseconds; 0: never.
  std::int64_t expires_ms = 0;
};

/// Nothing for a record that leaves what is present as it is. The views lead into the record.
[[nodiscard]] std::optional<PresentChange> PresentChangeOf(const CommitRecord& record,
                                                           const StoreRules& rules);

/// How many entries of a kind one robot may have.
struct PresentBound {
  std::size_t entries_max = 0;
  /// Whether entries expire, so that some may make room for a new one.
  bool expires = false;
  /// The verdict on one more.
  model::Rejection (*refusal)() = nullptr;
};
[[nodiscard]] const PresentBound& BoundOf(PresentKind kind);

}  // namespace uplink::storage
