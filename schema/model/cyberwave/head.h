#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// What Cyberwave's messages have in common. Its words are those of the vendor's topic page.
namespace uplink::model::cyberwave {

/// What a message says of itself by `source_type`.
enum class SourceType : std::uint8_t {
  kEdge,
  kEdgeLeader,
  kEdgeFollower,
  kTele,
  kSim,
  kSimTele,
  kEdit,
  /// Retired by the vendor; still a command.
  kPreview,
  /// A word that we do not know: taken as the edge's.
  kUnknown,
};

/// The vendor's word; empty for kUnknown.
[[nodiscard]] std::string_view ToText(SourceType type);
/// The type of that word; kUnknown for any other.
[[nodiscard]] SourceType SourceTypeFromText(std::string_view text);

/// True for what says how a robot is; false for what says how somebody wants it to be.
[[nodiscard]] constexpr bool IsState(SourceType type) {
  switch (type) {
    case SourceType::kEdge:
    case SourceType::kEdgeLeader:
    case SourceType::kEdgeFollower:
    case SourceType::kSim:
    case SourceType::kUnknown:
      return true;
    case SourceType::kTele:
    case SourceType::kSimTele:
    case SourceType::kEdit:
    case SourceType::kPreview:
      return false;
  }
  return false;
}

/// True for what belongs to the simulated robot beside the twin's real one.
[[nodiscard]] constexpr bool IsSimulated(SourceType type) {
  return type == SourceType::kSim || type == SourceType::kSimTele;
}

/// Who speaks. A value.
struct Source {
  SourceType type = SourceType::kEdge;
  /// As the message spells it, also if unknown; empty if it says nothing, and `type` is then what
  /// its session makes it.
  std::string text;

  friend bool operator==(const Source&, const Source&) = default;
};

/// What every message may carry. A value.
struct Head {
  Source source;
  /// The publisher's own id of its client, or of a group of updates; empty if it gives none.
  std::string session_id;
  /// Microseconds since the Unix epoch, by the publisher's clock; 0: not known.
  std::int64_t timestamp_us = 0;

  friend bool operator==(const Head&, const Head&) = default;
};

}  // namespace uplink::model::cyberwave
