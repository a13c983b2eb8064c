#include "server/store/writers.h"

#include <cstddef>
#include <utility>

namespace uplink::store {
namespace {

void TellSlowCommit(const log::Logger& logger, std::size_t shard,
                    const journal::SlowCommit& commit) {
  if (!logger.Enabled(log::Level::kDebug)) return;
  logger.Debug("commit_slow", {{"shard", shard},
                               {"records", commit.records},
                               {"presence_changes", commit.presence_changes},
                               {"ms", commit.took.count()}});
}

void TellMove(log::RateLimited& lines, const journal::Moved& moved) {
  lines.Write(
      log::Level::kInfo, "robot_moved",
      {{"robot", moved.ruri}, {"from", moved.from}, {"to", moved.to}, {"gateway", moved.gateway}});
}

std::unique_ptr<log::RateLimited> LinesOf(const log::Logger* logger) {
  return logger == nullptr ? nullptr : std::make_unique<log::RateLimited>(*logger);
}

std::vector<std::unique_ptr<journal::Journal>> MakeJournals(
    std::span<const std::unique_ptr<storage::Store>> stores, const Writers::Context& context,
    log::RateLimited* moves, log::RateLimited* drops) {
  journal::JournalLimits limits = journal::ShareOf(context.limits, stores.size());
  std::vector<std::unique_ptr<journal::Journal>> journals;
  for (std::size_t shard = 0; shard < stores.size(); ++shard) {
    limits.sweeps = shard == 0;
    limits.retains = shard == 0;
    journals.push_back(std::make_unique<journal::Journal>(
        *stores[shard], limits, context.clock, context.ledgers.NewPage(), context.probe,
        journal::PresenceSessionOf(context.process, shard)));
    journals.back()->OnSpatial(context.spatial_committed);
    journals.back()->OnReconnected(
        [&fleet = context.fleet, told = context.store_reconnected](journal::Reconnected to) {
          if (to == journal::Reconnected::kMayHaveGoneBack) fleet.NoteStoreReplaced();
          told();
        });
    if (shard == 0 && context.is_over) journals.back()->EndConnections(context.is_over);
    journals.back()->OnMoved([moves, told = context.moved](const auto& moved) {
      if (moves != nullptr) TellMove(*moves, moved);
      told(moved);
    });
    if (context.logger == nullptr) continue;
    journals.back()->OnSlowCommit([logger = context.logger, shard](const auto& commit) {
      TellSlowCommit(*logger, shard, commit);
    });
    journals.back()->OnConnectionDropped([drops](const model::RobotId& robot) {
      drops->Write(log::Level::kWarn, "connection_dropped", {{"robot", robot.ruri}});
    });
  }
  return journals;
}

std::vector<journal::Journal*> PointersTo(
    const std::vector<std::unique_ptr<journal::Journal>>& journals) {
  std::vector<journal::Journal*> pointers;
  pointers.reserve(journals.size());
  for (const auto& journal : journals) pointers.push_back(journal.get());
  return pointers;
}

}  // namespace

Writers::Writers(std::span<const std::unique_ptr<storage::Store>> stores, Context context)
    : context_(std::move(context)),
      moves_(LinesOf(context_.logger)),
      drops_(LinesOf(context_.logger)),
      journals_(MakeJournals(stores, context_, moves_.get(), drops_.get())),
      shards_(PointersTo(journals_)) {
  if (context_.checkpoint_every == milliseconds(0)) return;
  for (const auto& journal : journals_) {
    checkpoints_.push_back(std::make_unique<fleet::Checkpoint>(fleet::Checkpoint::Sources{
        .fleet = context_.fleet, .writes = [this, writer = journal.get()](std::string_view ruri) {
          return &shards_.Of(ruri) == writer;
        }}));
    journal->CheckpointFrom(*checkpoints_.back(), context_.checkpoint_every);
  }
}

std::uint64_t Writers::Random() {
  const std::lock_guard lock(random_mutex_);
  return context_.random();
}

void Writers::Start() {
  for (const auto& journal : journals_) {
    writers_.push_back(std::make_unique<journal::JournalWriter>(*journal, BackoffLimits{},
                                                                [this] { return Random(); }));
  }
}

void Writers::Stop() {
  for (const auto& writer : writers_) writer->RequestStop();
  for (const auto& writer : writers_) writer->Stop();
}

}  // namespace uplink::store
