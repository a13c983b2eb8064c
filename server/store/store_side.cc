#include "server/store/store_side.h"

#include <string>
#include <utility>

namespace uplink::store {
namespace {

/// A store's clock that differs by more is worth a line.
constexpr std::chrono::seconds kClockOffsetNoted{5};

std::vector<journal::Journal*> PointersTo(
    const std::vector<std::unique_ptr<journal::Journal>>& journals) {
  std::vector<journal::Journal*> pointers;
  pointers.reserve(journals.size());
  for (const auto& journal : journals) pointers.push_back(journal.get());
  return pointers;
}

}  // namespace

StoreSide::StoreSide(Stores stores, Parts parts)
    : stores_(std::move(stores)),
      parts_(std::move(parts)),
      journals_(MakeJournals()),
      shards_(PointersTo(journals_)),
      seed_(parts_.fleet, shards_, *stores_.reader, parts_.clock) {
  if (parts_.checkpoint_every == milliseconds(0)) return;
  for (const auto& journal : journals_) {
    checkpoints_.push_back(std::make_unique<fleet::Checkpoint>(fleet::Checkpoint::Sources{
        .fleet = parts_.fleet,
        .writes = [this, writer = journal.get()](
                      std::string_view ruri) { return &shards_.Of(ruri) == writer; },
        .restored = [this] { return seed_.done(); }}));
    journal->CheckpointFrom(*checkpoints_.back(), parts_.checkpoint_every);
  }
}

std::vector<std::unique_ptr<journal::Journal>> StoreSide::MakeJournals() {
  journal::JournalLimits limits = journal::ShareOf(parts_.limits, stores_.writers.size());
  std::vector<std::unique_ptr<journal::Journal>> journals;
  for (std::size_t shard = 0; shard < stores_.writers.size(); ++shard) {
    limits.sweeps = shard == 0;
    limits.retains = shard == 0;
    journals.push_back(std::make_unique<journal::Journal>(
        *stores_.writers[shard], limits, parts_.clock, parts_.ledgers.NewPage(), parts_.probe,
        journal::PresenceSessionOf(parts_.process, shard)));
  }
  return journals;
}

std::uint64_t StoreSide::Random() {
  const std::lock_guard lock(random_mutex_);
  return parts_.random();
}

void StoreSide::LookAtFacts() {
  const storage::StoreFacts facts = stores_.facts();
  if (facts.unsafe && !said_unsafe_) {
    parts_.logger.Warn("store_unsafe", {{"why", "fsync is off: what is acked may be lost"}});
  }
  said_unsafe_ = facts.unsafe;
  const bool differs =
      facts.clock_offset > kClockOffsetNoted || -facts.clock_offset > kClockOffsetNoted;
  if (differs && !said_clock_) {
    parts_.logger.Warn("store_clock_differs", {{"offset_ms", facts.clock_offset.count()}});
  }
  said_clock_ = differs;
}

absl::Status StoreSide::Begin() {
  LookAtFacts();
  absl::Status away = stores_.away;
  if (away.ok()) {
    absl::Status seeded = seed_.Run(parts_.robots_max);
    NoteLiveLeftOut();
    if (!absl::IsUnavailable(seeded) && !absl::IsDeadlineExceeded(seeded)) return seeded;
    away = std::move(seeded);
  }
  parts_.logger.Warn("store_away", {{"why", std::string(away.message())}});
  return absl::OkStatus();
}

void StoreSide::ReadRobotsOn(const std::function<bool(std::function<void()>)>& post) {
  if (seed_.done() || reading_.exchange(true)) return;
  const bool posted = post([this] {
    ReadRobots();
    reading_.store(false);
  });
  // A full queue of reads is another time's chance.
  if (!posted) reading_.store(false);
}

void StoreSide::ReadRobots() {
  const absl::Status read = seed_.Run(parts_.robots_max);
  if (read.ok()) {
    parts_.logger.Info("robots_read", {{"robots", parts_.fleet.size()}});
    NoteLiveLeftOut();
  } else if (seed_.done()) {
    parts_.logger.Error("robots_left_out", {{"why", std::string(read.message())}});
  }
}

void StoreSide::NoteLiveLeftOut() {
  if (seed_.live_left_out() == 0) return;
  parts_.logger.Warn("live_state_left_out", {{"messages", seed_.live_left_out()},
                                             {"why", "this version does not pass them"}});
}

void StoreSide::NoteTurn(bool& works, const absl::Status& status, const Turn& turn) {
  if (status.ok() == works) return;
  works = status.ok();
  if (works) {
    parts_.logger.Info(turn.works_again, {});
  } else {
    parts_.logger.Warn(turn.fails, {{"why", std::string(status.message())}});
  }
}

void StoreSide::LookForErrors() {
  LookAtFacts();
  NoteTurn(retains_, shards_.retain_error(), {"retention_fails", "retention_works_again"});
  NoteTurn(checkpoints_work_, shards_.checkpoint_error(),
           {"checkpoint_fails", "checkpoint_works_again"});
  NoteTurn(works_, shards_.last_error(), {"store_fails", "store_works_again"});
}

void StoreSide::StartWriters() {
  for (const auto& journal : journals_) {
    writers_.push_back(std::make_unique<journal::JournalWriter>(*journal, storage::BackoffLimits{},
                                                                [this] { return Random(); }));
  }
}

void StoreSide::StopWriters() {
  for (const auto& writer : writers_) writer->RequestStop();
  for (const auto& writer : writers_) writer->Stop();
}

}  // namespace uplink::store
