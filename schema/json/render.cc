#include "schema/json/render.h"

#include <variant>

#include "schema/json/fields.h"

namespace uplink::json {

boost::json::object RenderBody(const model::Body& body) {
  const std::string_view name = model::ToText(model::VariantOf(body));
  return std::visit(
      [name](const auto& member) { return Fields().Set(name, Render(member)).Take(); }, body);
}

}  // namespace uplink::json
