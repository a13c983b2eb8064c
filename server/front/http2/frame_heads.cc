#include "server/front/http2/frame_heads.h"

#include <algorithm>
#include <span>

#include <nghttp2/nghttp2.h>

namespace uplink::front {
namespace {

constexpr std::string_view kNoNumber("\0\0\0\0", 4);
/// The number and the code. nghttp2 ends a connection for a GOAWAY that is shorter.
constexpr std::size_t kGoawayBytesMin = 8;

/// Its highest bit means nothing.
std::uint32_t StreamIn(std::span<const std::uint8_t> head) {
  return ((std::uint32_t{head[5]} & 0x7FU) << 24U) | (std::uint32_t{head[6]} << 16U) |
         (std::uint32_t{head[7]} << 8U) | head[8];
}

}  // namespace

std::string_view FrameHeads::TakePart(std::string_view& bytes) {
  const std::string_view all = bytes;
  if (number_left_ > 0) {
    const std::size_t taken = std::min(number_left_, all.size());
    number_left_ -= taken;
    bytes.remove_prefix(taken);
    return kNoNumber.substr(0, taken);
  }
  std::size_t taken = 0;
  while (taken < all.size() && number_left_ == 0) {
    if (left_ > 0) {
      const std::size_t passed = std::min(left_, all.size() - taken);
      left_ -= passed;
      taken += passed;
      continue;
    }
    head_[head_bytes_++] = static_cast<std::uint8_t>(all[taken++]);
    if (head_bytes_ == kHeadBytes) OnHead();
  }
  bytes.remove_prefix(taken);
  return all.substr(0, taken);
}

void FrameHeads::OnHead() {
  head_bytes_ = 0;
  left_ = (std::size_t{head_[0]} << 16U) | (std::size_t{head_[1]} << 8U) | head_[2];
  if (head_[3] == NGHTTP2_DATA && ended_ != 0 && StreamIn(head_) == ended_) sent_past_end_ = true;
  if (head_[3] != NGHTTP2_GOAWAY || left_ < kGoawayBytesMin) return;
  number_left_ = kNoNumber.size();
  left_ -= number_left_;
}

}  // namespace uplink::front
