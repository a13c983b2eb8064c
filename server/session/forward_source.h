#pragma once

#include <memory>
#include <string>
#include <vector>

#include "schema/model/ids.h"
#include "server/loop/wake.h"

namespace uplink::session {

/// A serialized RelayResponse that several streams share. Immutable.
using EncodedFrame = std::shared_ptr<const std::string>;

/// One stream as a receiver of its fleet's shapes and objects (protocol: Forwarding). The
/// destructor ends that.
///
/// Thread: confined to the stream's.
class ForwardReceiver {
 public:
  virtual ~ForwardReceiver() = default;
  /// Adds the next few frames to `into`, in order; they count as written. If there are none, the
  /// stream is woken once there are.
  virtual void Take(std::vector<EncodedFrame>& into) = 0;
};

/// What the other robots of a fleet share. Thread-safe; outlives the streams.
class ForwardSource {
 public:
  virtual ~ForwardSource() = default;
  /// Begins to send the stream what the others of its fleet share, with a snapshot first.
  [[nodiscard]] virtual std::unique_ptr<ForwardReceiver> Join(const model::RobotId& robot,
                                                              loop::StreamRef stream) = 0;
};

}  // namespace uplink::session
