#include "schema/model/cyberwave/head.h"

#include <array>

namespace uplink::model::cyberwave {
namespace {

constexpr std::array kWords = {
    SourceType::kEdge, SourceType::kEdgeLeader, SourceType::kEdgeFollower, SourceType::kTele,
    SourceType::kSim,  SourceType::kSimTele,    SourceType::kEdit,         SourceType::kPreview};

}  // namespace

std::string_view ToText(SourceType type) {
  switch (type) {
    case SourceType::kEdge:
      return "edge";
    case SourceType::kEdgeLeader:
      return "edge_leader";
    case SourceType::kEdgeFollower:
      return "edge_follower";
    case SourceType::kTele:
      return "tele";
    case SourceType::kSim:
      return "sim";
    case SourceType::kSimTele:
      return "sim_tele";
    case SourceType::kEdit:
      return "edit";
    case SourceType::kPreview:
      return "preview";
    case SourceType::kUnknown:
      return "";
  }
  return "";
}

SourceType SourceTypeFromText(std::string_view text) {
  for (const SourceType type : kWords) {
    if (ToText(type) == text) return type;
  }
  return SourceType::kUnknown;
}

}  // namespace uplink::model::cyberwave
