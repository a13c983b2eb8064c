// The end of a run: faults stop, and everything must settle.
#include <algorithm>

#include <fmt/format.h>

#include "server/journal/turns.h"
#include "tests/simulation/world.h"

namespace uplink::simulation {
namespace {

/// Rounds after which a run that has not settled never will: each round does everything that can be
/// done once.
constexpr int kRoundsMax = 2000;

}  // namespace

void World::Heal() {
  away_ = false;
  recorder_.SetAway(false);
  server_->rejects().SetAway(false);
  recorder_.FailNext(StoreFault::kNone);
  if (server_->draining || replaced_) Kill();
  for (const auto& robot : robots_) {
    SimStream* stream = robot->stream ? server_->Find(*robot->stream) : nullptr;
    if (stream == nullptr || !stream->loses_answers()) continue;
    stream->Break();
    robot->agent.Disconnected();
    robot->stream.reset();
  }
  items_->SetAway(false);
  // All may be read anew while the rest is committed.
  if (random_.Percent(50)) items_->TrimNext();
  for (int round = 0; round < kRoundsMax && result_.violation.empty(); ++round) {
    if (Settled()) return;
    HealRound();
    Reap();
    Check();
  }
  if (result_.violation.empty()) {
    recorder_.Violate("faults have stopped and not everything settles");
  }
}

void World::HealRound() {
  for (const auto& robot : robots_) {
    if (!robot->stream) Connect(*robot);
    SimStream* stream = server_->Find(*robot->stream);
    if (stream != nullptr && robot->agent.Ready() && !stream->half_closed() &&
        robot->agent.HasResends()) {
      stream->Send(robot->agent.Batch(random_, 6, SimAgent::Fresh::kNo));
    }
  }
  // Sometimes all is committed and acked before what was sent again arrives.
  if (random_.Percent(30)) {
    while (server_->journal().turns().Advance() == journal::Step::kWorked) {
    }
    while (server_->HasWakes()) server_->DeliverWake(0);
  }
  for (auto& [id, stream] : server_->streams()) {
    if (stream->CanTellBroken()) stream->TellBroken();
    if (stream->CanDeliver()) stream->DeliverToServer();
    if (stream->CanHalfClose()) stream->DeliverHalfClose(clock_.Steady());
    if (stream->Writing()) stream->CompleteWrite();
    Robot* owner = OwnerOf(id);
    while (owner != nullptr && owner->stream == id && stream->CanReceive()) {
      Receive(*owner, stream->Receive());
    }
  }
  server_->journal().turns().Advance();
  server_->rejects().ReadOne();
  while (server_->HasWakes()) server_->DeliverWake(0);
  clock_.Advance(milliseconds(50));
  server_->FireTimers();
  all_read_ = server_->forwards()->Round().ok();
}

bool World::Settled() {
  if (!server_->journal().idle() || server_->HasWakes()) return false;
  if (!ForwardsSettled()) return false;
  return std::ranges::all_of(robots_, [this](const auto& robot) {
    if (robot->agent.HasKept() || robot->agent.HasLimited() || !robot->stream) return false;
    SimStream* stream = server_->Find(*robot->stream);
    // Each frame that was taken, Hello among them, is answered by an Ack in the end.
    return stream != nullptr && robot->agent.Ready() && !stream->CanDeliver() &&
           robot->batches_acked == stream->batches_seen();
  });
}

void World::CheckEnd() {
  const metrics::MessageCounts counts = server_->counts().messages;
  if (counts.in_flight != 0) {
    recorder_.Violate(fmt::format("all is settled and {} are in flight", counts.in_flight));
  }
  for (const auto& robot : robots_) {
    for (const AgentSession& session : robot->agent.sessions()) {
      const DurableSession& durable = recorder_.Of(robot->agent.ruri(), session.id);
      for (const model::Seq seq : session.durable_sent) {
        if (durable.Holds(seq)) continue;
        recorder_.Violate(
            fmt::format("number {} of {} never became durable", seq, robot->agent.ruri()));
      }
    }
  }
  CheckPresence();
  CheckTables();
  if (const auto difference = backend_.Compare(recorder_)) recorder_.Violate(*difference);
}

bool World::ForwardsSettled() {
  if (!all_read_ || server_->forwards()->sum().waiting != 0) return false;
  return std::ranges::all_of(robots_, [this](const auto& robot) {
    SimStream* stream = robot->stream ? server_->Find(*robot->stream) : nullptr;
    if (stream == nullptr || stream->Writing() || stream->CanReceive()) return false;
    return robot->agent.declines_forwards() || robot->agent.table().complete();
  });
}

void World::CheckTables() {
  for (const auto& robot : robots_) {
    if (robot->agent.declines_forwards()) continue;
    const ForwardTable& table = robot->agent.table();
    const SharedBook::Table due = recorder_.shared().PresentFor(table.self(), clock_.System());
    if (table.held() == due) continue;
    for (const auto& [key, what] : due) {
      const auto held = table.held().find(key);
      if (held != table.held().end() && held->second == what) continue;
      recorder_.Violate(fmt::format("{} holds {} of {}", robot->agent.ruri(),
                                    held == table.held().end() ? "nothing" : "something else",
                                    ToText(key)));
    }
    recorder_.Violate(fmt::format("{} holds {} items, {} are there", robot->agent.ruri(),
                                  table.held().size(), due.size()));
  }
}

void World::CheckPresence() {
  for (const fleet::RobotPtr& robot : server_->fleet().Sorted()) {
    const auto stored = recorder_.presence().find(robot->ruri());
    const model::Presence last =
        stored == recorder_.presence().end() ? model::Presence::kUnknown : stored->second;
    if (last == robot->state.presence()) continue;
    recorder_.Violate(fmt::format("{} is {}, and its last change says {}", robot->ruri(),
                                  ToText(robot->state.presence()), ToText(last)));
  }
}

}  // namespace uplink::simulation
