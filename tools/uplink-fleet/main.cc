#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include "schema/base/clock.h"
#include "tools/uplink-fleet/compare/compare.h"
#include "tools/uplink-fleet/compare/verify.h"
#include "tools/uplink-fleet/flags.h"
#include "tools/uplink-fleet/report/live_summary.h"
#include "tools/uplink-fleet/report/process_use.h"
#include "tools/uplink-fleet/report/progress_line.h"
#include "tools/uplink-fleet/report/report.h"
#include "tools/uplink-fleet/robot/swarm.h"
#include "tools/uplink-fleet/run/server_view.h"
#include "tools/uplink-fleet/run/signals.h"

namespace uplink::synthetic {
namespace {

constexpr milliseconds kLook{100};
/// Without any Welcome for that long at the start, nothing can be run.
constexpr milliseconds kFirstWelcomeDeadline{15'000};
/// The counters of the queue threads are published a moment after the acks.
constexpr milliseconds kCountersDeadline{3000};
/// For a server that does not answer while it is looked at: a start takes a second or two.
constexpr milliseconds kAnswerDeadline{10'000};

constexpr std::array<const char*, kStatusCodes> kStatusNames = {
    "OK",        "CANCELLED",      "UNKNOWN",           "INVALID_ARGUMENT",   "DEADLINE_EXCEEDED",
    "NOT_FOUND", "ALREADY_EXISTS", "PERMISSION_DENIED", "RESOURCE_EXHAUSTED", "FAILED_PRECONDITION",
    "ABORTED",   "OUT_OF_RANGE",   "UNIMPLEMENTED",     "INTERNAL",           "UNAVAILABLE",
    "DATA_LOSS", "UNAUTHENTICATED"};

class Run {
 public:
  explicit Run(const Flags& flags) : flags_(flags), view_(flags.http, clock_) {}

  int Main() {
    run_ = RandomRun();
    for (Phase& phase : flags_.swarm.scenario.phases) {
      phase.options.run = run_;
      phase.options.seed = flags_.seed;
    }
    const absl::StatusOr<v1::ServerStatus> before = view_.Status();
    if (!before.ok()) return CannotRun(before.status());
    evidence_.before = *before;
    absl::StatusOr<std::unique_ptr<Swarm>> swarm = Swarm::Create(flags_.swarm, clock_, shared_);
    if (!swarm.ok()) return CannotRun(swarm.status());
    const std::optional<pid_t> server = ServerProcess();
    (*swarm)->Start();
    // Robots that were offline first live through that time before any of them connects.
    bool told = false;
    while (shared_.threads_ready.load() < flags_.swarm.threads && !told) {
      told = signals_.Wait(kLook);
    }
    if (shared_.threads_ready.load() < flags_.swarm.threads) shared_.abandon.store(true);
    const std::optional<ProcessUse> server_before = server ? UseOf(*server) : std::nullopt;
    const ProcessUse own_before = UseOf(getpid()).value_or(ProcessUse());
    const std::uint64_t sent_before = shared_.sent.load();
    const SteadyTime started = clock_.Steady();
    const bool reached = told ? shared_.welcomes.load() > 0 : Send();
    const std::optional<ProcessUse> server_after = server ? UseOf(*server) : std::nullopt;
    if (server_before && server_after) figures_.server = server_after->Since(*server_before);
    figures_.sent_while_measured = shared_.sent.load() - sent_before;
    figures_.own = UseOf(getpid()).value_or(ProcessUse()).Since(own_before);
    figures_.seconds = std::chrono::duration<double>(clock_.Steady() - started).count();
    if (reached) Settle();
    shared_.stage.store(Stage::kClose);
    if (!reached || !WaitFor(shared_.closed_robots, flags_.settle_for)) shared_.abandon.store(true);
    outcomes_ = (*swarm)->Finish();
    figures_.latencies = (*swarm)->TakeLatencies();
    if (!reached) {
      progress_.Clear();
      return CannotRun(absl::UnavailableError("no robot was welcomed: " + shared_.FirstError()));
    }
    const absl::Status gathered = Gather();
    progress_.Clear();
    if (!gathered.ok()) return CannotRun(gathered);
    return Conclude();
  }

 private:
  static std::string RandomRun() {
    std::random_device random;
    return fmt::format("{:08x}", random());
  }

  /// The server, if it is a process of this machine.
  [[nodiscard]] std::optional<pid_t> ServerProcess() const {
    const std::string& target = flags_.swarm.target;
    const std::string host = target.substr(0, target.rfind(':'));
    if (host != "localhost" && host != "[::1]" && !host.starts_with("127.")) return std::nullopt;
    return ListenerOf(
        static_cast<std::uint16_t>(std::stoul("0" + target.substr(target.rfind(':') + 1))));
  }

  static int CannotRun(const absl::Status& status) {
    fmt::print(stderr, "uplink-fleet: {}\n", std::string(status.message()));
    return kExitFailed;
  }

  /// The run itself; false if the server never welcomed a robot.
  bool Send() {
    const SteadyTime start = clock_.Steady();
    while (clock_.Steady() - start < flags_.run_for) {
      Progress();
      if (signals_.Wait(kLook)) break;
      if (shared_.welcomes.load() == 0 && clock_.Steady() - start > kFirstWelcomeDeadline) {
        return false;
      }
    }
    return shared_.welcomes.load() > 0;
  }

  /// Settles all, and looks at the live state while the robots are still there.
  void Settle() {
    shared_.stage.store(Stage::kSettle);
    if (!WaitFor(shared_.settled_robots, flags_.settle_for)) return;
    shared_.stage.store(Stage::kLast);
    const SteadyTime start = clock_.Steady();
    for (std::size_t round = 1; clock_.Steady() - start < flags_.settle_for; ++round) {
      const auto began = Again([this] { return view_.Status(); });
      shared_.last_round.store(round);
      if (!WaitFor(shared_.last_robots, flags_.settle_for, round)) return;
      auto live = Again([this] { return view_.Robots(flags_.swarm.fleet); });
      const auto ended = Again([this] { return view_.Status(); });
      if (!began.ok() || !live.ok() || !ended.ok()) continue;
      live_ = std::move(*live);
      live_at_ms_ = ended->now_ms();
      // A server that was started anew in between has forgotten what it acked as judged.
      if (began->started_at_ms() == ended->started_at_ms()) return;
    }
  }

  /// Asks again for some seconds while the server does not answer: it may be starting.
  template <typename Ask>
  auto Again(const Ask& ask) -> decltype(ask()) {
    const SteadyTime start = clock_.Steady();
    while (true) {
      auto answer = ask();
      if (answer.ok() || clock_.Steady() - start > kAnswerDeadline) return answer;
      shared_.KeepFirstError(std::string(answer.status().message()));
      if (signals_.Wait(kLook)) return answer;
    }
  }

  bool WaitFor(const std::atomic<std::size_t>& robots, milliseconds deadline,
               std::size_t times = 1) {
    const SteadyTime start = clock_.Steady();
    while (robots.load() < flags_.swarm.scenario.robots * times) {
      if (clock_.Steady() - start > deadline) return false;
      Progress();
      // A second signal while settling gives up the rest.
      if (signals_.Wait(kLook)) return false;
    }
    return true;
  }

  absl::Status Gather() {
    const SteadyTime start = clock_.Steady();
    while (true) {
      absl::StatusOr<v1::ServerStatus> after = Again([this] { return view_.Status(); });
      if (!after.ok()) return after.status();
      evidence_.after = std::move(*after);
      const auto in_flight = evidence_.after.uplinks().find("inFlight");
      if (in_flight == evidence_.after.uplinks().end() || in_flight->second == 0 ||
          clock_.Steady() - start > kCountersDeadline || signals_.Wait(kLook)) {
        break;
      }
    }
    for (const RobotOutcome& robot : outcomes_) {
      // Thousands of robots take minutes to compare.
      if (signals_.Wait(milliseconds(0))) {
        return absl::CancelledError(fmt::format("told to stop after {} of {} robots were compared",
                                                evidence_.robots_read, outcomes_.size()));
      }
      if (progress_.Due(clock_.Steady())) {
        progress_.Show(
            fmt::format("compared {} of {} robots", evidence_.robots_read, outcomes_.size()));
      }
      evidence_.fleet.Add(robot);
      const auto live = live_.find(robot.ruri);
      CompareLive(robot, live == live_.end() ? nullptr : &live->second, evidence_.findings);
      const auto stored =
          Again([&] { return view_.Stored(robot.ruri, evidence_.before.now_ms()); });
      if (!stored.ok()) return stored.status();
      ++evidence_.robots_read;
      CompareRows(robot, *stored, run_, evidence_.findings);
      ComparePresence(robot, *stored, {evidence_.before.now_ms(), live_at_ms_}, evidence_.findings);
    }
    return absl::OkStatus();
  }

  int Conclude() {
    evidence_.rules_broken = shared_.rules_broken.load();
    evidence_.first_broken_rule = shared_.FirstBrokenRule();
    FillFigures();
    evidence_.disturbed = figures_.breaks > 0 || figures_.takeovers > 0 ||
                          figures_.ends.size() > figures_.ends.count("OK") || figures_.drains > 0;
    const std::vector<CheckRow> rows = Verify(evidence_);
    const std::string text = flags_.json ? JsonReport(figures_, rows, evidence_.findings)
                                         : TextReport(figures_, rows, evidence_.findings);
    std::fputs(text.c_str(), stdout);
    return AllOk(rows) ? kExitDone : kExitMismatch;
  }

  void FillFigures() {
    figures_.robots = outcomes_.size();
    figures_.seed = flags_.seed;
    figures_.run = run_;
    for (const RobotOutcome& robot : outcomes_) {
      figures_.sent += robot.sent;
      figures_.resent += robot.resent;
      figures_.judged += robot.judged;
      figures_.notices += robot.notices;
    }
    figures_.acked_durable = shared_.acked_durable.load();
    figures_.rejects = shared_.RejectsInAll();
    figures_.rejects_by_reason = RejectsByReason(shared_);
    figures_.only_moving = shared_.only_moving.load();
    figures_.welcomes = shared_.welcomes.load();
    figures_.breaks = shared_.breaks.load();
    figures_.takeovers = shared_.takeovers.load();
    figures_.connects = shared_.connects.load();
    figures_.skipped_ticks = shared_.skipped_ticks.load();
    figures_.drains = shared_.drains.load();
    figures_.restarted = Restarted(evidence_);
    figures_.first_error = shared_.FirstError();
    for (std::size_t code = 0; code < kStatusCodes; ++code) {
      const std::uint64_t count = shared_.ends[code].load();
      if (count > 0) figures_.ends[kStatusNames[code]] = count;
    }
  }

  void Progress() {
    const SteadyTime now = clock_.Steady();
    if (!progress_.Due(now)) return;
    absl::StatusOr<v1::ServerStatus> status = view_.Status();
    absl::StatusOr<std::string> page = view_.Metrics();
    progress_.Show(summary_.Line(shared_, now,
                                 status.ok() ? std::optional(*std::move(status)) : std::nullopt,
                                 page.ok() ? std::optional(*std::move(page)) : std::nullopt));
  }

  Flags flags_;
  /// Unique to this run.
  std::string run_;
  Signals signals_;
  SystemClock clock_;
  Shared shared_;
  ServerView view_;
  LiveSummary summary_;
  std::vector<RobotOutcome> outcomes_;
  /// The robots while they still moved, and the server's clock then.
  std::map<std::string, v1::Robot> live_;
  std::int64_t live_at_ms_ = 0;
  Evidence evidence_;
  RunFigures figures_;
  ProgressLine progress_;
};

}  // namespace
}  // namespace uplink::synthetic

namespace {

/// A connection is a descriptor: as many as this user may have.
void RaiseDescriptorLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace

int main(int argc, char** argv) {
  RaiseDescriptorLimit();
  // A server that closes a connection is no end of the fleet.
  std::signal(SIGPIPE, SIG_IGN);
  int code = uplink::synthetic::kExitDone;
  const auto flags = uplink::synthetic::ReadFlags(argc, argv, code);
  if (!flags) return code;
  uplink::synthetic::Run run(*flags);
  return run.Main();
}
