#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "schema/model/ids.h"

namespace uplink::session {

/// One message of a batch: its payload lies in the frame's own bytes. A value.
struct UplinkView {
  enum class Content : std::uint8_t { kNone, kRoverNexus, kRcanRobotState };

  model::Seq seq = 0;
  Content content = Content::kNone;
  std::string_view payload;
};

/// A batch as it lies in a frame. Used again for the next frame, so that it needs no memory.
struct BatchView {
  std::vector<UplinkView> uplinks;
  std::int64_t sent_unix_ms = 0;
};

/// What a frame from an agent holds.
enum class FrameContent : std::uint8_t {
  /// Not a RelayRequest.
  kMalformed,
  kNothing,
  /// Parse it whole: it comes once per stream.
  kHello,
  kBatch,
};

/// Reads a serialized RelayRequest; a batch becomes views into `bytes`, which must live as long as
/// they do. What protobuf allows holds: unknown fields are skipped, the last of a oneof counts,
/// parts of a message that comes in pieces are put together.
///
/// Thread: pure; any thread.
[[nodiscard]] FrameContent ReadFrame(std::string_view bytes, BatchView& batch);

}  // namespace uplink::session
