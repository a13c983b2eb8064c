#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "schema/limits.h"
#include "schema/model/rcan.h"
#include "schema/model/rejection.h"

namespace uplink::schema {

/// Joints of one Robot State.
inline constexpr std::size_t kRcanJointsMax = 256;
/// Depth of the JSON's objects and lists; ours need three.
inline constexpr std::size_t kRcanDepthMax = 32;

/// What judging one Robot State found. A value.
struct RcanJudgement {
  std::variant<model::RcanState, model::Rejection> verdict;
  /// Invalid optional fields, which the state goes without: the first ones
  /// (kDroppedFieldsListedMax).
  std::vector<model::DroppedField> dropped;
  /// Further ones, by reason.
  std::vector<model::UnlistedFields> unlisted;
  /// Control characters in texts of the state, which has U+FFFD in their place.
  std::uint32_t control_characters = 0;
  /// It is an object of this robot, whatever the rules said of it.
  bool sign_of_life = false;

  [[nodiscard]] const model::Rejection* rejection() const {
    return std::get_if<model::Rejection>(&verdict);
  }
};

/// Judges the JSON text of one RCAN Robot State of the robot `ruri`. What depends on the states
/// before it (times, `seq`) is not judged here.
///
/// Units:   as model::RcanState.
/// Errors:  bad content is a Rejection; no input makes it throw or abort. Violations of structure
///          and of required fields reject, an invalid optional field is dropped. Unknown fields are
///          ignored, of a key that stands twice the last one counts.
/// Limits:  `bytes_max` bytes, kRcanJointsMax, kRcanDepthMax, and those of texts in their form.
/// Thread:  pure; any thread.
[[nodiscard]] RcanJudgement JudgeRcanState(std::string_view text, std::string_view ruri,
                                           std::size_t bytes_max,
                                           TextForm texts = TextForm::kAsSent);

/// A state, or a joint, whose time is before that of the one before.
[[nodiscard]] model::Rejection NotMonotonic(std::string_view field, std::int64_t value,
                                            std::int64_t last);

}  // namespace uplink::schema
