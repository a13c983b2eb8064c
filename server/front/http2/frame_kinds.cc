#include "server/front/http2/frame_kinds.h"

namespace uplink::front {
namespace {

bool IsPingOrSettings(const nghttp2_frame_hd& header) {
  return header.type == NGHTTP2_PING || header.type == NGHTTP2_SETTINGS;
}

}  // namespace

std::optional<FrameKind> KindOf(const nghttp2_frame_hd& header) {
  switch (header.type) {
    case NGHTTP2_DATA:
      if (header.length > 0 || (header.flags & NGHTTP2_FLAG_END_STREAM) != 0) return std::nullopt;
      return FrameKind::kEmptyData;
    case NGHTTP2_HEADERS:
      return FrameKind::kHeaders;
    case NGHTTP2_CONTINUATION:
      return FrameKind::kContinuation;
    case NGHTTP2_RST_STREAM:
      return FrameKind::kReset;
    case NGHTTP2_PING:
      return FrameKind::kPing;
    case NGHTTP2_SETTINGS:
      return FrameKind::kSettings;
    case NGHTTP2_PRIORITY:
      return FrameKind::kPriority;
    case NGHTTP2_WINDOW_UPDATE:
      return FrameKind::kWindowUpdate;
    default:  // the protocol may have more
      return FrameKind::kUnknown;
  }
}

bool IsAnswer(const nghttp2_frame_hd& header) {
  return IsPingOrSettings(header) && (header.flags & NGHTTP2_FLAG_ACK) != 0;
}

bool AsksForAnswer(const nghttp2_frame_hd& header) {
  return IsPingOrSettings(header) && (header.flags & NGHTTP2_FLAG_ACK) == 0;
}

bool EndsStream(const nghttp2_frame_hd& header) {
  return (header.flags & NGHTTP2_FLAG_END_STREAM) != 0;
}

bool IsPaddingAlone(const nghttp2_frame& frame) {
  return frame.hd.type == NGHTTP2_DATA && frame.hd.length > 0 &&
         frame.hd.length == frame.data.padlen && (frame.hd.flags & NGHTTP2_FLAG_END_STREAM) == 0;
}

bool IsFault(std::uint32_t code) {
  return code != NGHTTP2_NO_ERROR && code != NGHTTP2_CANCEL && code != NGHTTP2_REFUSED_STREAM;
}

}  // namespace uplink::front
