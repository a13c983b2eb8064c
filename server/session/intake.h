#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "metrics/ledger.h"
#include "schema/judge.h"
#include "server/fleet/fleet.h"
#include "server/journal/shards.h"
#include "server/session/frame_view.h"
#include "server/session/limits.h"
#include "server/session/probe.h"
#include "server/session/rcan_order.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::session {

/// What the sessions of one thread use one after the other, so that none needs memory of its own
/// for a frame.
struct IntakeScratch {
  BatchView batch;
  /// Live records of the frame at hand, in order, not applied yet.
  std::vector<model::Record> live;
  /// The last Robot State of the frame at hand, not applied yet.
  std::optional<model::RcanState> rcan;
};

/// What a whole server shares with its sessions, and what a queue's sessions share: the judge, the
/// ledger page and the scratch belong to the queue's thread.
struct SessionContext {
  const Clock& clock;
  fleet::Fleet& fleet;
  const journal::Shards& journals;
  SessionProbe& probe;
  metrics::Ledger& ledger;
  schema::Judge& judge;
  const SessionLimits& limits;
  IntakeScratch& scratch;
};

/// Why no message of a stream may be taken (protocol: Holding back).
enum class Hold : std::uint8_t {
  kNone,
  /// in_flight_uplinks_max of the robot's messages wait for commits.
  kInFlight,
  /// The journal is full.
  kJournal,
  /// The peer does not read.
  kOutgoing,
  /// Too many malformed messages in this second.
  kThrottled,
};

/// Takes the messages of a stream one by one: duplicate, missing or new; judged; live applied,
/// durable and rejected to the journal. It stops in the middle of a batch where the server must
/// hold the stream back, and goes on there.
///
/// Thread:  confined to the stream's thread.
class Intake final {
 public:
  /// `generation` as robot::RobotSessions::Begin gave it.
  Intake(const SessionContext& context, robot::Robot& robot, storage::RobotRef id,
         const model::SessionId& session, std::uint64_t generation);

  /// What taking messages asks of the stream.
  struct Taken {
    /// Rejects and Notices, in order; they go out before any later Ack.
    std::vector<v1::RelayResponse> frames;
    /// Messages that were judged or found duplicates.
    std::size_t messages = 0;
    /// A settled message came again: it is answered by an Ack even if the Ack does not grow.
    bool ack_owed = false;
    /// The robot is held by another process or stream: take nothing more.
    bool is_void = false;
  };

  /// A checked batch becomes the pending one. Must not be called while one is pending. The views
  /// must hold until Keep.
  void Begin(std::span<const UplinkView> uplinks, SteadyTime arrived, SystemTime received_at);
  /// Takes messages of the pending batch until it is done or the stream must be held back.
  /// `outgoing` is the number of frames that wait for the peer already.
  [[nodiscard]] Taken Take(std::size_t outgoing);
  [[nodiscard]] bool pending() const { return !uplinks_.empty(); }
  /// Copies what is still pending: the frame's bytes are about to go.
  void Keep();
  /// Drops what is pending, untaken.
  void Drop();

  /// Whether a message may be taken now, and what keeps it if not. What it says can change at once:
  /// other threads commit and fill the journal.
  [[nodiscard]] Hold Holding(std::size_t outgoing) const;
  /// When messages may be taken again after too many malformed ones in this second, also if that
  /// has come; nothing without too many.
  [[nodiscard]] std::optional<SteadyTime> throttle_end() const;

 private:
  /// What stayed of a frame that could not be taken at once.
  struct Kept {
    std::string bytes;
    std::vector<UplinkView> uplinks;
  };

  [[nodiscard]] robot::Seen See(model::Seq seq);
  void TakeOne(const UplinkView& uplink, Taken& taken);
  void TakeRoverNexus(const UplinkView& uplink, Taken& taken);
  void TakeDuplicate(const robot::Seen& seen, Taken& taken);
  void TakeRecord(const UplinkView& uplink, schema::Judgement& judgement, Taken& taken);
  void TakeLive(model::Record record);
  void TakeRcan(const UplinkView& uplink, Taken& taken);
  void TakeRejected(const UplinkView& uplink, const model::Rejection& rejection, std::size_t kind,
                    Taken& taken);
  void SettleRun();
  void NoteMissing(const robot::Seen& seen);
  void NoteDropped(model::Seq seq, std::span<const model::DroppedField> dropped, std::size_t kind,
                   Taken& taken);
  void NoteMalformed();
  void Append(model::Seq seq, std::variant<model::Record, storage::QuarantineItem> content,
              std::string payload, std::size_t payload_bytes);
  void ApplyLive();
  void Publish();

  const SessionContext& context_;
  journal::Journal& journal_;
  robot::Robot& robot_;
  const storage::RobotRef id_;
  const model::SessionId session_;
  const std::uint64_t generation_;

  /// Those that are pending; empty if none are.
  std::span<const UplinkView> uplinks_;
  std::unique_ptr<Kept> kept_;
  SteadyTime arrived_;
  SystemTime received_at_;
  /// Within one Take: the number before, if it was new, and the highest of the live ones that the
  /// window has not been told of; both 0 otherwise.
  model::Seq new_before_ = 0;
  model::Seq unsettled_ = 0;
  bool sign_of_life_ = false;
  /// Once the stream has sent a Robot State.
  std::unique_ptr<RcanOrder> rcan_order_;
  metrics::UplinkCounts counts_;
  SteadyTime malformed_since_{};
  std::uint32_t malformed_ = 0;
};

}  // namespace uplink::session
