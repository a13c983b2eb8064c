#include "tools/uplink-fleet/run/drone_run.h"

#include <chrono>
#include <memory>
#include <utility>

#include <fmt/core.h>

#include "server/view/timestamps.h"
#include "tools/uplink-fleet/compare/compare_drones.h"
#include "tools/uplink-fleet/report/json_report.h"
#include "tools/uplink-fleet/report/text_report.h"
#include "tools/uplink-fleet/run/measurement.h"

namespace uplink::synthetic {
namespace {

/// Without any answer for that long at the start, nothing can be run.
constexpr milliseconds kFirstAnswerDeadline{15'000};
/// For the server to show what it has answered.
constexpr milliseconds kAgreeDeadline{5'000};

/// True if nothing of the drone's live state differs.
bool Agrees(const DroneScript& drone, const std::string& look) {
  Findings findings;
  CompareDroneLive(drone, look, findings);
  return findings.differences_in_all() == 0;
}

}  // namespace

DroneRun::DroneRun(const RunOptions& options)
    : options_(options),
      view_(options_.http, clock_),
      context_{.clock = clock_, .signals = signals_, .shared = shared_},
      display_(options_.errors) {
  figures_.seed = options_.seed;
  figures_.run = RandomRun();
  for (Phase& phase : options_.swarm.scenario.phases) {
    phase.options.seed = options_.seed;
    phase.options.run = figures_.run;
    // A drone's tick, by which mishaps are drawn.
    phase.options.rate_hz = 1;
  }
}

absl::Status DroneRun::Begin() {
  const absl::StatusOr<v1::ServerStatus> status = view_.Status();
  if (!status.ok()) return status.status();
  started_at_ms_ = view::UnixMs(status->started_at());
  span_.from_ms = view::UnixMs(status->now());
  evidence_.before = DroneMessagesIn(*status);
  return absl::OkStatus();
}

int DroneRun::Main() {
  if (absl::Status status = Begin(); !status.ok()) return CannotRun(status);
  absl::StatusOr<std::unique_ptr<DroneSwarm>> swarm =
      DroneSwarm::Create(options_.swarm, clock_, shared_);
  if (!swarm.ok()) return CannotRun(swarm.status());
  Measurement measurement(options_.http.address, clock_);
  measurement.Begin();
  (*swarm)->Start();
  if (absl::Status status = Send(); !status.ok()) {
    display_.Clear();
    return CannotRun(status);
  }
  figures_.seconds = measurement.SinceBegin().seconds;
  SettleAll(**swarm);
  const Measured measured = measurement.SinceBegin();
  figures_.server = measured.server;
  figures_.own = measured.own;
  const absl::Status gathered = Gather(**swarm);
  shared_.stage.store(DroneStage::kClose);
  (*swarm)->Finish();
  display_.Clear();
  if (!gathered.ok()) return CannotRun(gathered);
  return Conclude(**swarm);
}

std::string DroneRun::Heading() const {
  const auto seconds =
      std::chrono::duration_cast<std::chrono::seconds>(clock_.Steady() - began_).count();
  return shared_.stage.load() == DroneStage::kSend
             ? SendingHeading("drones", seconds, options_.run_for)
             : SettlingHeading(seconds);
}

void DroneRun::Look() {
  if (!display_.Due(clock_.Steady())) return;
  std::optional<Conservation> counts;
  if (const auto status = view_.Status(); status.ok()) {
    counts = DroneMessagesIn(*status);
    evidence_.watch.See(counts);
  } else {
    // A server that does not answer counts nothing either.
    shared_.first_error.Keep(std::string(status.status().message()));
  }
  const std::uint64_t received = counts ? counts->received : 0;
  const std::uint64_t in_flight = counts ? counts->in_flight : 0;
  display_.Show(
      fmt::format(
          "{} calls, {} answered, {} again, {} links cut; server: {} received, {} in flight",
          shared_.sent.load(), shared_.answered.load(), shared_.again.load(), shared_.cut.load(),
          received, in_flight),
      {Heading(),
       {{"calls", fmt::format("{}", shared_.sent.load())},
        {"calls answered", fmt::format("{}", shared_.answered.load())},
        {"calls made again", fmt::format("{}", shared_.again.load())},
        {"links cut", fmt::format("{}", shared_.cut.load())},
        {"samples received by the server", fmt::format("{}", received)},
        {"samples in flight", fmt::format("{}", in_flight)}}});
}

absl::Status DroneRun::Send() {
  const SteadyTime start = began_ = clock_.Steady();
  while (clock_.Steady() - start < options_.run_for) {
    Look();
    if (signals_.Wait(kLook)) break;
    const bool late = clock_.Steady() - start > kFirstAnswerDeadline;
    if (shared_.answered.load() == 0 && late) break;
  }
  if (shared_.answered.load() > 0) return absl::OkStatus();
  return absl::UnavailableError("no call was answered: " + shared_.first_error.Read());
}

bool DroneRun::WaitFor(const std::atomic<std::size_t>& counted, std::size_t groups) {
  const SteadyTime start = clock_.Steady();
  while (counted.load() < groups) {
    if (clock_.Steady() - start > options_.settle_for) return false;
    Look();
    if (signals_.Wait(kLook)) return false;
  }
  return true;
}

void DroneRun::SettleAll(DroneSwarm& swarm) {
  shared_.stage.store(DroneStage::kSettle);
  if (WaitFor(shared_.settled_groups, swarm.groups())) {
    shared_.stage.store(DroneStage::kLast);
    if (WaitFor(shared_.quiet_groups, swarm.groups())) return;
  }
  // Its threads may touch what is compared: they end first.
  shared_.abandon.store(true);
  swarm.Finish();
}

absl::Status DroneRun::Count() {
  const SteadyTime start = clock_.Steady();
  while (true) {
    evidence_.totals.answered = shared_.answered.load();
    const auto status = AskAgain(context_, [this] { return view_.Status(); });
    if (!status.ok()) return status.status();
    evidence_.totals.sent = shared_.sent.load();
    span_.to_ms = view::UnixMs(status->now());
    evidence_.restarted = view::UnixMs(status->started_at()) != started_at_ms_;
    evidence_.after = DroneMessagesIn(*status);
    evidence_.watch.See(evidence_.after);
    // A call that was given up may still wait there.
    const bool still = evidence_.after && evidence_.after->in_flight == 0;
    if (still || clock_.Steady() - start > kAgreeDeadline || signals_.Wait(kLook)) {
      return absl::OkStatus();
    }
  }
}

absl::Status DroneRun::CompareLive(const DroneScript& drone, SteadyTime until) {
  const std::string ruri = DroneRuri(drone.options().index);
  while (true) {
    const auto look = AskAgain(context_, [&] { return view_.RobotText(ruri); });
    if (!look.ok()) return look.status();
    if (!Agrees(drone, *look) && clock_.Steady() < until && !signals_.Wait(kLook)) continue;
    CompareDroneLive(drone, *look, evidence_.findings);
    return absl::OkStatus();
  }
}

absl::Status DroneRun::CompareRows(const DroneScript& drone) {
  const std::string ruri = DroneRuri(drone.options().index);
  auto robot = AskAgain(context_, [&] { return view_.Stored(ruri, span_.from_ms); });
  if (!robot.ok()) return robot.status();
  auto requests = AskAgain(context_, [&] { return view_.OperatorRequests(ruri); });
  if (!requests.ok()) return requests.status();
  ++evidence_.drones_read;
  const StoredDrone stored{.robot = *std::move(robot), .requests = *std::move(requests)};
  CompareDroneRows(drone, stored, evidence_.findings);
  CompareDronePresence(drone, stored, span_, evidence_.findings);
  return absl::OkStatus();
}

absl::Status DroneRun::Gather(const DroneSwarm& swarm) {
  absl::Status status = Count();
  const SteadyTime until = clock_.Steady() + kAgreeDeadline;
  std::size_t drones = 0;
  swarm.ForEach([&](const DroneScript& drone) {
    ++drones;
    if (status.ok()) status = CompareLive(drone, until);
  });
  swarm.ForEach([&](const DroneScript& drone) {
    if (!status.ok()) return;
    const std::string told = fmt::format("{} of {} drones", evidence_.drones_read, drones);
    if (signals_.Came()) {
      status = absl::CancelledError(fmt::format("told to stop after {} were compared", told));
      return;
    }
    if (display_.Due(clock_.Steady())) display_.Show("compared " + told);
    status = CompareRows(drone);
  });
  return status;
}

int DroneRun::Conclude(const DroneSwarm& swarm) {
  swarm.ForEach([this](const DroneScript& drone) { evidence_.totals.Add(drone.account()); });
  figures_.totals = evidence_.totals;
  figures_.again = shared_.again.load();
  figures_.lost = shared_.lost.load();
  figures_.cut = shared_.cut.load();
  figures_.restarted = evidence_.restarted;
  figures_.latencies = swarm.TakeLatencies();
  figures_.first_error = shared_.first_error.Read();
  const std::vector<CheckRow> rows = VerifyDrones(evidence_);
  return Concluded(options_.json
                       ? JsonReport(figures_, rows, evidence_.findings)
                       : TextReport(figures_, rows, evidence_.findings, Palette(options_.output)),
                   rows);
}

}  // namespace uplink::synthetic
