#pragma once

#include <span>

#include <absl/status/status.h>

#include "server/session/forward_source.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// Where a session's frames come from. The transport answers each request with exactly one of
/// Session::OnFrame, OnHalfClose, OnBroken or OnFrameTooLarge, on the stream's thread, after
/// RequestRead has returned.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual void RequestRead() = 0;
};

/// Where a session's frames go. Confined to the stream's thread.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// At most one write is under way; Session::OnWritten, called after Write has returned, ends it.
  virtual void Write(const v1::RelayResponse& frame) = 0;
  /// The same for frames that are serialized already, in order, as one write. At least one.
  virtual void WriteEncoded(std::span<const EncodedFrame> frames) = 0;
  /// Ends the call with this status, after a write under way. The session makes no further call,
  /// and the transport calls nothing but OnBroken.
  virtual void Finish(const absl::Status& status) = 0;
  /// Ends the call at once: the peer takes nothing, or has been given its time.
  virtual void Cancel() = 0;
  /// Asks whether the peer is there: Session::OnPeerAnswered says so. A sink that asks nobody does
  /// nothing, and the robot's silence stays in doubt.
  virtual void AskPeer() = 0;
};

}  // namespace uplink::session
