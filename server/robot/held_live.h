#pragma once

#include <array>
#include <cstddef>
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

/// The live parts of one robot, which of them changed, and their memory: counted part by part as
/// they change, and in a total. Confined to its owner's lock.
class HeldLive final {
 public:
  /// Before the first part, and before it is shared between threads.
  void CountIn(std::shared_ptr<LiveTotal> total) { share_.CountIn(std::move(total)); }

  [[nodiscard]] const LiveParts& parts() const { return parts_; }
  [[nodiscard]] const LivePartBytes& part_bytes() const { return part_bytes_; }
  [[nodiscard]] std::size_t bytes() const { return share_.bytes(); }

  /// Returns the number of keys that had to go. A body of a durable kind is a mistake of ours.
  std::size_t Put(model::Body&& body, SteadyTime arrived);
  void Put(model::RcanState&& state);
  /// Takes over what is not known better by now, and nothing of a part that was dropped: that is
  /// older. A part that the store then has neither side whole of has changed.
  void Restore(LiveParts&& before);
  /// What the store had is restored, if it had any. Parts that were dropped until now are not older
  /// in the store any more.
  void EndRestore() { dropped_.reset(); }
  /// Lets go of one part: it has changed, to nothing.
  void Drop(storage::LivePart part);
  /// Lets go of all, as if nothing had ever come.
  void Clear();

  [[nodiscard]] bool changed() const { return changed_.any(); }
  [[nodiscard]] LivePartSet TakeChanged() { return std::exchange(changed_, {}); }
  void PutBackChanged(const LivePartSet& changed) { changed_ |= changed; }

 private:
  void NoteChanged(storage::LivePart part);
  void Count(storage::LivePart part);

  LiveParts parts_;
  LivePartSet changed_;
  /// Since the last EndRestore. A part stays in it though something came since: what a restore
  /// would bring is older than the drop.
  LivePartSet dropped_;
  LivePartBytes part_bytes_{};
  LiveShare share_;
};

}  // namespace uplink::robot
