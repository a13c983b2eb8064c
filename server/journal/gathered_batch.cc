#include "server/journal/gathered_batch.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace uplink::journal {
namespace {

std::size_t BytesOf(const std::vector<Origin>& origins) {
  std::size_t bytes = 0;
  for (const Origin& origin : origins) bytes += origin.bytes;
  return bytes;
}

/// Keeps the order of the rest. Returns the origins of removed entries.
template <class Item>
std::vector<Origin> DropVoidFrom(std::vector<Item>& items, std::vector<Origin>& origins) {
  std::vector<Origin> dropped;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (origins[i].IsVoid()) {
      dropped.push_back(std::move(origins[i]));
      continue;
    }
    if (kept != i) {
      origins[kept] = std::move(origins[i]);
      items[kept] = std::move(items[i]);
    }
    ++kept;
  }
  origins.resize(kept);
  items.erase(items.begin() + static_cast<std::ptrdiff_t>(kept), items.end());
  return dropped;
}

template <class Item>
void MoveRest(std::vector<Item>& items, std::vector<Origin>& origins, std::size_t keep,
              std::vector<Entry>& rest) {
  // Entries of one message stay together.
  while (keep > 0 && keep < origins.size() && origins[keep - 1].continues) ++keep;
  if (origins.size() <= keep) return;
  for (std::size_t i = keep; i < origins.size(); ++i) {
    rest.push_back({.origin = std::move(origins[i]), .item = std::move(items[i])});
  }
  origins.resize(keep);
  items.erase(items.begin() + static_cast<std::ptrdiff_t>(keep), items.end());
}

template <class Item>
void MoveRest(std::vector<Item>& items, std::size_t keep, std::vector<Item>& rest) {
  if (items.size() <= keep) return;
  const auto first = items.begin() + static_cast<std::ptrdiff_t>(keep);
  rest.assign(std::make_move_iterator(first), std::make_move_iterator(items.end()));
  items.erase(first, items.end());
}

}  // namespace

void GatheredBatch::Add(Entry entry) {
  if (auto* record = std::get_if<storage::CommitRecord>(&entry.item)) {
    batch_.records.push_back(std::move(*record));
    origins_.push_back(std::move(entry.origin));
  } else {
    batch_.gaps.push_back(std::move(std::get<storage::GapItem>(entry.item)));
    gap_origins_.push_back(std::move(entry.origin));
  }
}

std::size_t GatheredBatch::bytes() const { return BytesOf(origins_) + BytesOf(gap_origins_); }

std::size_t GatheredBatch::longest() const {
  return std::max(
      {origins_.size(), gap_origins_.size(), batch_.presence.size(), batch_.connections.size()});
}

GatheredBatch::Dropped GatheredBatch::DropVoid() {
  const std::vector<Origin> records = DropVoidFrom(batch_.records, origins_);
  const std::vector<Origin> gaps = DropVoidFrom(batch_.gaps, gap_origins_);
  Dropped dropped{.entries = records.size() + gaps.size(),
                  .bytes = BytesOf(records) + BytesOf(gaps),
                  .gap_clients = {}};
  dropped.gap_clients.reserve(gaps.size());
  for (const Origin& origin : gaps) dropped.gap_clients.push_back(origin.client);
  return dropped;
}

void GatheredBatch::SetHolds(const HeldRobots& held) {
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    batch_.records[i].held_since = held.Since(*origins_[i].client);
  }
  for (std::size_t i = 0; i < gap_origins_.size(); ++i) {
    batch_.gaps[i].held_since = held.Since(*gap_origins_[i].client);
  }
}

void GatheredBatch::MarkTried() {
  for (Origin& origin : origins_) origin.tried = true;
}

GatheredBatch::Rest GatheredBatch::TakeRest(std::size_t keep) {
  Rest rest;
  MoveRest(batch_.records, origins_, keep, rest.entries);
  MoveRest(batch_.gaps, gap_origins_, keep, rest.entries);
  MoveRest(batch_.presence, keep, rest.presence);
  MoveRest(batch_.connections, keep, rest.connections);
  return rest;
}

void GatheredBatch::ClearEntries() {
  batch_.records.clear();
  batch_.gaps.clear();
  batch_.deliveries.clear();
  origins_.clear();
  gap_origins_.clear();
  commit_waiters_.clear();
}

}  // namespace uplink::journal
