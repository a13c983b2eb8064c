#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "schema/model/rejection.h"
#include "schema/model/uncrew/value.h"

namespace uplink::uncrew {

/// What judging one request found. A value.
struct Judgement {
  model::uncrew::SampleType type{};
  /// What could be read of it, also if the request is rejected. Whether its sender may speak
  /// for `uav_id` is not judged here.
  model::uncrew::Metadata metadata;
  std::variant<model::uncrew::Value, model::Rejection> verdict;
  /// Invalid fields that a live sample goes without: the first ones
  /// (schema::kDroppedFieldsListedMax).
  std::vector<model::DroppedField> dropped;
  /// Further ones, by reason.
  std::vector<model::UnlistedFields> unlisted;
  /// Size of the request as it came.
  std::size_t payload_bytes = 0;
  /// The request could be decoded: a sign of life, whatever the rules said of it.
  bool decoded = false;
  /// Whether the request may stand in a row of quarantine. Where it is false (a video's URI may
  /// hold a password), rejection and dropped fields quote nothing of it.
  bool may_be_kept = false;
  /// Times that were taken as unknown because they were absurd.
  std::uint32_t times_unknown = 0;
  /// Numbers of enumerations that are unknown, and kept.
  std::uint32_t enumerants_unrecognized = 0;
  /// Control characters in texts of the sample, which has U+FFFD in their place.
  std::uint32_t control_characters = 0;

  [[nodiscard]] const model::Rejection* rejection() const {
    return std::get_if<model::Rejection>(&verdict);
  }
  /// Null if the request was rejected.
  [[nodiscard]] const model::uncrew::Value* value() const {
    return std::get_if<model::uncrew::Value>(&verdict);
  }
};

/// Judges one request of the contract's Publish calls: `request` is the bytes of its message. The
/// digest by which a sample is recognized again is of these bytes, as they came, and the type.
///
/// Units:   as the model (schema/model/uncrew).
/// Errors:  bad content is a Rejection; no input makes it throw or abort. Violations of structure
///          reject, and all others of a type that is durable, or durable on change; a live sample
///          goes without the invalid field, and is rejected if nothing else is left of it. Unknown
///          fields are ignored, unknown enumerants are kept.
/// Limits:  limits.h, and those of numbers and texts in schema/limits.h.
/// Thread:  pure; any thread.
[[nodiscard]] Judgement Judge(model::uncrew::SampleType type, std::string_view request);

}  // namespace uplink::uncrew
