#include "storage/postgres/tables/latest.h"

#include <variant>

#include "schema/base/check.h"
#include "schema/json/text.h"

namespace uplink::storage::postgres {

std::string LatestText(const model::Body& body) {
  if (const auto* info = std::get_if<model::AgentInfo>(&body)) return json::Text(*info);
  if (const auto* settings = std::get_if<model::CurrentSettings>(&body)) {
    return json::Text(*settings);
  }
  const auto* capabilities = std::get_if<model::UiCapabilities>(&body);
  UPLINK_CHECK(capabilities != nullptr, "a kind of which the latest is kept");
  return json::Text(*capabilities);
}

}  // namespace uplink::storage::postgres
