#include "tools/uplink-fleet/run/run.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tools/uplink-fleet/report/json_report.h"
#include "tools/uplink-fleet/report/text_report.h"
#include "tools/uplink-fleet/run/measurement.h"
#include "tools/uplink-fleet/run/stages.h"

namespace uplink::synthetic {

Run::Run(const RunOptions& options)
    : options_(options),
      view_(options_.http, clock_),
      progress_(view_, clock_, shared_, options_),
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
  if (absl::Status status = LookBefore(); !status.ok()) return CannotRun(status);
  absl::StatusOr<std::unique_ptr<Swarm>> swarm = Swarm::Create(options_.swarm, clock_, shared_);
  if (!swarm.ok()) return CannotRun(swarm.status());
  const bool reached = Live(**swarm);
  outcome_.robots = (*swarm)->Finish();
  outcome_.origins = (*swarm)->Origins();
  latencies_ = (*swarm)->TakeLatencies();
  if (!reached) {
    progress_.Clear();
    return CannotRun(
        absl::UnavailableError("no robot was welcomed: " + shared_.first_error.Read()));
  }
  const absl::Status gathered = GatherEvidence();
  progress_.Clear();
  if (!gathered.ok()) return CannotRun(gathered);
  return Conclude();
}

absl::Status Run::LookBefore() {
  if (options_.acks_only) return absl::OkStatus();
  const absl::StatusOr<v1::ServerStatus> before = view_.Status();
  if (!before.ok()) return before.status();
  evidence_.before = *before;
  const absl::StatusOr<std::string> page = view_.Metrics();
  if (!page.ok()) return page.status();
  evidence_.forwards_before = ForwardsOn(*page);
  return absl::OkStatus();
}

absl::Status Run::GatherEvidence() {
  if (!options_.acks_only) return Gather(context_, outcome_, evidence_);
  for (const RobotOutcome& robot : outcome_.robots) evidence_.fleet.Add(robot);
  return absl::OkStatus();
}

bool Run::Live(Swarm& swarm) {
  Measurement measurement(options_.swarm.target, clock_);
  swarm.Start();
  const Readiness readiness = AwaitRobots(context_);
  measurement.Begin();
  const std::uint64_t sent_before = shared_.sent.load();
  const bool reached =
      readiness == Readiness::kToldToStop ? shared_.welcomes.load() > 0 : Send(context_);
  measured_ = measurement.SinceBegin();
  sent_while_measured_ = shared_.sent.load() - sent_before;
  if (reached && options_.acks_only) SettleAcks(context_);
  if (reached && !options_.acks_only) outcome_.look = Settle(context_);
  Close(context_, reached);
  return reached;
}

int Run::Conclude() {
  evidence_.rules_broken = shared_.rules_broken.load();
  evidence_.first_broken_rule = shared_.first_broken_rule.Read();
  RunFigures figures = SumUp(outcome_.robots, shared_);
  figures.seed = options_.seed;
  figures.run = outcome_.id;
  figures.seconds = measured_.seconds;
  figures.server = measured_.server;
  figures.own = measured_.own;
  figures.sent_while_measured = sent_while_measured_;
  figures.latencies = std::move(latencies_);
  figures.restarted = Restarted(evidence_);
  evidence_.disturbed = WasDisturbed(figures);
  const std::vector<CheckRow> rows = options_.acks_only ? VerifyAcks(evidence_) : Verify(evidence_);
  return Concluded(options_.json
                       ? JsonReport(figures, rows, evidence_.findings)
                       : TextReport(figures, rows, evidence_.findings, Palette(options_.output)),
                   rows);
}

}  // namespace uplink::synthetic
