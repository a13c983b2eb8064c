#pragma once

#include <cstddef>
#include <vector>

#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// What the stream must do after messages were processed.
struct Processed {
  /// Rejects and Notices, in order; they go out before any later Ack.
  std::vector<v1::RelayResponse> frames;
  /// Messages that were judged, found duplicates or superseded undecoded.
  std::size_t messages = 0;
  /// A settled message came again: answer it by an Ack, even if the Ack does not grow.
  bool ack_owed = false;
  /// The robot is held by another process or stream: process nothing more.
  bool is_void = false;
  /// Messages that were rejected, limited, or had invalid fields.
  std::size_t costly = 0;
};

}  // namespace uplink::session
