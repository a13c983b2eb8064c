#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "server/ingest/port.h"
#include "server/robot/robot.h"
#include "server/session/context.h"
#include "server/session/frame_view.h"
#include "server/session/judged.h"
#include "server/session/processed.h"
#include "server/session/rcan_order.h"
#include "server/session/surplus.h"

namespace uplink::session {

/// The live messages of a stream. Those of one frame are applied to the robot's state together.
/// Telemetry (metrics::kTelemetryKinds) over the robot's rate is superseded undecoded, except the
/// latest of each kind, which is decoded once the rate allows it.
///
/// Thread: confined to the stream's thread.
class LiveIntake final {
 public:
  /// All of it outlives this.
  struct Sources {
    const SessionContext& context;
    const ingest::Line& line;
    ingest::Port& port;
  };
  explicit LiveIntake(const Sources& sources) : sources_(sources) {}

  /// Begins a frame that arrived at this time.
  void Begin(SteadyTime arrived, SystemTime received_at) {
    arrived_ = arrived;
    received_at_ = received_at;
  }

  // --- Decoded messages, whose numbers the caller settles ---

  /// A message of this kind was decoded: telemetry takes from its rate.
  void TakeRate(std::size_t kind, const limits::BucketSize& rate);
  /// The current message is a sign of life.
  void NoteLife() { sign_of_life_ = true; }
  void Add(model::Seq seq, model::Record record, Processed& processed);
  /// The age of a state compared with the one before; changes nothing.
  [[nodiscard]] RcanOrder::Age AgeOf(const model::RcanState& state) const;
  /// Notes its place in the order, whatever becomes of it; returns its age.
  [[nodiscard]] RcanOrder::Age See(const model::RcanState& state);
  /// The time of the state before one that is kOlder.
  [[nodiscard]] std::int64_t last_timestamp_us() const { return rcan_order_->last_timestamp_us(); }
  /// Adds a Robot State for which See returned this age, not kOlder.
  void Add(model::Seq seq, Judged judged, RcanOrder::Age age, Processed& processed);
  // --- Telemetry over the rate ---

  /// The kind of a message that must not be decoded now: telemetry, over the rate of its robot.
  [[nodiscard]] std::optional<std::size_t> OverRate(const UplinkView& uplink,
                                                    const limits::BucketSize& rate) const;
  /// Holds such a message; an older one of its kind is superseded.
  void AddUndecoded(std::size_t kind, const UplinkView& uplink);
  /// When the latest held message may be decoded; empty if none is held.
  [[nodiscard]] std::optional<SteadyTime> DecodesAt(const limits::BucketSize& rate) const;
  /// Decodes the held message of each kind. One that judgement rejects is superseded.
  void Decode(const limits::BucketSize& rate, Processed& processed);
  /// Copies what is held: the bytes of its batch are about to go.
  void Keep() { surplus_.Keep(); }

  /// Applies everything that was added to the robot's state, and counts it.
  void Apply();

 private:
  void CountSuperseded();
  void DecodeOne(const UplinkView& uplink, std::size_t place, Processed& processed);
  /// Supersedes the held message of this kind: a newer one was decoded.
  void SupersedeOlder(std::size_t kind);
  /// Supersedes the message held in this place, which See never saw.
  void SupersedeUnread(std::size_t place);
  /// Counts the message held in this place as superseded.
  void CountOverRate(std::size_t place);
  void TellDropped(model::Seq seq, std::span<const model::DroppedField> dropped, std::size_t kind,
                   Processed& processed);
  void CountUnlisted(std::span<const model::UnlistedFields> unlisted, std::size_t kind);

  const Sources sources_;
  SteadyTime arrived_;
  SystemTime received_at_;
  bool sign_of_life_ = false;
  Surplus surplus_;
  /// Once the stream has sent a Robot State.
  std::unique_ptr<RcanOrder> rcan_order_;
};

}  // namespace uplink::session
