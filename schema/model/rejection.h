#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace uplink::model {

/// Why a message or a field was not taken. Closed; the numbers are those of the relay contract's
/// RejectReason.
enum class RejectReason : std::uint8_t {
  kMalformed = 1,
  kUnknownVariant = 2,
  kPayloadTooLarge = 3,
  kTooManyItems = 4,
  kTextTooLong = 5,
  kTextNotUtf8 = 6,
  kMissingField = 7,
  kOutOfRange = 8,
  kNotFinite = 9,
  kTypeMismatch = 10,
  kIdentityMismatch = 11,
  kNotMonotonic = 12,
  kRateLimited = 13,
  kUnsupportedContent = 14,
  kDuplicateKey = 15,
  kTooFewItems = 16,
  kStoreRefused = 17,
};

inline constexpr std::size_t kRejectReasons = 17;

/// Every reason, in number order.
inline constexpr std::array<RejectReason, kRejectReasons> kAllRejectReasons = {
    RejectReason::kMalformed,    RejectReason::kUnknownVariant,     RejectReason::kPayloadTooLarge,
    RejectReason::kTooManyItems, RejectReason::kTextTooLong,        RejectReason::kTextNotUtf8,
    RejectReason::kMissingField, RejectReason::kOutOfRange,         RejectReason::kNotFinite,
    RejectReason::kTypeMismatch, RejectReason::kIdentityMismatch,   RejectReason::kNotMonotonic,
    RejectReason::kRateLimited,  RejectReason::kUnsupportedContent, RejectReason::kDuplicateKey,
    RejectReason::kTooFewItems,  RejectReason::kStoreRefused,
};

/// The reason as labels, JSON and logs spell it: `out_of_range`.
[[nodiscard]] std::string_view ToText(RejectReason reason);
/// The reason that ToText spells so, or nothing.
[[nodiscard]] std::optional<RejectReason> RejectReasonFromText(std::string_view text);

/// A verdict on content: permanent, the same bytes would fail again. A value.
struct Rejection {
  RejectReason reason = RejectReason::kMalformed;
  /// Path from the variant's own struct (`battery.socPct`, `kv[3].key`); empty if none.
  std::string field;
  /// One sentence for a person, with the value and the limit; at most kDetailBytesMax bytes of
  /// well-formed UTF-8.
  std::string detail;

  friend bool operator==(const Rejection&, const Rejection&) = default;
};

/// An invalid field of a live message, which was dropped (a status text: cut), while the rest
/// was applied. `field` is spelled as in Rejection.
using DroppedField = Rejection;

/// Fields that were dropped for one reason, beyond those of a message that are listed as
/// DroppedField. A value.
struct UnlistedFields {
  RejectReason reason = RejectReason::kMalformed;
  std::size_t fields = 0;

  friend bool operator==(const UnlistedFields&, const UnlistedFields&) = default;
};

}  // namespace uplink::model
