#include "tools/uplink-fleet/robot/agent.h"

#include <chrono>
#include <limits>
#include <utility>

namespace uplink::synthetic {
namespace {

constexpr std::chrono::seconds kBatchAgeMax{1};
/// While the robots settle, each still says once per second that it is alive.
constexpr std::chrono::seconds kIdleMotion{1};
/// Longer than that without a frame, a robot counts as silent; below any useful presence.timeout.
constexpr std::chrono::seconds kSilence{3};
/// More durable messages than a tick of a script makes: 1,000 fault reports per second, each with
/// its event, and a tick of ten seconds.
constexpr std::size_t kDurableATickMax = 25'000;
constexpr const char* kAgentVersion = "uplink-fleet " UPLINK_VERSION;

}  // namespace

Agent::Agent(const Phase& phase, std::size_t index, const model::SessionId& session, Shared& shared,
             Latencies& latencies)
    : script_(phase.options, index),
      model_(session),
      shared_(shared),
      latencies_(latencies),
      batch_(phase.batch),
      flood_(phase.flood),
      mark_(MarkOf(phase.options.run, index)) {}

void Agent::Receive(const std::string& ruri, ForwardReader& reader) {
  table_.emplace(ruri, reader);
  model_.Receive();
}

void Agent::Adopt(const Phase& phase) {
  script_.Adopt(phase.options);
  batch_ = phase.batch;
  flood_ = phase.flood;
}

void Agent::Offer(Outgoing message, SteadyTime due) {
  message.due = due;
  // LifeAt leaves room; were there none, the account would call it never acked.
  if (!model_.Offer(std::move(message))) shared_.first_error.Keep("too many messages wait");
}

void Agent::LiveOffline(milliseconds age, SteadyTime::duration tick, SystemTime now) {
  for (SteadyTime::duration left = age; left.count() > 0; left -= tick) {
    const auto at = now - std::chrono::duration_cast<SystemTime::duration>(left);
    for (Outgoing& message : LifeAt(UnixMs(at))) Offer(std::move(message), {});
  }
  // No message waited that long: without a connection none could be sent.
  static_cast<void>(model_.TakeGaveWay());
  for (const std::uint64_t tag : model_.TakeReplaced()) account_.GiveWay(tag);
}

bool Agent::HasRoom() const {
  return model_.durable_room() >= kDurableATickMax && !account_.full();
}

std::vector<Outgoing> Agent::LifeAt(std::int64_t now_ms) {
  // A robot whose memory is full of unsent messages goes on moving, and reports nothing new.
  if (HasRoom()) return script_.Tick(now_ms, account_);
  if (!std::exchange(only_moves_, true)) shared_.only_moving.fetch_add(1);
  std::vector<Outgoing> messages;
  messages.push_back(script_.OnlyMove(now_ms, account_));
  return messages;
}

void Agent::Fill(SteadyTime now, SystemTime system_now) {
  if (!flood_ || !model_.may_send() ||
      shared_.stage.load(std::memory_order_relaxed) != Stage::kRun) {
    return;
  }
  while (model_.unacked() + model_.waiting() < kFloodAhead && model_.waiting() < batch_) {
    Offer(script_.Again(UnixMs(system_now), account_), now);
  }
}

void Agent::Tick(SteadyTime now, SystemTime system_now) {
  const std::int64_t now_ms = UnixMs(system_now);
  switch (shared_.stage.load(std::memory_order_acquire)) {
    case Stage::kRun:
      for (Outgoing& message : LifeAt(now_ms)) Offer(std::move(message), now);
      NoteGaveWay(now);
      break;
    case Stage::kSettle:
      if (now >= next_idle_motion_) {
        next_idle_motion_ = now + kIdleMotion;
        Offer(script_.Motion(now_ms, account_), now);
      }
      if (model_.durable_settled() && !std::exchange(reported_settled_, true)) {
        shared_.settled_robots.fetch_add(1);
      }
      break;
    case Stage::kLast:
      if (last_offered_ < shared_.last_round.load()) {
        ++last_offered_;
        std::vector<Outgoing> last = script_.Last(now_ms, account_);
        last_motion_ = last.front();
        next_idle_motion_ = now + kIdleMotion;
        for (Outgoing& message : last) Offer(std::move(message), now);
      } else if (last_offered_ > 0 && reported_last_ == last_offered_ && now >= next_idle_motion_) {
        // Looking at thousands of robots takes longer than the server waits for a sign of life. The
        // same motion again changes nothing of what is looked at.
        next_idle_motion_ = now + kIdleMotion;
        Offer(last_motion_, now);
      }
      if (model_.all_settled() && reported_last_ < last_offered_) {
        reported_last_ = last_offered_;
        shared_.last_robots.fetch_add(1);
      }
      ShowForwards();
      break;
    case Stage::kClose:
      break;
  }
  if (model_.waiting() == 0) {
    waiting_since_.reset();
  } else if (!waiting_since_) {
    waiting_since_ = now;
  }
}

std::optional<v1::RelayRequest> Agent::NextFrame(SteadyTime now, SystemTime system_now) {
  const bool due = shared_.stage.load(std::memory_order_relaxed) != Stage::kRun ||
                   model_.resending() || model_.waiting() >= batch_ ||
                   (waiting_since_ && now - *waiting_since_ >= kBatchAgeMax);
  if (!due) return std::nullopt;
  std::optional<v1::UplinkBatch> batch =
      model_.NextBatch(now, std::numeric_limits<std::size_t>::max());
  if (!batch) return std::nullopt;
  waiting_since_.reset();
  if (last_sent_ && now - *last_sent_ > kSilence) ++silences_;
  last_sent_ = now;
  shared_.sent.fetch_add(static_cast<std::uint64_t>(batch->uplinks_size()),
                         std::memory_order_relaxed);
  batch->set_sent_unix_ms(UnixMs(system_now));
  const Unsent unsent = model_.unsent();
  batch->set_backlog_uplinks(unsent.messages);
  if (unsent.since) {
    const auto waits = std::chrono::duration_cast<milliseconds>(now - *unsent.since);
    batch->set_oldest_unsent_unix_ms(UnixMs(system_now - waits));
  }
  v1::RelayRequest frame;
  *frame.mutable_batch() = std::move(*batch);
  return frame;
}

v1::RelayRequest Agent::BeginStream() {
  v1::RelayRequest frame;
  *frame.mutable_hello() = model_.BeginStream(kAgentVersion);
  return frame;
}

absl::Status Agent::OnFrame(const v1::RelayResponse& frame, SteadyTime now) {
  if (frame.has_drain()) shared_.drains.fetch_add(1, std::memory_order_relaxed);
  if (frame.has_reject()) shared_.CountReject(frame.reject().reason());
  if (frame.has_welcome()) shared_.welcomes.fetch_add(1, std::memory_order_relaxed);
  absl::Status status = model_.OnFrame(frame, now);
  if (table_ && frame.has_welcome()) {
    table_->BeginStream();
    snapshot_since_ = now;
  } else if (table_ && frame.has_forward() && model_.welcomed()) {
    TakeForward(frame.forward(), now);
  }
  for (Settled& settled : model_.TakeSettled()) {
    if (frame.has_ack()) latencies_.durable.Record(now - settled.due);
    if (account_.Settle(std::move(settled))) {
      shared_.acked_durable.fetch_add(1, std::memory_order_relaxed);
    }
  }
  for (const SteadyTime due : model_.TakeJudged()) latencies_.live.Record(now - due);
  NoteGaveWay(now);
  if (status.ok() && frame.has_resend_request() && HasRoom()) {
    for (Outgoing& message : script_.Answer(frame.resend_request(), account_)) {
      Offer(std::move(message), now);
    }
  }
  return status;
}

void Agent::TakeForward(const v1::Forward& forward, SteadyTime now) {
  table_->Take(forward);
  if (!snapshot_since_ || !table_->whole()) return;
  const SteadyTime::duration took = now - *std::exchange(snapshot_since_, std::nullopt);
  latencies_.snapshot.Record(took);
  if (std::exchange(late_, false)) latencies_.late_snapshot.Record(took);
}

void Agent::ShowForwards() {
  const std::size_t asked = shared_.forwards.asked();
  if (!table_ || std::exchange(shown_, asked) == asked) return;
  shared_.forwards.Show(asked, {table_->ruri(), table_->whole(), table_->Held()});
}

void Agent::NoteGaveWay(SteadyTime now) {
  for (const std::uint64_t tag : model_.TakeReplaced()) account_.GiveWay(tag);
  for (const SteadyTime due : model_.TakeGaveWay()) latencies_.gave_way.Record(now - due);
}

v1::RelayRequest Agent::SayGoodbye(std::int64_t expected_back_ms) {
  parked_until_ms_ = expected_back_ms;
  v1::RelayRequest frame;
  frame.mutable_goodbye()->set_expected_back_unix_ms(expected_back_ms);
  return frame;
}

void Agent::OnEndedOk() {
  if (!model_.all_settled()) {
    shared_.CountBrokenRule("a stream ended OK while messages of it were unsettled");
  }
  ended_ok_ = true;
}

bool Agent::may_close() const {
  return shared_.stage.load(std::memory_order_acquire) == Stage::kClose && model_.may_send() &&
         model_.all_settled();
}

RobotOutcome Agent::TakeOutcome(const std::string& ruri) {
  RobotOutcome outcome;
  outcome.ruri = ruri;
  outcome.session_hex = model_.session().ToHex();
  outcome.mark = mark_;
  outcome.silences = silences_;
  outcome.account = std::move(account_);
  outcome.last_seq = model_.last_seq();
  outcome.sent = model_.sent();
  outcome.resent = model_.resent();
  outcome.judged = model_.judged_seq();
  outcome.notices = model_.notices();
  outcome.all_settled = model_.all_settled();
  outcome.ended_ok = ended_ok_;
  outcome.parked_until_ms = parked_until_ms_;
  if (table_) {
    outcome.receives = true;
    outcome.forwarded_changes = table_->changes();
    outcome.forwarded_snapshots = table_->snapshots();
    outcome.forward_violations = table_->violations();
    outcome.first_forward_violation = table_->first_violation();
  }
  return outcome;
}

}  // namespace uplink::synthetic
