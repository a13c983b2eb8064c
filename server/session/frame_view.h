#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "schema/model/ids.h"
#include "server/robot/batch_head.h"

namespace uplink::session {

/// One message of a batch: its payload lies in the frame's own bytes. A value.
struct UplinkView {
  enum class Content : std::uint8_t { kNone, kRoverNexus, kRcanRobotState };

  model::Seq seq = 0;
  Content content = Content::kNone;
  std::string_view payload;
};

/// A batch as it lies in a frame. Reused for the next frame, so that it does not allocate.
struct BatchView {
  std::vector<UplinkView> uplinks;
  robot::BatchHead head;
};

/// Bytes of a frame with a Hello, which holds an address, a session and a version, or with a
/// Goodbye.
inline constexpr std::size_t kHelloFrameBytesMax = std::size_t{16} * 1024;

/// What a frame from an agent holds.
enum class FrameContent : std::uint8_t {
  /// Not a RelayRequest.
  kMalformed,
  /// It holds more than 256 unknown fields, hundreds of hellos or batches, a group, or a Hello or
  /// Goodbye of more than 16 KiB. No version of the protocol sends that, and parsing it is
  /// expensive.
  kForeign,
  kNothing,
  /// Parse the whole frame: it comes once per stream.
  kHello,
  kBatch,
  /// As kHello.
  kGoodbye,
};

/// The errors for frames without usable content.
inline constexpr std::string_view kNoRequest =
    "not a RelayRequest (bad protobuf, or a text that is not UTF-8)";
inline constexpr std::string_view kForeignRequest =
    "more than 256 unknown fields, a group, or a hello or goodbye of more than 16 KiB";

/// Reads a serialized RelayRequest. A batch becomes views into `bytes`, which must outlive them.
/// The rules of protobuf hold: unknown fields are skipped, the last of a oneof counts, and the
/// pieces of a split message are merged.
///
/// A batch of more than `uplinks_max` messages is only counted.
///
/// Thread: pure; any thread.
[[nodiscard]] FrameContent ReadFrame(std::string_view bytes, BatchView& batch,
                                     std::size_t uplinks_max);

}  // namespace uplink::session
