#include "server/session/live_intake.h"

#include <utility>
#include <variant>

#include "server/session/frames.h"

namespace uplink::session {

void LiveIntake::TakeRate(std::size_t kind, const limits::BucketSize& rate) {
  if (!metrics::IsTelemetry(kind)) return;
  robot::Rates& rates = sources_.line.robot.rates;
  // A message that is rejected for its size passes at any rate, and must leave no debt.
  if (rates.TelemetryPassesAt(rate, arrived_) <= arrived_) rates.TakeTelemetry(rate, arrived_);
}

void LiveIntake::Add(model::Seq seq, model::Record record, Processed& processed) {
  const auto kind = static_cast<std::size_t>(record.variant());
  SupersedeOlder(kind);
  TellDropped(seq, record.dropped(), kind, processed);
  CountUnlisted(record.unlisted(), kind);
  if (auto replaced = sources_.context.scratch.live.Add(std::move(record))) {
    CountSuperseded();
    sources_.context.judge.Reuse(*std::move(replaced));
  }
}

RcanOrder::Age LiveIntake::AgeOf(const model::RcanState& state) const {
  return rcan_order_ == nullptr ? RcanOrder::Age::kNewer : rcan_order_->AgeOf(state);
}

RcanOrder::Age LiveIntake::See(const model::RcanState& state) {
  const RcanOrder::Age age = AgeOf(state);
  if (age != RcanOrder::Age::kOlder) SupersedeOlder(metrics::kRcanKind);
  if (rcan_order_ == nullptr) rcan_order_ = std::make_unique<RcanOrder>();
  sources_.port.counts().rcan_missing += rcan_order_->See(state);
  return age;
}

void LiveIntake::Add(model::Seq seq, Judged judged, RcanOrder::Age age, Processed& processed) {
  ++sources_.port.counts().rcan_states;
  TellDropped(seq, judged.dropped, metrics::kRcanKind, processed);
  CountUnlisted(judged.unlisted, metrics::kRcanKind);
  if (age == RcanOrder::Age::kSame) return CountSuperseded();
  auto& state = std::get<model::RcanState>(judged.content);
  rcan_order_->Apply(state);
  const FrameLive::Before before = sources_.context.scratch.live.Add(std::move(state));
  if (before == FrameLive::Before::kReplaced) CountSuperseded();
}

void LiveIntake::CountSuperseded() {
  ++sources_.port.counts().received;
  sources_.port.counts().Count(metrics::Became::kSuperseded);
}

void LiveIntake::TellDropped(model::Seq seq, std::span<const model::DroppedField> dropped,
                             std::size_t kind, Processed& processed) {
  if (dropped.empty()) return;
  ++processed.costly;
  sources_.line.robot.state.CountDropped(dropped.size());
  for (const model::DroppedField& field : dropped) {
    sources_.context.ledger.CountDropped(kind, field.reason);
    if (sources_.line.robot.sessions.MayNotice(field.field, arrived_)) {
      sources_.context.probe.notices_total.Add();
      processed.frames.push_back(NoticeFrame(seq, field));
    }
  }
}

void LiveIntake::CountUnlisted(std::span<const model::UnlistedFields> unlisted, std::size_t kind) {
  for (const model::UnlistedFields& fields : unlisted) {
    sources_.line.robot.state.CountDropped(fields.fields);
    sources_.context.ledger.CountDropped(kind, fields.reason, fields.fields);
  }
}

// --- Telemetry over the rate ---

std::optional<std::size_t> LiveIntake::OverRate(const UplinkView& uplink,
                                                const limits::BucketSize& rate) const {
  if (sources_.line.robot.rates.TelemetryPassesAt(rate, arrived_) <= arrived_) return std::nullopt;
  // A too large message is rejected.
  if (uplink.payload.size() > sources_.context.limits.message_bytes_max) return std::nullopt;
  if (uplink.content == UplinkView::Content::kRcanRobotState) return metrics::kRcanKind;
  if (uplink.content != UplinkView::Content::kRoverNexus) return std::nullopt;
  const std::optional<model::Variant> variant =
      sources_.context.judge.VariantOf(std::as_bytes(std::span(uplink.payload)));
  if (!variant) return std::nullopt;
  const auto kind = static_cast<std::size_t>(*variant);
  return metrics::IsTelemetry(kind) ? std::optional(kind) : std::nullopt;
}

void LiveIntake::AddUndecoded(std::size_t kind, const UplinkView& uplink) {
  const std::size_t place = *Surplus::PlaceOf(kind);
  if (surplus_.Put(place, uplink)) SupersedeUnread(place);
}

void LiveIntake::SupersedeOlder(std::size_t kind) {
  if (surplus_.empty()) return;
  const std::optional<std::size_t> place = Surplus::PlaceOf(kind);
  if (place && surplus_.Drop(*place)) SupersedeUnread(*place);
}

void LiveIntake::SupersedeUnread(std::size_t place) {
  const std::size_t kind = metrics::kTelemetryKinds[place];
  CountOverRate(place);
  if (kind == metrics::kRcanKind && rcan_order_ != nullptr) rcan_order_->NoteUnread();
}

void LiveIntake::CountOverRate(std::size_t place) {
  CountSuperseded();
  sources_.context.probe.over_rate_total[place].Add();
  sources_.line.robot.rates.CountOverRate(metrics::kTelemetryKinds[place]);
}

std::optional<SteadyTime> LiveIntake::DecodesAt(const limits::BucketSize& rate) const {
  if (surplus_.empty()) return std::nullopt;
  return sources_.line.robot.rates.TelemetryPassesAt(rate, sources_.context.clock.Steady());
}

void LiveIntake::Decode(const limits::BucketSize& rate, Processed& processed) {
  const bool is_ours = sources_.line.robot.sessions.Knows(sources_.line.session);
  for (std::size_t place = 0; place < metrics::kTelemetryKinds.size(); ++place) {
    const std::optional<UplinkView> uplink = surplus_.Take(place);
    if (!uplink) continue;
    if (is_ours) {
      sources_.line.robot.rates.TakeTelemetry(rate, sources_.context.clock.Steady());
      DecodeOne(*uplink, place, processed);
    } else {
      SupersedeUnread(place);
    }
  }
  surplus_.Shrink();
}

void LiveIntake::DecodeOne(const UplinkView& uplink, std::size_t place, Processed& processed) {
  Judged judged = JudgeUplink(sources_.context, sources_.line.id->ruri, uplink, received_at_);
  sign_of_life_ = sign_of_life_ || judged.sign_of_life;
  if (judged.odd.any()) sources_.context.ledger.CountOdd(judged.odd);
  if (auto* record = std::get_if<model::Record>(&judged.content)) {
    ++sources_.port.counts().records[static_cast<std::size_t>(record->variant())];
    return Add(uplink.seq, std::move(*record), processed);
  }
  const auto* const state = std::get_if<model::RcanState>(&judged.content);
  if (state != nullptr) {
    const RcanOrder::Age age = See(*state);
    if (age != RcanOrder::Age::kOlder) {
      return Add(uplink.seq, std::move(judged), age, processed);
    }
  }
  // Its number is settled, so a Reject would come too late; and it is over the rate.
  ++processed.costly;
  if (state == nullptr) return SupersedeUnread(place);
  // See noted its place in the order.
  CountOverRate(place);
}

void LiveIntake::Apply() {
  if (std::exchange(sign_of_life_, false)) {
    sources_.port.NoteLife(sources_.line, arrived_, received_at_);
  }
  const std::size_t applied = sources_.context.scratch.live.Apply(sources_.line.robot.state,
                                                                  arrived_, sources_.context.judge);
  sources_.port.counts().received += applied;
  sources_.port.counts().applied += applied;
}

}  // namespace uplink::session
