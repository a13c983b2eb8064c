#include "tools/uplink-fleet/run/twin_run.h"

#include <chrono>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "server/view/timestamps.h"
#include "tools/uplink-fleet/compare/compare_twin_live.h"
#include "tools/uplink-fleet/report/json_report.h"
#include "tools/uplink-fleet/report/text_report.h"
#include "tools/uplink-fleet/run/measurement.h"

namespace uplink::synthetic {
namespace {

/// Without any connection for that long at the start, nothing can be run.
constexpr milliseconds kFirstConnectionDeadline{15'000};
/// For the server to take what is on its way from the broker, and to show it.
constexpr milliseconds kQuietDeadline{15'000};
/// Between two scrapes.
constexpr milliseconds kScrapeEvery{1'000};

/// True if nothing of the twin's live state differs.
bool Agrees(const TwinScript& twin, const TwinLook& look) {
  Findings findings;
  CompareTwinLive(twin, look, findings);
  return findings.differences_in_all() == 0;
}

}  // namespace

TwinRun::TwinRun(const RunOptions& options)
    : options_(options),
      view_(options_.http, clock_),
      context_{.clock = clock_, .signals = signals_, .shared = shared_},
      display_(options_.errors) {
  figures_.seed = options_.seed;
  figures_.run = RandomRun();
}

absl::Status TwinRun::Begin() {
  const absl::StatusOr<v1::ServerStatus> status = view_.Status();
  if (!status.ok()) return status.status();
  started_at_ms_ = view::UnixMs(status->started_at());
  span_.from_ms = view::UnixMs(status->now());
  const absl::StatusOr<std::string> page = view_.Metrics();
  if (!page.ok()) return page.status();
  evidence_.before = BrokerMessagesOn(*page);
  return absl::OkStatus();
}

int TwinRun::Main() {
  if (absl::Status status = Begin(); !status.ok()) return CannotRun(status);
  TwinSwarmOptions swarm_options = *options_.twins;
  swarm_options.seed = options_.seed;
  swarm_options.run = figures_.run;
  TwinSwarm swarm(swarm_options, clock_, shared_);
  Measurement measurement(options_.http.address, clock_);
  measurement.Begin();
  swarm.Start();
  if (absl::Status status = Send(swarm); !status.ok()) {
    display_.Clear();
    return CannotRun(status);
  }
  figures_.seconds = measurement.SinceBegin().seconds;
  shared_.stage.store(TwinStage::kSettle);
  bool quiet = WaitFor(shared_.settled_groups, swarm.groups());
  if (quiet) {
    shared_.stage.store(TwinStage::kLast);
    quiet = WaitFor(shared_.quiet_groups, swarm.groups());
  }
  if (!quiet) {
    // Its threads may touch what is compared: they end first.
    shared_.abandon.store(true);
    swarm.Finish();
  }
  AwaitServer();
  const Measured measured = measurement.SinceBegin();
  figures_.server = measured.server;
  figures_.own = measured.own;
  const absl::Status gathered = Gather(swarm);
  shared_.stage.store(TwinStage::kClose);
  swarm.Finish();
  display_.Clear();
  if (!gathered.ok()) return CannotRun(gathered);
  return Conclude(swarm);
}

std::string TwinRun::Heading() const {
  const auto seconds =
      std::chrono::duration_cast<std::chrono::seconds>(clock_.Steady() - began_).count();
  return shared_.stage.load() == TwinStage::kSend
             ? SendingHeading("twins", seconds, options_.run_for)
             : SettlingHeading(seconds);
}

void TwinRun::Look() {
  if (!display_.Due(clock_.Steady())) return;
  const absl::StatusOr<std::string> page = view_.Metrics();
  std::optional<Conservation> counts;
  // A server that does not answer counts nothing either.
  if (page.ok()) {
    counts = BrokerMessagesOn(*page);
    evidence_.watch.See(counts);
  } else {
    shared_.first_error.Keep(std::string(page.status().message()));
  }
  const std::uint64_t received = counts ? counts->received : 0;
  const std::uint64_t in_flight = counts ? counts->in_flight : 0;
  display_.Show(
      fmt::format("{} published, {} of {} acked, {} pongs; server: {} received, {} in flight",
                  shared_.published.load(), shared_.acked.load(), shared_.published_qos1.load(),
                  shared_.pongs.load(), received, in_flight),
      {Heading(),
       {{"messages published", fmt::format("{}", shared_.published.load())},
        {"of them at QoS 1", fmt::format("{}", shared_.published_qos1.load())},
        {"acked by the broker", fmt::format("{}", shared_.acked.load())},
        {"pongs", fmt::format("{}", shared_.pongs.load())},
        {"messages received by the server", fmt::format("{}", received)},
        {"messages in flight", fmt::format("{}", in_flight)}}});
}

absl::Status TwinRun::Send(const TwinSwarm& swarm) {
  const SteadyTime start = began_ = clock_.Steady();
  while (clock_.Steady() - start < options_.run_for) {
    Look();
    if (signals_.Wait(kLook)) break;
    const bool late = clock_.Steady() - start > kFirstConnectionDeadline;
    if (shared_.connections.load() == 0 && late) break;
  }
  if (shared_.connections.load() > 0) return absl::OkStatus();
  return absl::UnavailableError(fmt::format("none of {} connections was let in: {}", swarm.groups(),
                                            shared_.first_error.Read()));
}

bool TwinRun::WaitFor(const std::atomic<std::size_t>& counted, std::size_t groups) {
  const SteadyTime start = clock_.Steady();
  while (counted.load() < groups) {
    if (clock_.Steady() - start > options_.settle_for) return false;
    Look();
    if (signals_.Wait(kLook)) return false;
  }
  return true;
}

void TwinRun::AwaitServer() {
  const SteadyTime start = clock_.Steady();
  std::uint64_t received = 0;
  while (clock_.Steady() - start < kQuietDeadline) {
    const absl::StatusOr<std::string> page = AskAgain(context_, [this] { return view_.Metrics(); });
    if (!page.ok()) return;
    const std::optional<Conservation> counts = BrokerMessagesOn(*page);
    evidence_.watch.See(counts);
    evidence_.after = counts;
    // Pings go on, so received may move by one or two.
    const bool still = counts && counts->received < received + 2 * kBrokerConnectionsMax + 1;
    if (still && counts->in_flight == 0 && received > 0) return;
    received = counts ? counts->received : 0;
    if (signals_.Wait(kScrapeEvery)) return;
  }
}

absl::StatusOr<TwinLook> TwinRun::LookAt(const TwinScript& twin) {
  TwinLook look;
  for (const Side side : {Side::kReal, Side::kSim}) {
    absl::StatusOr<std::string> text =
        AskAgain(context_, [&] { return view_.RobotText(twin.ids().RuriOf(side)); });
    if (!text.ok()) return text.status();
    look.at(static_cast<std::size_t>(side)) = *std::move(text);
  }
  return look;
}

absl::StatusOr<StoredTwin> TwinRun::StoredOf(const TwinScript& twin) {
  StoredTwin stored;
  for (const Side side : {Side::kReal, Side::kSim}) {
    absl::StatusOr<StoredRobot> robot =
        AskAgain(context_, [&] { return view_.Stored(twin.ids().RuriOf(side), span_.from_ms); });
    if (!robot.ok()) return robot.status();
    stored.robots.at(static_cast<std::size_t>(side)) = *std::move(robot);
  }
  const std::pair<const char*, std::string> scopes[] = {{"environment", twin.ids().environment},
                                                        {"workflow_run", twin.ids().workflow_run}};
  for (const auto& [scope, id] : scopes) {
    const auto updates = AskAgain(context_, [&, scope = scope, &id = id] {
      return view_.ScopeUpdates(scope, id, span_.from_ms);
    });
    if (!updates.ok()) return updates.status();
    stored.scopes.insert(stored.scopes.end(), updates->begin(), updates->end());
  }
  return stored;
}

absl::Status TwinRun::CompareTwin(const TwinScript& twin, const TwinLook& look,
                                  std::vector<v1::Quarantined>& no_robot) {
  CompareTwinLive(twin, look, evidence_.findings);
  const absl::StatusOr<StoredTwin> stored = StoredOf(twin);
  if (!stored.ok()) return stored.status();
  ++evidence_.twins_read;
  CompareTwinRows(twin, *stored, no_robot, evidence_.findings);
  CompareTwinPresence(twin, *stored, span_, evidence_.findings);
  return absl::OkStatus();
}

absl::Status TwinRun::Gather(const TwinSwarm& swarm) {
  // Live values first, while all twins are there; each until it agrees, or it is late.
  absl::Status status;
  const SteadyTime start = clock_.Steady();
  swarm.ForEach([&](const TwinScript& twin) {
    absl::StatusOr<TwinLook> look = LookAt(twin);
    while (look.ok() && !Agrees(twin, *look) && clock_.Steady() - start < kQuietDeadline &&
           !signals_.Wait(kLook)) {
      look = LookAt(twin);
    }
    if (!look.ok()) status.Update(look.status());
    looks_.push_back(look.ok() ? *std::move(look) : TwinLook());
  });
  if (!status.ok()) return status;
  const auto now = AskAgain(context_, [this] { return view_.Status(); });
  if (!now.ok()) return now.status();
  span_.to_ms = view::UnixMs(now->now());
  evidence_.restarted = view::UnixMs(now->started_at()) != started_at_ms_;
  auto no_robot = AskAgain(context_, [this] { return view_.QuarantineOfNoRobot(span_.from_ms); });
  if (!no_robot.ok()) return no_robot.status();
  std::size_t compared = 0;
  swarm.ForEach([&](const TwinScript& twin) {
    if (!status.ok()) return;
    if (signals_.Came()) {
      status = absl::CancelledError(
          fmt::format("told to stop after {} of {} twins were compared", compared, looks_.size()));
      return;
    }
    if (display_.Due(clock_.Steady())) {
      display_.Show(fmt::format("compared {} of {} twins", compared, looks_.size()));
    }
    status = CompareTwin(twin, looks_[compared++], *no_robot);
  });
  return status;
}

int TwinRun::Conclude(const TwinSwarm& swarm) {
  TwinTotals& totals = evidence_.totals;
  swarm.ForEach([&totals](const TwinScript& twin) { totals.Add(twin.account()); });
  totals.published = shared_.published.load();
  totals.published_qos1 = shared_.published_qos1.load();
  totals.pings = shared_.pings.load();
  totals.pongs = shared_.pongs.load();
  figures_.totals = totals;
  figures_.connections = shared_.connections.load();
  figures_.breaks = shared_.breaks.load();
  figures_.skipped = shared_.skipped.load();
  figures_.restarted = evidence_.restarted;
  figures_.pong = swarm.Pong();
  figures_.first_error = shared_.first_error.Read();
  const std::vector<CheckRow> rows = VerifyTwins(evidence_);
  return Concluded(options_.json
                       ? JsonReport(figures_, rows, evidence_.findings)
                       : TextReport(figures_, rows, evidence_.findings, Palette(options_.output)),
                   rows);
}

}  // namespace uplink::synthetic
