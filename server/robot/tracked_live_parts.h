#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "schema/base/clock.h"
#include "schema/model/rcan.h"
#include "schema/model/record.h"
#include "server/robot/live_parts.h"
#include "server/robot/live_total.h"
#include "storage/live_parts.h"

namespace uplink::robot {

/// Memory of each live part, by storage::LivePart.
using LivePartBytes = std::array<std::size_t, storage::kLivePartKinds>;

/// The live parts of one robot, the changed ones among them, and their memory, counted as they
/// change, by part and in a total. Confined to its owner's lock.
class TrackedLiveParts final {
 public:
  /// Call it before the first part, and before it is shared between threads.
  void CountIn(std::shared_ptr<LiveTotal> total) { share_.CountIn(std::move(total)); }

  [[nodiscard]] const LiveParts& parts() const { return parts_; }
  [[nodiscard]] const LivePartBytes& part_bytes() const { return part_bytes_; }
  [[nodiscard]] std::size_t bytes() const { return share_.bytes(); }

  /// Returns the number of evicted keys. A body of a durable kind is our bug.
  std::size_t Put(model::Body&& body, SteadyTime arrived);
  void Put(model::RcanState&& state);
  /// Takes over older parts that have no newer value and were not dropped. A part that both sides
  /// have values of counts as changed, since the store has only the older ones; so does a dropped
  /// one.
  void Restore(LiveParts&& before);
  /// The store's parts, if any, are restored. Parts that were dropped until now are no longer older
  /// in the store.
  void EndRestore() { dropped_.reset(); }
  /// Drops one part, which counts as a change.
  void Drop(storage::LivePart part);
  /// Drops everything, as if nothing had ever come.
  void Clear();

  [[nodiscard]] bool changed() const { return changed_.any(); }
  /// Grows with each change of the parts.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  [[nodiscard]] LivePartSet TakeChanged() { return std::exchange(changed_, {}); }
  void PutBackChanged(const LivePartSet& changed) { changed_ |= changed; }

 private:
  void NoteChanged(storage::LivePart part);
  void Count(storage::LivePart part);

  LiveParts parts_;
  LivePartSet changed_;
  std::uint64_t changes_ = 0;
  /// Parts dropped since the last EndRestore. A part stays in it even if new values came: a restore
  /// would bring values older than the drop.
  LivePartSet dropped_;
  LivePartBytes part_bytes_{};
  LiveShare share_;
};

}  // namespace uplink::robot
