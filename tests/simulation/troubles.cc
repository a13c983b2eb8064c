// What goes wrong with the store, and answers that are lost.
#include "server/journal/turns.h"
#include "tests/simulation/world.h"

namespace uplink::simulation {
namespace {

/// Frames of a flood, of `batch_uplinks_max` items each: more than a session's memory of Rejects.
constexpr int kFloodFrames = 60;
/// The robot is held back for its Rejects meanwhile.
constexpr milliseconds kFloodTick{10};

}  // namespace

void World::StoreTrouble() {
  const std::size_t pick = random_.Below(100);
  if (!goes_back_ || pick < 10) {
    if (!options_.troubles.retention) return;
    // Every row in quarantine is too old by then.
    if (recorder_.Retain(clock_.System() + 2 * kQuarantineKept).ok()) backend_.AfterRetain();
    return;
  }
  if (pick < 50) {
    backend_.KeepCopy();
    return recorder_.KeepCopy();
  }
  GoBack();
}

void World::GoBack() {
  if (!backend_.GoBack()) return;
  ++result_.failovers;
  went_back_ = true;
  recorder_.GoBack([this] {
    for (const auto& robot : robots_) {
      SimStream* stream = robot->stream ? server_->Find(*robot->stream) : nullptr;
      if (stream == nullptr) continue;
      for (const ToAgent& received : stream->TakeInFlight()) Receive(*robot, received);
    }
    for (const auto& robot : robots_) robot->agent.OnStoreWentBack();
  });
  // The process goes on with what it judges; of a robot that it does not hold it knows what the
  // store says.
  std::erase_if(offline_, [this](const std::string& ruri) {
    const auto last = recorder_.presence().find(ruri);
    if (last != recorder_.presence().end() && last->second == model::Presence::kOffline)
      return false;
    const fleet::RobotPtr robot = server_->fleet().Find(ruri);
    return robot == nullptr || robot->state.held_since() == 0 ||
           robot->state.held_since() != recorder_.HeldSince(ruri);
  });
}

void World::Flood(Robot& robot) {
  const std::uint64_t id = *robot.stream;
  SimStream& stream = *server_->Find(id);
  ++result_.floods;
  stream.LoseAnswers();
  robot.agent.FloodWithItems(true);
  for (int frame = 0; frame < kFloodFrames; ++frame) {
    stream.Send(
        robot.agent.Batch(random_, limits_.session.batch_uplinks_max, SimAgent::Fresh::kYes));
  }
  robot.agent.FloodWithItems(false);
  for (int turn = 0; turn < 4 * kFloodFrames && !stream.session().done(); ++turn) {
    if (stream.CanDeliver()) stream.DeliverToServer();
    server_->journal().turns().Advance();
    while (server_->HasWakes()) server_->DeliverWake(0);
    if (stream.Writing()) stream.CompleteWrite();
    clock_.Advance(kFloodTick);
    server_->FireTimers();
  }
}

}  // namespace uplink::simulation
