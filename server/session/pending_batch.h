#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/session/frame_view.h"

namespace uplink::session {

/// The unprocessed messages of one batch. They lie in the frame's own bytes until Keep copies them.
/// Confined to the stream's thread.
///
/// Bound: one frame (limits.frame_bytes_max).
class PendingBatch final {
 public:
  [[nodiscard]] bool empty() const { return uplinks_.empty(); }
  /// No messages may be pending. The views must stay valid until Keep.
  void Begin(std::span<const UplinkView> uplinks) { uplinks_ = uplinks; }
  [[nodiscard]] const UplinkView& front() const { return uplinks_.front(); }
  void PopFront() { uplinks_ = uplinks_.subspan(1); }
  /// Copies pending messages: the frame's bytes are about to go.
  void Keep();
  /// Drops pending messages unprocessed.
  void Drop();

 private:
  /// The copy of a frame that could not be processed at once.
  struct Kept {
    std::string bytes;
    std::vector<UplinkView> uplinks;
  };

  std::span<const UplinkView> uplinks_;
  std::unique_ptr<Kept> kept_;
};

}  // namespace uplink::session
