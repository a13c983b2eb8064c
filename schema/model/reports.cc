#include "schema/model/reports.h"

namespace uplink::model {

std::string_view EventKindText(const EventKind& kind) {
  if (const auto* named = std::get_if<NamedEvent>(&kind)) return named->kind;
  static constexpr std::array<std::string_view, std::variant_size_v<EventKind> - 1> kNames = {
      "estopEngaged",     "estopReleased", "modeChanged", "missionStarted",
      "missionCompleted", "faultRaised",   "faultCleared"};
  return kNames[kind.index()];
}

}  // namespace uplink::model
