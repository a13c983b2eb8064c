#include "schema/model/rejection.h"

namespace uplink::model {

std::string_view ToText(RejectReason reason) {
  switch (reason) {
    case RejectReason::kMalformed:
      return "malformed";
    case RejectReason::kUnknownVariant:
      return "unknown_variant";
    case RejectReason::kPayloadTooLarge:
      return "payload_too_large";
    case RejectReason::kTooManyItems:
      return "too_many_items";
    case RejectReason::kTextTooLong:
      return "text_too_long";
    case RejectReason::kTextNotUtf8:
      return "text_not_utf8";
    case RejectReason::kMissingField:
      return "missing_field";
    case RejectReason::kOutOfRange:
      return "out_of_range";
    case RejectReason::kNotFinite:
      return "not_finite";
    case RejectReason::kTypeMismatch:
      return "type_mismatch";
    case RejectReason::kIdentityMismatch:
      return "identity_mismatch";
    case RejectReason::kNotMonotonic:
      return "not_monotonic";
    case RejectReason::kRateLimited:
      return "rate_limited";
    case RejectReason::kUnsupportedContent:
      return "unsupported_content";
    case RejectReason::kDuplicateKey:
      return "duplicate_key";
    case RejectReason::kTooFewItems:
      return "too_few_items";
    case RejectReason::kStoreRefused:
      return "store_refused";
  }
  return "unspecified";
}

std::optional<RejectReason> RejectReasonFromText(std::string_view text) {
  for (const RejectReason reason : kAllRejectReasons) {
    if (ToText(reason) == text) return reason;
  }
  return std::nullopt;
}

}  // namespace uplink::model
