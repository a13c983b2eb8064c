#include "server/session/intake.h"

#include "server/robot/mutation.h"
#include "server/session/judged.h"
#include "server/session/limits.h"

namespace uplink::session {

using ingest::Block;
using robot::HeldBack;

Block FindBlockOfAll(const robot::Robot& robot, std::size_t outgoing, SteadyTime now) {
  if (outgoing >= kOutgoingFramesMax) return {.by = HeldBack::kUnread};
  const std::optional<SteadyTime> throttled = robot.throttle.end();
  if (throttled && now < *throttled) return {.by = HeldBack::kMalformed, .until = throttled};
  const std::optional<SteadyTime> limited = robot.limited_throttle.end();
  if (limited && now < *limited) return {.by = HeldBack::kFlow, .until = limited};
  return {};
}

Intake::Intake(const Sources& sources)
    : context_(sources.context),
      robot_(sources.robot),
      timers_(sources.timers),
      line_{.robot = robot_,
            .id = robot_.id(),
            .journal = context_.journals.Of(robot_.ruri()),
            .session = sources.session,
            .by = sources.by},
      port_({.clock = context_.clock,
             .fleet = context_.fleet,
             .ledger = context_.ledger,
             .allowances = context_.allowances,
             .in_flight_max = context_.limits.in_flight_uplinks_max,
             .payload_bytes_max = context_.limits.payload_bytes_max,
             // Its agent sends it again, to the server that has the robot.
             .lost_counts_as = metrics::Became::kSuperseded}),
      numbers_(robot_.sessions, line_.session),
      ranges_(line_, port_, numbers_),
      live_({.context = context_, .line = line_, .port = port_}),
      uplinks_{.context = context_,
               .robot = robot_,
               .session = line_.session,
               .port = port_,
               .numbers = numbers_,
               .ranges = ranges_,
               .live = live_} {}

void Intake::Begin(std::span<const UplinkView> uplinks, SteadyTime arrived,
                   SystemTime received_at) {
  batch_.Begin(uplinks);
  arrived_ = {.steady = arrived, .system = received_at};
  ranges_.Begin(arrived, received_at);
  live_.Begin(arrived, received_at);
}

Block Intake::FindBlock(std::size_t outgoing) {
  // Also while a message waits, since a reload may release it.
  port_.FollowReload();
  const Block block = FindBlockOfAll(robot_, outgoing, context_.clock.Steady());
  return block.none() && front_cost_ ? port_.FindBlock(line_, ingest::Waits::kStream, *front_cost_)
                                     : block;
}

bool Intake::MayDecodeSurplus() const {
  const std::optional<SteadyTime> at = live_.DecodesAt(port_.allowance().telemetry);
  return at && *at <= context_.clock.Steady();
}

Intake::Processed Intake::Process(std::size_t outgoing) {
  Processed processed;
  numbers_.Begin();
  costly_ = 0;
  if (MayDecodeSurplus()) live_.Decode(port_.allowance().telemetry, processed);
  while (pending() && !processed.is_void && !rejects_full() && !yields() &&
         FindBlock(outgoing + processed.frames.size()).none()) {
    if (!ProcessUplink(batch_.front(), processed)) break;
    costly_ = processed.costly;
    front_cost_.reset();
    batch_.PopFront();
  }
  ranges_.Flush();
  numbers_.Flush();
  live_.Apply();
  port_.Publish();
  if (const auto at = live_.DecodesAt(port_.allowance().telemetry)) {
    timers_.Set(Timer::kSurplus, *at);
  } else {
    timers_.Clear(Timer::kSurplus);
  }
  // The batch's own bytes may be freed now.
  live_.Keep();
  if (!pending() || processed.is_void) Drop();
  return processed;
}

void Intake::End() {
  const limits::BucketSize& rate = port_.allowance().telemetry;
  if (!live_.DecodesAt(rate)) return;
  Processed untold;
  live_.Decode(rate, untold);
  live_.Apply();
  port_.Publish();
}

bool Intake::ProcessUplink(const UplinkView& uplink, Processed& processed) {
  const robot::Seen seen = numbers_.See(uplink.seq);
  if (seen.as == robot::SeenAs::kVoid) {
    processed.is_void = true;
    return true;
  }
  if (seen.as == robot::SeenAs::kDuplicate) {
    CountDuplicate(seen, processed);
    return true;
  }
  if (const auto kind = live_.OverRate(uplink, port_.allowance().telemetry)) {
    if (!AddUndecoded(*kind, uplink, seen)) return false;
  } else {
    Judged judged = JudgeUplink(context_, line_.id->ruri, uplink, arrived_.system);
    NewUplink message(uplinks_, uplink, arrived_, seen, judged, processed);
    if (port_.Offer(line_, message).answer == ingest::Port::Answer::kWaits) {
      WaitFor(message.cost());
      return false;
    }
  }
  ++processed.messages;
  return true;
}

bool Intake::AddUndecoded(std::size_t kind, const UplinkView& uplink, const robot::Seen& seen) {
  if (!HasRoom(ranges_.CostOfGap(seen))) return false;
  ranges_.AddGap(seen);
  live_.AddUndecoded(kind, uplink);
  numbers_.AddSettled(uplink.seq);
  return true;
}

bool Intake::HasRoom(const ingest::RecordCost& cost) {
  if (cost.journal_bytes == 0 || port_.FindBlock(line_, ingest::Waits::kStream, cost).none()) {
    return true;
  }
  WaitFor(cost);
  return false;
}

void Intake::WaitFor(const ingest::RecordCost& cost) {
  front_cost_ = cost;
  numbers_.PutBack();
}

void Intake::CountDuplicate(const robot::Seen& seen, Processed& processed) {
  ++port_.counts().received;
  port_.counts().Count(metrics::Became::kDuplicate);
  if (robot::Planted(robot::Mutation::kDuplicateNotAcked)) return;
  ++processed.messages;
  if (!seen.waits) processed.ack_owed = true;
}

}  // namespace uplink::session
