#pragma once

#include <memory>
#include <string>
#include <vector>

#include "schema/model/ids.h"
#include "server/loop/wake.h"

namespace uplink::session {

/// A serialized RelayResponse that several streams share. Immutable.
using EncodedFrame = std::shared_ptr<const std::string>;

/// One stream as a receiver of its fleet's shapes and objects (protocol: Forwarding). Destroying it
/// ends that.
///
/// Thread: confined to the stream's.
class ForwardReceiver {
 public:
  virtual ~ForwardReceiver() = default;
  /// Adds the next frames that are due to `into`, a few of them, in order; none: the stream is
  /// woken once there are any. They count as written.
  virtual void Take(std::vector<EncodedFrame>& into) = 0;
};

/// What the other robots of a fleet share. Thread-safe; outlives the streams.
class ForwardSource {
 public:
  virtual ~ForwardSource() = default;
  /// The robot's stream wants what the others of its fleet share, beginning with a snapshot.
  [[nodiscard]] virtual std::unique_ptr<ForwardReceiver> Join(const model::RobotId& robot,
                                                              loop::StreamRef stream) = 0;
};

}  // namespace uplink::session
