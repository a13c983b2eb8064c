#include <variant>

#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::json {

boost::json::value Render(const model::Value& value) {
  if (const auto* name = std::get_if<model::EnumName>(&value)) return Json(name->name);
  if (const auto* text = std::get_if<std::string>(&value)) return Json(*text);
  if (const auto* number = std::get_if<std::int32_t>(&value)) return Json(*number);
  if (const auto* number = std::get_if<double>(&value)) return Json(*number);
  return Json(std::get<bool>(value));
}

}  // namespace uplink::json
