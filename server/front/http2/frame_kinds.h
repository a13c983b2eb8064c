#pragma once

#include <cstdint>
#include <optional>

#include <nghttp2/nghttp2.h>

#include "server/front/http2/frame_rates.h"

// What nghttp2's frames are to those who count them.
namespace uplink::front {

/// Of a frame that begins, and is no answer. Nothing for DATA with content, which flow control
/// bounds; of padded DATA only its end says whether it has any.
[[nodiscard]] std::optional<FrameKind> KindOf(const nghttp2_frame_hd& header);
/// It acknowledges a PING or SETTINGS.
[[nodiscard]] bool IsAnswer(const nghttp2_frame_hd& header);
/// It is a PING or SETTINGS that must be acknowledged.
[[nodiscard]] bool AsksForAnswer(const nghttp2_frame_hd& header);
/// HEADERS or DATA: its sender has no more to say on the stream.
[[nodiscard]] bool EndsStream(const nghttp2_frame_hd& header);
/// A whole frame is DATA that has length, and no content, and ends nothing.
[[nodiscard]] bool IsPaddingAlone(const nghttp2_frame& frame);
/// Whether we end a stream with this code for what its peer did. One that is refused may be one of
/// many that were opened before our SETTINGS were read.
[[nodiscard]] bool IsFault(std::uint32_t code);

}  // namespace uplink::front
