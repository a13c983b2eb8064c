#include "tests/simulation/world.h"

#include <algorithm>

#include <fmt/format.h>

#include "server/journal/turns.h"
#include "tests/simulation/traced_rows.h"

namespace uplink::simulation {

World::World(const Payloads& payloads, Backend& backend, const RunOptions& options)
    : payloads_(payloads),
      backend_(backend),
      options_(options),
      random_(options.seed),
      recorder_([this](const std::string& text) {
        if (result_.violation.empty()) {
          result_.violation =
              fmt::format("seed {} step {}: {}", options_.seed, result_.steps, text);
        }
      }) {
  // Small limits, so that every bound is met often.
  limits_.session.in_flight_uplinks_max = static_cast<std::uint32_t>(3 + random_.Below(12));
  limits_.session.batch_uplinks_max = 6;
  limits_.session.drain_timeout = milliseconds(random_.Percent(50) ? 1'000 : 20'000);
  limits_.session.reconnects = {
      .per_minute = random_.Percent(30) ? 2 : static_cast<std::uint32_t>(robot::kStreamTimesMax),
      .delay_max = milliseconds(400)};
  if (random_.Percent(60)) limits_.session.open_rejects_max = 1;
  limits_.session.reject_page_max = 1 + random_.Below(2);
  limits_.journal.bytes_max = random_.Percent(30) ? 4'000 : 1'000'000;
  limits_.journal.batch_records_max = 1 + random_.Below(8);
  limits_.presence = {.timeout = milliseconds(400), .startup_grace = milliseconds(2'000)};
  limits_.journal.robot_share = 1;
  receiver_limits_ = {.waiting_max = 1 + random_.Below(6), .taken_max = 1 + random_.Below(3)};
  greedy_ = random_.Percent(20);
  if (greedy_) AddGreed();
  limited_ = options_.troubles.rates && !greedy_ && random_.Percent(30);
  if (limited_) AddRates();
  goes_back_ = options_.troubles.failovers && backend_.CanGoBack() && random_.Percent(20);
  AddRobots();
  if (options_.trace != nullptr) traced_.emplace(recorder_, *options_.trace);
  StartServer();
}

void World::AddRobots() {
  const std::size_t robots = greedy_ ? 5 : 1 + random_.Below(4);
  for (std::size_t i = 0; i < robots; ++i) {
    // Two fleets, and in both who sends and who receives.
    const std::string fleet = i % 4 < 2 ? "sim" : "other";
    SimAgent::Self self{{.ruri = fmt::format("rcan://{}/{}", fleet, i), .fleet = fleet},
                        // What was shared and is lost receivers keep until it changes.
                        goes_back_ || random_.Percent(15)};
    robots_.push_back(std::make_unique<Robot>(
        SimAgent(std::move(self), payloads_, recorder_, [this](const std::string& text) {
          if (result_.violation.empty()) {
            result_.violation =
                fmt::format("seed {} step {}: robot says: {}", options_.seed, result_.steps, text);
          }
        })));
  }
  if (greedy_) robots_.front()->agent.BeGreedy();
  for (const auto& robot : robots_) {
    if (limited_) robot->agent.BeLimited();
  }
}

void World::AddRates() {
  for (const model::Variant variant : {model::Variant::kShape, model::Variant::kObject}) {
    limits_.allowance.rates[static_cast<std::size_t>(variant)] = {.rate = 2, .burst = 2};
  }
  limits_.allowance.telemetry = {.rate = 2, .burst = 2};
}

void World::AddGreed() {
  limits_.journal.bytes_max = 64'000;
  limits_.journal.robot_share = 8;
  limits_.allowance.flow = {.records = {.rate = 5, .burst = 4}, .bytes = {}};
}

void World::StartServer() {
  storage::ProcessId process{};
  for (std::uint8_t& byte : process) byte = static_cast<std::uint8_t>(random_.Next());
  recorder_.SetStore(&backend_.Reopen(process));
  recorder_.shared().BeginLife();
  items_ = std::make_unique<SimItems>(
      backend_.Items(), [this] { BetweenReads(); }, options_.forward_fault);
  items_->SetAway(away_);
  const Ground ground{.clock = clock_,
                      .rows = &backend_.Rows(),
                      .store = traced_ ? static_cast<storage::Store&>(*traced_) : recorder_,
                      .trace = options_.trace,
                      .forwards = {.items = items_.get(),
                                   .receivers = receiver_limits_,
                                   .seed = random_.Next(),
                                   .fault = options_.forward_fault}};
  server_ = std::make_unique<SimServer>(ground, limits_, process);
  server_->rejects().SetAway(away_);
  offline_.clear();
  for (const auto& [ruri, last] : recorder_.presence()) {
    if (options_.troubles.restarts && last == model::Presence::kOffline) offline_.insert(ruri);
  }
}

RunResult World::Run() {
  while (result_.steps < options_.steps && result_.violation.empty()) {
    ++result_.steps;
    Step();
    Reap();
    Check();
  }
  if (result_.violation.empty()) Heal();
  if (result_.violation.empty()) CheckEnd();
  if (result_.violation.empty()) CheckSlowFrame();
  AddCounts();
  TraceEnd();
  return result_;
}

void World::AddCounts() {
  result_.uplinks += server_->counts().messages;
  result_.forwards += server_->forwards()->sum().counts;
}

void World::TraceEnd() {
  if (options_.trace == nullptr) return;
  TraceRows(backend_.Rows(), *options_.trace);
  options_.trace->Add(ToText(result_));
}

World::Robot* World::OwnerOf(std::uint64_t stream) {
  for (const auto& robot : robots_) {
    if (robot->stream == stream) return robot.get();
  }
  return nullptr;
}

void World::Step() {
  const std::size_t pick = random_.Below(100);
  if (pick < 46 && !server_->streams().empty()) {
    auto& streams = server_->streams();
    const auto at =
        std::next(streams.begin(), static_cast<std::ptrdiff_t>(random_.Below(streams.size())));
    return NetworkStep(*at->second, OwnerOf(at->first));
  }
  if (pick < 58) return AgentStep(*robots_[random_.Below(robots_.size())]);
  if (pick < 70) {
    server_->journal().turns().Advance();
    return;
  }
  if (pick < 73) {
    server_->rejects().ReadOne();
    return;
  }
  if (pick < 77) {
    static_cast<void>(server_->forwards()->Round());
    return;
  }
  if (pick < 94) {
    if (server_->HasWakes()) server_->DeliverWake(static_cast<std::size_t>(random_.Next() >> 1U));
    return;
  }
  if (pick < 97) {
    clock_.Advance(milliseconds(random_.Percent(20) ? 1500 : 20 + random_.Below(300)));
    static_cast<void>(server_->fleet().Sweep(std::chrono::hours(1)));
    return server_->FireTimers();
  }
  FaultStep();
}

void World::BetweenReads() {
  const std::size_t pick = random_.Below(100);
  if (pick < 40) {
    server_->journal().turns().Advance();
  } else if (pick < 50) {
    if (server_->HasWakes()) server_->DeliverWake(static_cast<std::size_t>(random_.Next() >> 1U));
  } else if (pick < 65 && !server_->streams().empty()) {
    auto& streams = server_->streams();
    const auto at =
        std::next(streams.begin(), static_cast<std::ptrdiff_t>(random_.Below(streams.size())));
    NetworkStep(*at->second, OwnerOf(at->first));
  }
}

void World::NetworkStep(SimStream& stream, Robot* owner) {
  switch (random_.Below(3)) {
    case 0:
      if (stream.CanDeliver()) return stream.DeliverToServer();
      if (stream.CanHalfClose()) return stream.DeliverHalfClose(clock_.Steady());
      if (stream.CanTellBroken() && random_.Percent(30)) stream.TellBroken();
      return;
    case 1:
      if (stream.Writing() && !stream.broken()) stream.CompleteWrite();
      return;
    default:
      if (owner != nullptr && stream.CanReceive()) Receive(*owner, stream.Receive());
  }
}

void World::Receive(Robot& robot, const ToAgent& received) {
  if (received.end) {
    robot.agent.Disconnected();
    robot.stream.reset();
    return;
  }
  robot.agent.OnFrame(received.frame);
  if (received.frame.has_ack()) robot.batches_acked = received.batches_seen;
}

void World::AgentStep(Robot& robot) {
  SimStream* stream = robot.stream ? server_->Find(*robot.stream) : nullptr;
  if (stream == nullptr) {
    if (random_.Percent(40)) Connect(robot);
    return;
  }
  if (!robot.agent.Ready() || stream->half_closed()) return;
  const std::size_t pick = random_.Below(100);
  if (pick < 5 && !robot.agent.HasResends()) return stream->HalfClose();
  if (pick < 7 && robot.agent.SessionsWithKept() < 3) return robot.agent.NewSession(random_);
  // An agent that restarts does not wait for its old stream: the server sees a takeover.
  if (pick < 9) return Connect(robot);
  const v1::RelayRequest batch =
      robot.agent.Batch(random_, 1 + random_.Below(6), SimAgent::Fresh::kYes);
  stream->Send(batch);
}

void World::Connect(Robot& robot) {
  if (SimStream* old = robot.stream ? server_->Find(*robot.stream) : nullptr) old->Break();
  robot.agent.Disconnected();
  robot.stream.reset();
  if (server_->draining) return;
  robot.stream = server_->Open(robot.agent.id());
  robot.batches_acked = 0;
  server_->Find(*robot.stream)->Send(robot.agent.Connect(random_));
}

void World::FaultStep() {
  if (random_.Percent(goes_back_ ? 40 : 6)) return StoreTrouble();
  const std::size_t pick = random_.Below(100);
  if (pick < 40) {
    Robot& robot = *robots_[random_.Below(robots_.size())];
    if (SimStream* stream = robot.stream ? server_->Find(*robot.stream) : nullptr) {
      if (pick < 10) return stream->LoseAnswers();
      if (pick < 14 && limited_ && robot.agent.Ready()) return Flood(robot);
      ++result_.breaks;
      stream->Break();
      robot.agent.Disconnected();
      robot.stream.reset();
    }
    return;
  }
  if (pick < 45) return DeleteRow(robots_[random_.Below(robots_.size())]->agent.ruri());
  if (pick < 50) return items_->FailAfter(random_.Below(4));
  if (pick < 55) return items_->TrimNext();
  if (pick < 60) return items_->SetAway(random_.Percent(50));
  if (pick < 75) {
    return recorder_.FailNext(random_.Percent(50) ? StoreFault::kBefore : StoreFault::kAfter);
  }
  if (pick < 90) {
    away_ = pick < 80 && !away_;
    server_->rejects().SetAway(away_);
    items_->SetAway(away_);
    return recorder_.SetAway(away_);
  }
  if (pick < 93) {
    server_->draining = true;
    for (auto& [id, stream] : server_->streams()) {
      stream->session().OnDrain(milliseconds(1000));
    }
    return;
  }
  if (pick > 97 && !replaced_ && backend_.ReplaceFiles()) {
    ++result_.replacements;
    replaced_ = true;
    return;
  }
  Kill();
}

void World::DeleteRow(const std::string& ruri) {
  if (!recorder_.OnRowDeleted(ruri)) return;
  if (random_.Percent(50)) {
    backend_.RemoveRobot(ruri);
    recorder_.shared().NoteRemoval(ruri);
  } else {
    backend_.DeleteRobotRow(ruri);
  }
  ++deletions_[ruri];
  ++result_.deletions;
}

void World::Kill() {
  ++result_.kills;
  AddCounts();
  server_.reset();
  deletions_.clear();
  went_back_ = replaced_ = false;
  for (const auto& robot : robots_) {
    robot->agent.Disconnected();
    robot->stream.reset();
  }
  StartServer();
  // The set may be read over a connection of its own that fails alone.
  if (random_.Percent(30)) items_->SetAway(true);
}

void World::Reap() {
  CheckEnds();
  auto& streams = server_->streams();
  std::vector<std::uint64_t> over;
  for (auto& [id, stream] : streams) {
    const bool gone = stream->session().done() && (stream->broken() || OwnerOf(id) == nullptr);
    if (gone || stream->Over()) over.push_back(id);
  }
  for (const std::uint64_t id : over) {
    if (Robot* robot = OwnerOf(id)) {
      robot->agent.Disconnected();
      robot->stream.reset();
    }
    server_->Forget(id);
  }
}

}  // namespace uplink::simulation
