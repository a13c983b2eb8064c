#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "storage/epoch.h"
#include "storage/live_parts.h"

namespace uplink::storage {

/// Rows of one call of Store::Checkpoint, and their bytes: a commit waits for it. A robot's parts
/// have some KiB together, so that the rows bound nearly all calls; 4 MiB of large parts took
/// SQLite 0.2 s.
inline constexpr std::size_t kCheckpointRowsMax = 500;
inline constexpr std::size_t kCheckpointBytesMax = std::size_t{256} * 1024;

/// How far a session of a robot is settled, live messages included.
struct SettledSession {
  model::SessionId session;
  model::Seq settled_seq = 0;

  friend bool operator==(const SettledSession&, const SettledSession&) = default;
};

/// What a checkpoint keeps of a robot's live state. Whatever a write leaves unset stays as the
/// store has it. A value.
struct LiveRow {
  std::string ruri;
  /// The epoch since which the process held the robot that wrote this.
  Epoch held_since = 0;
  std::optional<SystemTime> last_sign_of_life;
  std::optional<std::int64_t> clock_skew_ms;
  /// Reader::Robots returns it; Reader::LiveOf leaves it out.
  std::optional<SettledSession> session;
  /// By LivePart; the bytes are the server's own, and mean nothing to a store.
  std::array<std::optional<std::string>, kLivePartKinds> parts;

  friend bool operator==(const LiveRow&, const LiveRow&) = default;
};

/// Bytes of the row's parts.
[[nodiscard]] inline std::size_t BytesOf(const LiveRow& row) {
  std::size_t bytes = 0;
  for (const auto& part : row.parts) bytes += part ? part->size() : 0;
  return bytes;
}

}  // namespace uplink::storage
