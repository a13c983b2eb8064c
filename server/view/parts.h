#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "server/robot/live_parts.h"
#include "storage/latest_kind.h"
#include "storage/live_parts.h"

namespace uplink::view {

/// The parts that a Robot can carry. First those whose latest row the store keeps, then the live
/// ones, then what a twin's messages at a broker and a drone's calls reported.
enum class Part : std::uint8_t {
  kAgentInfo,
  kSettings,
  kUiCapabilities,
#define UPLINK_PART(Part, column, view, Message, keys_max) k##Part,
  UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
      kCyberwave,
  kUncrew,
};
inline constexpr std::size_t kParts = storage::kLatestKinds + storage::kLivePartKinds + 2;

[[nodiscard]] constexpr Part ToPart(storage::LatestKind kind) { return static_cast<Part>(kind); }
[[nodiscard]] constexpr Part ToPart(storage::LivePart part) {
  return static_cast<Part>(storage::kLatestKinds + static_cast<std::size_t>(part));
}
static_assert(ToPart(storage::LatestKind::kAgentInfo) == Part::kAgentInfo &&
              ToPart(storage::LatestKind::kUiCapabilities) == Part::kUiCapabilities &&
              ToPart(storage::LivePart::kMotion) == Part::kMotion &&
              static_cast<std::size_t>(Part::kUncrew) + 1 == kParts);

/// Which parts a reader wants. A value.
class PartSet {
 public:
  constexpr PartSet() = default;

  [[nodiscard]] static PartSet All() {
    PartSet set;
    set.bits_.set();
    return set;
  }
  /// What a list carries by default.
  [[nodiscard]] static PartSet OfLists() {
    PartSet set;
    set.Add(Part::kMotion);
    set.Add(Part::kStatus);
    return set;
  }

  void Add(Part part) { bits_.set(static_cast<std::size_t>(part)); }
  [[nodiscard]] bool Has(Part part) const { return bits_.test(static_cast<std::size_t>(part)); }

  /// Whether one of them is only in the store.
  [[nodiscard]] bool AnyStored() const;
  /// Whether one of them is in the robot's live state.
  [[nodiscard]] bool AnyLive() const;
  /// Whether one of them is live and large: many items, by key or joint.
  [[nodiscard]] bool AnyLarge() const;

  /// Below 2 to the power of kParts, and another one for each set.
  [[nodiscard]] std::size_t number() const { return bits_.to_ulong(); }

  friend bool operator==(const PartSet&, const PartSet&) = default;

 private:
  /// Whether one of the `count` parts from `first` on is wanted.
  [[nodiscard]] bool AnyOf(std::size_t first, std::size_t count) const;

  std::bitset<kParts> bits_;
};

/// The part with this name in requests (`motion`, `uiCapabilities`), or nothing.
[[nodiscard]] std::optional<Part> PartFromText(std::string_view text);

/// About how many bytes a copy of the large parts takes: the keyed ones, a status and the joints.
/// Pure; any thread.
[[nodiscard]] std::size_t KeyedBytes(const robot::LiveParts& parts);

}  // namespace uplink::view
