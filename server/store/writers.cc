#include "server/store/writers.h"

#include <cstddef>
#include <utility>

namespace uplink::store {
namespace {

std::vector<std::unique_ptr<journal::Journal>> MakeJournals(
    std::span<const std::unique_ptr<storage::Store>> stores, const Writers::Parts& parts) {
  journal::JournalLimits limits = journal::ShareOf(parts.limits, stores.size());
  std::vector<std::unique_ptr<journal::Journal>> journals;
  for (std::size_t shard = 0; shard < stores.size(); ++shard) {
    limits.sweeps = shard == 0;
    limits.retains = shard == 0;
    journals.push_back(std::make_unique<journal::Journal>(
        *stores[shard], limits, parts.clock, parts.ledgers.NewPage(), parts.probe,
        journal::PresenceSessionOf(parts.process, shard)));
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

Writers::Writers(std::span<const std::unique_ptr<storage::Store>> stores, Parts parts)
    : parts_(std::move(parts)),
      journals_(MakeJournals(stores, parts_)),
      shards_(PointersTo(journals_)) {
  if (parts_.checkpoint_every == milliseconds(0)) return;
  for (const auto& journal : journals_) {
    checkpoints_.push_back(std::make_unique<fleet::Checkpoint>(fleet::Checkpoint::Sources{
        .fleet = parts_.fleet,
        .writes = [this, writer = journal.get()](
                      std::string_view ruri) { return &shards_.Of(ruri) == writer; },
        .restored = parts_.restored}));
    journal->CheckpointFrom(*checkpoints_.back(), parts_.checkpoint_every);
  }
}

std::uint64_t Writers::Random() {
  const std::lock_guard lock(random_mutex_);
  return parts_.random();
}

void Writers::Start() {
  for (const auto& journal : journals_) {
    writers_.push_back(std::make_unique<journal::JournalWriter>(*journal, storage::BackoffLimits{},
                                                                [this] { return Random(); }));
  }
}

void Writers::Stop() {
  for (const auto& writer : writers_) writer->RequestStop();
  for (const auto& writer : writers_) writer->Stop();
}

}  // namespace uplink::store
