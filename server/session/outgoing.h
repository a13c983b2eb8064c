#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/session/ack_release.h"
#include "server/session/attachment.h"
#include "server/session/context.h"
#include "server/session/forward_source.h"
#include "server/session/frame_sink.h"
#include "server/session/intake.h"
#include "server/session/stream_timers.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// What one stream sends: frames in order, one write at a time. An Ack goes only when no frame
/// waits, so every Reject that it covers has been written. Shared items of other robots go a few
/// frames at a time, when nothing of the stream's own waits. Confined to the stream's thread.
///
/// Bound: a stream is held back at kOutgoingFramesMax; commits and one batch may add to that.
/// Forwards wait in their receiver, and do not count.
class Outgoing final {
 public:
  /// All of them outlive it. `robot` is attached before anything is sent.
  struct Sources {
    const SessionContext& context;
    Attachment& robot;
    FrameSink& sink;
    StreamTimers& timers;
  };
  explicit Outgoing(const Sources& sources)
      : context_(sources.context),
        robot_(sources.robot),
        sink_(sources.sink),
        ack_(sources.context, sources.timers) {}

  void Push(v1::RelayResponse frame) { frames_.push_back(std::move(frame)); }
  /// A stream begins: Welcome, the repeated Rejects, then an Ack; after them, unless the robot
  /// declined, what the others of its fleet share.
  void Begin(const robot::Resume& resume);
  void PushRejects(std::span<const robot::RejectedSeq> rejects);
  /// Messages were processed: sends their Rejects and Notices, and counts them for the next Ack.
  void AddProcessed(Intake::Processed processed);
  /// Commits may have settled messages: sends the store's Rejects, and an Ack if they move it.
  void AddProgress();
  /// Sends an Ack after the waiting frames.
  void MakeAckDue() { ack_.MakeDue(); }
  /// Ends forwarding.
  void EndForwards() { receiver_.reset(); }
  /// The stream was woken: it may make kForwardsPerTurn more writes of forwards.
  void BeginTurn() { forwards_left_ = kForwardsPerTurn; }
  /// Writes the next frame, unless a write is under way.
  void Flush();
  /// The write under way is done.
  void OnWritten() { write_under_way_ = false; }

  /// Frames that wait.
  [[nodiscard]] std::size_t size() const { return frames_.size(); }
  /// Nothing waits, is under way or is due, except forwards.
  [[nodiscard]] bool idle() const { return !write_under_way_ && frames_.empty() && !ack_.due(); }

 private:
  [[nodiscard]] std::optional<v1::RelayResponse> NextAck();
  void WriteForwards();

  const SessionContext& context_;
  Attachment& robot_;
  FrameSink& sink_;
  AckRelease ack_;
  std::deque<v1::RelayResponse> frames_;
  bool write_under_way_ = false;
  /// Null while nothing is forwarded.
  std::unique_ptr<ForwardReceiver> receiver_;
  /// The frames that it gave last; empty between two writes.
  std::vector<EncodedFrame> forwards_;
  std::size_t forwards_left_ = kForwardsPerTurn;
};

}  // namespace uplink::session
