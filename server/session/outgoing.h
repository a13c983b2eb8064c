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

/// What one stream sends: frames in order, one write at a time, and an Ack only when no frame waits
/// before it. So every Reject that an Ack may cover has been written before the Ack. What other
/// robots share goes a few frames at a time, when nothing of the stream's own waits. Confined to
/// the stream's thread.
///
/// Bound: a stream is held back at kOutgoingFramesMax; what commits and one batch add comes on top.
/// Forwards wait in their receiver, and hold nothing back.
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
  /// A stream begins: Welcome, the Rejects that are told once more, then an Ack; and behind these,
  /// unless the robot declined, what the others of its fleet share.
  void Begin(const robot::Resume& resume);
  void PushRejects(std::span<const robot::RejectedSeq> rejects);
  /// Messages were processed: their Rejects and Notices go out, and count towards the next Ack.
  void AddProcessed(Intake::Processed processed);
  /// Commits may have settled messages: the store's Rejects go out, and an Ack that they move.
  void AddProgress();
  /// An Ack goes out behind the frames that wait.
  void MakeAckDue() { ack_.MakeDue(); }
  /// What the others share goes out no more.
  void EndForwards() { receiver_.reset(); }
  /// The stream was woken: it may forward kForwardsPerTurn times more.
  void BeginTurn() { forwards_left_ = kForwardsPerTurn; }
  /// Writes the next frame, unless a write is under way.
  void Flush();
  /// The write under way is done.
  void OnWritten() { write_under_way_ = false; }

  /// Frames that wait.
  [[nodiscard]] std::size_t size() const { return frames_.size(); }
  /// Nothing waits, is under way or is due, but for forwards.
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
  /// What it gave last; empty between two writes.
  std::vector<EncodedFrame> forwards_;
  std::size_t forwards_left_ = kForwardsPerTurn;
};

}  // namespace uplink::session
