// What must hold after every step.
#include <algorithm>

#include <fmt/format.h>

#include "server/session/slow_frame.h"
#include "tests/simulation/world.h"

namespace uplink::simulation {
namespace {

/// Between two sweeps.
constexpr milliseconds kSecond{1'000};

}  // namespace

void World::Check() {
  CheckLaw();
  CheckForwardLaw();
  CheckRestored();
  for (const auto& robot : robots_) {
    const fleet::RobotPtr known = server_->fleet().Find(robot->agent.ruri());
    if (known != nullptr && known->state.held_back()) ++result_.held_back;
    if (known != nullptr && greedy_) CheckShare(robot->agent.ruri(), known->sessions);
    if (known != nullptr &&
        known->sessions.in_flight() > limits_.session.in_flight_uplinks_max + 1) {
      recorder_.Violate(fmt::format("{} messages of {} are in flight, the limit is {}",
                                    known->sessions.in_flight(), robot->agent.ruri(),
                                    limits_.session.in_flight_uplinks_max));
    }
  }
}

void World::CheckShare(const std::string& ruri, const robot::RobotSessions& sessions) {
  const robot::JournalUse use = sessions.journal_use();
  const std::size_t share = limits_.journal.bytes_max / limits_.journal.robot_share;
  if (use.records > 1 && use.bytes > share) {
    recorder_.Violate(fmt::format("{} has {} bytes of {} records in the journal, its share is {}",
                                  ruri, use.bytes, use.records, share));
  }
  switch (sessions.View().held_back) {
    case robot::HeldBack::kJournal:
      // Five shares of eight cannot fill it.
      return recorder_.Violate(fmt::format("{} is held back for others", ruri));
    case robot::HeldBack::kJournalShare:
      ++result_.held_back_by_share;
      return;
    case robot::HeldBack::kFlow:
      ++result_.held_back_by_flow;
      return;
    default:
      return;
  }
}

void World::CheckRestored() {
  std::erase_if(offline_, [this](const std::string& ruri) { return server_->NewestOf(ruri) != 0; });
  for (const std::string& ruri : offline_) {
    const fleet::RobotPtr robot = server_->fleet().Find(ruri);
    if (robot == nullptr || robot->state.presence() == model::Presence::kOffline) continue;
    recorder_.Violate(fmt::format("{} was offline, and is {} after a restart", ruri,
                                  ToText(robot->state.presence())));
  }
}

void World::CheckSlowFrame() {
  const auto robot = std::ranges::find_if(robots_, [this](const auto& each) {
    const SimStream* stream = each->stream ? server_->Find(*each->stream) : nullptr;
    return stream != nullptr && !stream->half_closed();
  });
  if (robot == robots_.end()) return;
  SimStream& stream = *server_->Find(*(*robot)->stream);
  const robot::RobotState& state = server_->fleet().Find(stream.ruri())->state;
  const auto online_after = [&](milliseconds time) {
    for (; time > milliseconds(0); time -= std::min(time, kSecond)) {
      clock_.Advance(std::min(time, kSecond));
      static_cast<void>(server_->fleet().Sweep(std::chrono::hours(1)));
    }
    stream.session().OnFrameBytes();
    return state.presence() == model::Presence::kOnline;
  };
  if (!online_after(milliseconds(0)) || !online_after(session::kSlowFrameMax)) {
    recorder_.Violate(fmt::format("bytes of a frame do not keep {} online", stream.ruri()));
  }
  if (online_after(limits_.presence.timeout + milliseconds(1))) {
    recorder_.Violate(
        fmt::format("bytes of a frame keep {} online for over a minute", stream.ruri()));
  }
}

void World::CheckLaw() {
  const metrics::MessageCounts counts = server_->counts().messages;
  if (!counts.Balanced()) {
    recorder_.Violate(fmt::format(
        "the conservation law is broken: received {} stored {} applied {} superseded {} duplicate "
        "{} rejected {} in flight {}",
        counts.received, counts.stored, counts.applied, counts.superseded, counts.duplicate,
        counts.rejected, counts.in_flight));
  }
}

void World::CheckForwardLaw() {
  const forward::Forwards::Sum sum = server_->forwards()->sum();
  const forward::Counts& counts = sum.counts;
  if (counts.due ==
      counts.written + counts.coalesced + counts.replaced + counts.dropped + sum.waiting) {
    return;
  }
  recorder_.Violate(fmt::format(
      "the conservation law of forwards is broken: due {} written {} coalesced {} replaced {} "
      "dropped {} waiting {}",
      counts.due, counts.written, counts.coalesced, counts.replaced, counts.dropped, sum.waiting));
}

}  // namespace uplink::simulation
