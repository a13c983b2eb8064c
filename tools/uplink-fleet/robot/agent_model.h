#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/rejection.h"
#include "tools/uplink-fleet/robot/send_queue.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::synthetic {

/// Numbered messages that no Ack has covered; at it nothing new is numbered.
inline constexpr std::size_t kKeptMax = 8192;

/// A durable message that an Ack let the agent forget.
struct Settled {
  model::Seq seq = 0;
  std::uint64_t tag = 0;
  /// The Reject that came before the Ack.
  std::optional<model::Rejection> rejection;
  SteadyTime due{};
};

/// One agent's side of the relay protocol for one session: it numbers, keeps, resends and forgets,
/// and knows no transport. Streams come and go between BeginStream and EndStream.
///
/// Errors: what the server may not do comes back as kInternal with the rule that it broke; the
///         stream should be ended then.
/// Thread: confined to one thread.
/// Source: protocol page, Numbers, Ack, Hello and Welcome.
class AgentModel final {
 public:
  explicit AgentModel(const model::SessionId& session) : session_(session) {}

  /// From the next stream on it takes what others share; it declines that before.
  void Receive() { declines_ = false; }
  /// Takes a message for sending; false if too many durable ones wait.
  bool Offer(Outgoing message) { return send_queue_.Offer(std::move(message)); }
  /// What waits is due at `due`, whenever it was offered.
  void DueAt(SteadyTime due) { send_queue_.DueAt(due); }
  /// How many durable messages more Offer takes now.
  [[nodiscard]] std::size_t durable_room() const { return send_queue_.durable_room(); }

  /// A new stream: the Hello that opens it. Nothing may be sent before the Welcome.
  [[nodiscard]] v1::Hello BeginStream(const std::string& agent_version);
  /// One frame from the server.
  [[nodiscard]] absl::Status OnFrame(const v1::RelayResponse& frame, SteadyTime now);
  /// The next batch to send, with numbers; none if nothing may be sent now. `uplinks_max` narrows
  /// the server's own limit.
  [[nodiscard]] std::optional<v1::UplinkBatch> NextBatch(SteadyTime now, std::size_t uplinks_max);
  /// The stream is over, in whatever way.
  void EndStream();

  /// Durable messages that Acks covered since the last call, in number order.
  [[nodiscard]] std::vector<Settled> TakeSettled() { return std::exchange(settled_, {}); }
  /// Tags of the durable messages that gave way to later ones of the same, unsent or rate-limited,
  /// since the last call.
  [[nodiscard]] std::vector<std::uint64_t> TakeReplaced() { return send_queue_.TakeReplaced(); }
  /// When the live messages that Acks covered since the last call were due.
  [[nodiscard]] std::vector<SteadyTime> TakeJudged() { return std::exchange(judged_due_, {}); }
  /// When the live messages were due that gave way, unsent or rate-limited, since the last call.
  [[nodiscard]] std::vector<SteadyTime> TakeGaveWay();

  /// Welcome came and neither Drain nor the stream's end since.
  [[nodiscard]] bool may_send() const { return phase_ == Phase::kOpen; }
  [[nodiscard]] bool welcomed() const {
    return phase_ != Phase::kClosed && phase_ != Phase::kGreeting;
  }
  /// Something must still be sent again on this stream.
  [[nodiscard]] bool resending() const;
  [[nodiscard]] std::size_t waiting() const { return send_queue_.waiting(); }
  /// Messages that were not sent on this stream.
  [[nodiscard]] Unsent unsent() const;
  /// Messages that have a number and no Ack.
  [[nodiscard]] std::size_t unacked() const { return kept_.size(); }
  /// No durable message waits for a number or for an Ack.
  [[nodiscard]] bool durable_settled() const;
  /// Nothing at all waits.
  [[nodiscard]] bool all_settled() const;

  [[nodiscard]] const model::SessionId& session() const { return session_; }
  /// Highest number given; numbers begin at 1 and none is skipped.
  [[nodiscard]] model::Seq last_seq() const { return next_seq_ - 1; }
  [[nodiscard]] model::Seq settled_seq() const { return settled_seq_; }
  [[nodiscard]] model::Seq judged_seq() const { return judged_seq_; }
  /// Uplinks handed out by NextBatch, and how many of them were not the first time.
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  [[nodiscard]] std::uint64_t resent() const { return resent_; }
  [[nodiscard]] std::uint64_t rejects() const { return rejects_; }
  [[nodiscard]] std::uint64_t notices() const { return notices_; }

 private:
  enum class Phase : std::uint8_t { kClosed, kGreeting, kOpen, kDraining };
  struct Kept {
    Outgoing message;
    std::optional<model::Rejection> rejection;
  };

  absl::Status OnWelcome(const v1::Welcome& welcome);
  absl::Status OnAck(const v1::Ack& ack);
  absl::Status OnReject(const v1::Reject& reject, SteadyTime now);
  void Forget();
  /// A message of the same that was sent after that number has no Ack yet.
  [[nodiscard]] bool NewerSent(model::Seq seq, const std::string& latest_of) const;
  void Append(v1::UplinkBatch& batch, model::Seq seq, const Outgoing& message);
  [[nodiscard]] bool Fits(const v1::UplinkBatch& batch, std::size_t bytes, const Outgoing& message,
                          std::size_t uplinks_max) const;

  model::SessionId session_;
  bool declines_ = true;
  Phase phase_ = Phase::kClosed;
  v1::Limits limits_;
  model::Seq next_seq_ = 1;
  /// Next kept number to send again on this stream; kept numbers below it were sent on it.
  model::Seq resend_from_ = 1;
  /// The highest Ack.through_seq ever received.
  model::Seq settled_seq_ = 0;
  /// The highest Ack.judged_seq ever received: what lets live messages go.
  model::Seq acked_judged_seq_ = 0;
  /// What Hello.judged_seq says.
  model::Seq judged_seq_ = 0;
  /// The last Ack of this stream, to see that both numbers only grow.
  v1::Ack stream_ack_;

  SendQueue send_queue_;
  std::map<model::Seq, Kept> kept_;
  std::size_t durable_kept_ = 0;
  std::vector<Settled> settled_;
  std::vector<SteadyTime> judged_due_;
  /// Of live messages that the server called too frequent.
  std::vector<SteadyTime> rate_limited_due_;

  std::uint64_t sent_ = 0;
  std::uint64_t resent_ = 0;
  std::uint64_t rejects_ = 0;
  std::uint64_t notices_ = 0;
};

}  // namespace uplink::synthetic
