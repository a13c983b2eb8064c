#pragma once

#include <span>

#include <absl/status/status.h>

#include "server/session/forward_source.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// The source of a session's frames. The transport answers each request with exactly one of
/// Session::OnFrame, OnHalfClose, OnBroken or OnFrameTooLarge, on the stream's thread, after
/// RequestRead has returned.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual void RequestRead() = 0;
};

/// The sink of a session's frames. Confined to the stream's thread.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// At most one write is under way; Session::OnWritten, called after Write has returned, ends it.
  virtual void Write(const v1::RelayResponse& frame) = 0;
  /// As Write, for serialized frames: in order, as one write, at least one.
  virtual void WriteEncoded(std::span<const EncodedFrame> frames) = 0;
  /// Ends the call with this status, after a write under way. The session makes no further call,
  /// and the transport calls only OnBroken.
  virtual void Finish(const absl::Status& status) = 0;
  /// Ends the call at once: the peer does not read, or its time is over.
  virtual void Cancel() = 0;
  /// Asks the peer for an answer, which comes by Session::OnPeerAnswered. A sink that cannot ask
  /// does nothing; the robot's silence then stays in doubt.
  virtual void AskPeer() = 0;
};

}  // namespace uplink::session
