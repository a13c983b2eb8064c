#include "tests/simulation/sim_server.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "schema/base/check.h"
#include "server/store/robot_loader.h"

namespace uplink::simulation {
namespace {

/// More robots than a simulated world has.
constexpr std::size_t kRobotsMax = 100;

}  // namespace

SimStream::SimStream(const session::SessionContext& context, identity::PeerIdentity peer,
                     loop::StreamRef self, Trace* trace)
    : ruri_(peer.ruri),
      id_(self.stream),
      trace_(trace),
      opened_at_(context.clock.Steady()),
      session_(context, {std::move(peer)}, self, *this, *this) {}

void SimStream::AddToTrace(std::string_view what, const std::string& text) {
  if (trace_ != nullptr) trace_->Add(fmt::format("stream {} {} {}", id_, what, text));
}

void SimStream::Write(const v1::RelayResponse& frame) {
  AddToTrace("frame", frame.ShortDebugString());
  writing_.push_back({.frame = frame, .batches_seen = batches_seen_});
}

void SimStream::WriteEncoded(std::span<const session::EncodedFrame> frames) {
  for (const session::EncodedFrame& bytes : frames) {
    v1::RelayResponse frame;
    UPLINK_CHECK(frame.ParseFromString(*bytes), "an encoded frame is one");
    Write(frame);
  }
}

void SimStream::Finish(const absl::Status& status) {
  AddToTrace("end", status.ToString());
  end_ = status;
  if (Writing()) {
    queued_end_ = status.code();
  } else {
    if (!loses_answers_) to_agent_.push_back({.end = status.code()});
  }
}

void SimStream::DeliverToServer() {
  const std::string bytes = std::move(to_server_.front());
  to_server_.pop_front();
  read_wanted_ = false;
  if (session_.done()) return;
  ++batches_seen_;
  session_.OnFrame(bytes);
}

void SimStream::DeliverHalfClose(SteadyTime now) {
  read_wanted_ = false;
  half_closed_at_ = now;
  if (!session_.done()) session_.OnHalfClose();
}

void SimStream::CompleteWrite() {
  if (!std::exchange(arrived_, false)) std::ranges::move(writing_, std::back_inserter(to_agent_));
  writing_.clear();
  if (queued_end_) to_agent_.push_back({.end = std::exchange(queued_end_, std::nullopt)});
  if (loses_answers_) to_agent_.clear();
  if (!session_.done()) session_.OnWritten();
}

ToAgent SimStream::Receive() {
  ToAgent received = std::move(to_agent_.front());
  to_agent_.pop_front();
  return received;
}

std::vector<ToAgent> SimStream::TakeInFlight() {
  std::vector<ToAgent> taken(std::make_move_iterator(to_agent_.begin()),
                             std::make_move_iterator(to_agent_.end()));
  to_agent_.clear();
  if (broken_ || loses_answers_ || writing_.empty() || arrived_) return taken;
  taken.insert(taken.end(), writing_.begin(), writing_.end());
  arrived_ = true;
  return taken;
}

void SimStream::LoseAnswers() {
  loses_answers_ = true;
  to_agent_.clear();
}

void SimStream::Break() {
  broken_ = true;
  to_server_.clear();
  to_agent_.clear();
}

void SimStream::TellBroken() {
  told_broken_ = true;
  writing_.clear();
  session_.OnBroken();
}

void SimStream::Send(const v1::RelayRequest& frame) {
  to_server_.push_back(frame.SerializeAsString());
}

SimServer::SimServer(const Ground& ground, const ServerLimits& limits,
                     const storage::ProcessId& process)
    : clock_(ground.clock),
      trace_(ground.trace),
      limits_(limits),
      fleet_(clock_, kRobotsMax, limits_.presence),
      journal_(ground.store, limits_.journal, clock_, book_.NewPage(), journal_probe_, process),
      judge_({}),
      rejects_(ground.rows, testing::FakeRejectSource::Reads::kWhenTold),
      ledger_(book_.NewPage()) {
  if (ground.forwards.items != nullptr) forwards_.emplace(clock_, ground.forwards);
  fleet_.OnPresence(
      [this](const storage::RobotRef& robot, const storage::StoredPresence& now, auto why) {
        journal_.NotePresence(robot, now.presence, now.since, why, now.parked_until);
      });
  if (ground.rows == nullptr) return;
  // The life before has ended: its robots are this one's.
  store::RobotLoader loader({fleet_, shards_, *ground.rows, limits_.presence.startup_grace});
  UPLINK_CHECK(loader.Run(kRobotsMax).ok(), "the simulated store can be read");
}

std::uint64_t SimServer::Open(const model::RobotId& robot) {
  const std::uint64_t id = next_stream_++;
  const session::SessionContext context{.clock = clock_,
                                        .fleet = fleet_,
                                        .journals = shards_,
                                        .probe = probe_,
                                        .ledger = ledger_,
                                        .judge = judge_,
                                        .limits = limits_.session,
                                        .scratch = scratch_,
                                        .allowances = allowances_,
                                        .rejects = rejects_,
                                        .clock_trust = clock_trust_,
                                        .forwards = forwards()};
  identity::PeerIdentity peer{
      .role = identity::Role::kRobot, .fleet = robot.fleet, .ruri = robot.ruri};
  auto stream = std::make_unique<SimStream>(context, std::move(peer),
                                            loop::StreamRef{.inbox = this, .stream = id}, trace_);
  stream->session().Start();
  streams_.emplace(id, std::move(stream));
  newest_[robot.ruri] = id;
  return id;
}

SimStream* SimServer::Find(std::uint64_t stream) {
  const auto found = streams_.find(stream);
  return found == streams_.end() ? nullptr : found->second.get();
}

std::uint64_t SimServer::NewestOf(const std::string& ruri) const {
  const auto found = newest_.find(ruri);
  return found == newest_.end() ? 0 : found->second;
}

void SimServer::DeliverWake(std::size_t pick) {
  const auto at = std::next(wakes_.begin(), static_cast<std::ptrdiff_t>(pick % wakes_.size()));
  const std::uint64_t id = *at;
  wakes_.erase(at);
  if (SimStream* stream = Find(id); stream != nullptr && !stream->session().done()) {
    stream->session().OnWake();
  }
}

void SimServer::FireTimers() {
  for (auto& [id, stream] : streams_) {
    const auto deadline = stream->session().deadline();
    if (deadline && *deadline <= clock_.Steady()) stream->session().OnTimer();
  }
}

}  // namespace uplink::simulation
