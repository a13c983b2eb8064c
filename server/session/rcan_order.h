#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "schema/model/rcan.h"
#include "server/robot/latest_by_key.h"

namespace uplink::session {

/// Joints whose last sample a stream keeps.
inline constexpr std::size_t kLastSamplesMax = 256;

/// The order of the Robot States of one stream: RCAN's session begins with each Hello. Confined to
/// the stream's thread.
class RcanOrder final {
 public:
  /// The age of a state compared with the one before.
  enum class Age : std::uint8_t {
    kNewer,
    /// The same sample again.
    kSame,
    kOlder,
  };
  [[nodiscard]] Age AgeOf(const model::RcanState& state) const;
  /// The time of the state before; valid if AgeOf is not kNewer.
  [[nodiscard]] std::int64_t last_timestamp_us() const { return last_timestamp_us_.value_or(0); }

  /// One state was superseded without See: its number does not count as skipped.
  void NoteUnread() { ++unread_; }
  /// Sees the number of a state before Apply, whatever becomes of it. Returns how many were skipped
  /// before it.
  std::uint64_t See(const model::RcanState& state);
  /// The state becomes the last one. A joint in it that is not newer than its last sample gets that
  /// sample back. Counts all skipped numbers into the state.
  void Apply(model::RcanState& state);

 private:
  std::optional<std::int64_t> last_timestamp_us_;
  std::optional<std::int64_t> last_seq_;
  std::uint64_t missing_ = 0;
  /// Unread states since the state before.
  std::uint64_t unread_ = 0;
  robot::LatestByKey<model::RcanJoint, kLastSamplesMax> last_samples_;
};

}  // namespace uplink::session
