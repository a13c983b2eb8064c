#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace uplink::view {

/// The live parts that a Robot can carry, in the order of the contract.
enum class Part : std::uint8_t {
  kMotion,
  kStatus,
  kExtras,
  kHealth,
  kUsage,
  kConsumables,
  kDirectives,
  kAgentInfo,
  kSettings,
  kUiCapabilities,
  kRcanState,
};
inline constexpr std::size_t kParts = 11;

/// Which parts a reader wants. A value.
class PartSet {
 public:
  constexpr PartSet() = default;

  [[nodiscard]] static PartSet All() {
    PartSet set;
    set.bits_.set();
    return set;
  }
  /// What a list carries unless it is asked for others.
  [[nodiscard]] static PartSet OfLists() {
    PartSet set;
    set.Add(Part::kMotion);
    set.Add(Part::kStatus);
    return set;
  }

  void Add(Part part) { bits_.set(static_cast<std::size_t>(part)); }
  [[nodiscard]] bool Has(Part part) const { return bits_.test(static_cast<std::size_t>(part)); }

  /// Whether one of them lies in the robot's live state.
  [[nodiscard]] bool AnyLive() const { return (bits_ & ~StoredBits()).any(); }
  /// A part that holds many items, by key.
  [[nodiscard]] bool AnyKeyed() const {
    return Has(Part::kExtras) || Has(Part::kHealth) || Has(Part::kConsumables) ||
           Has(Part::kDirectives) || Has(Part::kRcanState);
  }

  friend bool operator==(const PartSet&, const PartSet&) = default;

 private:
  /// The parts of which the store keeps a robot's latest.
  [[nodiscard]] static std::bitset<kParts> StoredBits() {
    PartSet stored;
    stored.Add(Part::kAgentInfo);
    stored.Add(Part::kSettings);
    stored.Add(Part::kUiCapabilities);
    return stored.bits_;
  }

  std::bitset<kParts> bits_;
};

/// The part that requests spell so (`motion`, `uiCapabilities`), or nothing.
[[nodiscard]] std::optional<Part> PartFromText(std::string_view text);

}  // namespace uplink::view
