#include "storage/change_walk.h"

#include <utility>

namespace uplink::storage {

ChangeWalk::ChangeWalk(const ChangePositions& from, ChangePositions last) : last_(std::move(last)) {
  changes_.positions.read_at = last_.read_at;
  if (last_.read_at - from.read_at >= kChangesReadWithin) changes_.trimmed = true;
  for (const auto& [writer, position] : from.writers) {
    const auto there = last_.writers.find(writer);
    if (there == last_.writers.end()) {
      // One that went for its age had no change after the last that was read. One that went sooner
      // is not in this copy of the store.
      if (last_.read_at - position.noted_at < kChangeWriterKept) changes_.trimmed = true;
      continue;
    }
    if (there->second.number < position.number) changes_.trimmed = true;
    changes_.positions.writers.emplace(writer, position);
  }
}

void ChangeWalk::Take(const WriterId& writer, const ChangePosition& change, ItemKey key) {
  ++taken_;
  ChangePosition& position = changes_.positions.writers[writer];
  if (change.number != position.number + 1) changes_.trimmed = true;
  position = change;
  if (seen_.insert(key).second) changes_.keys.push_back(std::move(key));
}

SharedChanges ChangeWalk::Finish() && {
  changes_.more = taken_ >= kChangesReadMax;
  for (const auto& [writer, last] : last_.writers) {
    // Nothing is left of what it wrote.
    if (!changes_.more && changes_.positions.writers[writer].number < last.number) {
      changes_.trimmed = true;
    }
  }
  if (changes_.trimmed) {
    SharedChanges trimmed;
    trimmed.trimmed = true;
    return trimmed;
  }
  return std::move(changes_);
}

}  // namespace uplink::storage
