#include "tests/simulation/rows.h"

#include <fmt/format.h>

namespace uplink::simulation {

std::optional<std::string> ComparePresence(const std::string& ruri,
                                           const std::vector<storage::PresenceRow>& rows,
                                           const std::vector<model::Presence>& changes) {
  if (rows.size() != changes.size()) {
    return fmt::format("{} has {} changes of presence, the book says {}", ruri, rows.size(),
                       changes.size());
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const model::Presence found = rows[rows.size() - 1 - i].presence;
    if (found == changes[i]) continue;
    return fmt::format("change {} of {} is {}, the book says {}", i + 1, ruri, ToText(found),
                       ToText(changes[i]));
  }
  return std::nullopt;
}

}  // namespace uplink::simulation
