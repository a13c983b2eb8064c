#include "tools/uplink-fleet/run/run.h"

#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "tools/uplink-fleet/report/json_report.h"
#include "tools/uplink-fleet/report/text_report.h"
#include "tools/uplink-fleet/run/exit_code.h"
#include "tools/uplink-fleet/run/measurement.h"
#include "tools/uplink-fleet/run/stages.h"
#include "tools/uplink-fleet/run/sum_up.h"

namespace uplink::synthetic {
namespace {

std::string RandomRun() {
  std::random_device random;
  return fmt::format("{:08x}", random());
}

int CannotRun(const absl::Status& status) {
  fmt::print(stderr, "uplink-fleet: {}\n", std::string(status.message()));
  return kExitFailed;
}

}  // namespace

Run::Run(const RunOptions& options)
    : options_(options),
      view_(options_.http, clock_),
      progress_(view_, clock_, shared_),
      context_{.options = options_,
               .clock = clock_,
               .signals = signals_,
               .shared = shared_,
               .view = view_,
               .progress = progress_} {
  outcome_.id = RandomRun();
  for (Phase& phase : options_.swarm.scenario.phases) {
    phase.options.run = outcome_.id;
    phase.options.seed = options_.seed;
  }
}

int Run::Main() {
  const absl::StatusOr<v1::ServerStatus> before = view_.Status();
  if (!before.ok()) return CannotRun(before.status());
  evidence_.before = *before;
  const absl::StatusOr<std::string> page = view_.Metrics();
  if (!page.ok()) return CannotRun(page.status());
  evidence_.forwards_before = ForwardCountsOf(*page);
  absl::StatusOr<std::unique_ptr<Swarm>> swarm = Swarm::Create(options_.swarm, clock_, shared_);
  if (!swarm.ok()) return CannotRun(swarm.status());
  const bool reached = Live(**swarm);
  outcome_.robots = (*swarm)->Finish();
  outcome_.origins = (*swarm)->Origins();
  figures_.latencies = (*swarm)->TakeLatencies();
  if (!reached) {
    progress_.Clear();
    return CannotRun(
        absl::UnavailableError("no robot was welcomed: " + shared_.first_error.Read()));
  }
  const absl::Status gathered = Gather(context_, outcome_, evidence_);
  progress_.Clear();
  if (!gathered.ok()) return CannotRun(gathered);
  return Conclude();
}

bool Run::Live(Swarm& swarm) {
  Measurement measurement(options_.swarm.target, clock_, shared_);
  swarm.Start();
  const Readiness readiness = AwaitRobots(context_);
  measurement.Begin();
  const bool reached =
      readiness == Readiness::kToldToStop ? shared_.welcomes.load() > 0 : Send(context_);
  measurement.End(figures_);
  if (reached) outcome_.look = Settle(context_);
  Close(context_, reached);
  return reached;
}

int Run::Conclude() {
  evidence_.rules_broken = shared_.rules_broken.load();
  evidence_.first_broken_rule = shared_.first_broken_rule.Read();
  figures_.seed = options_.seed;
  figures_.run = outcome_.id;
  figures_.restarted = Restarted(evidence_);
  SumUp(outcome_.robots, shared_, figures_);
  evidence_.disturbed = WasDisturbed(figures_);
  const std::vector<CheckRow> rows = Verify(evidence_);
  const std::string text = options_.json ? JsonReport(figures_, rows, evidence_.findings)
                                         : TextReport(figures_, rows, evidence_.findings);
  std::fputs(text.c_str(), stdout);
  return AllOk(rows) ? kExitDone : kExitMismatch;
}

}  // namespace uplink::synthetic
