#include "schema/json/text.h"

#include <utility>
#include <variant>

#include "schema/json/geojson.h"
#include "schema/json/render.h"

namespace uplink::json {
namespace {

/// Null if there is none of that name.
boost::json::value MemberIn(std::string_view text, std::string_view name) {
  boost::json::error_code error;
  boost::json::value body =
      boost::json::parse(boost::json::string_view(text.data(), text.size()), error);
  if (error || !body.is_object()) return nullptr;
  boost::json::value* value =
      body.get_object().if_contains(boost::json::string_view(name.data(), name.size()));
  return value == nullptr ? boost::json::value() : std::move(*value);
}

}  // namespace

std::string ArrayText(std::span<const std::string> texts) {
  return boost::json::serialize(boost::json::array(texts.begin(), texts.end()));
}

std::string DetailText(const model::EventKind& kind) {
  if (const auto* named = std::get_if<model::NamedEvent>(&kind)) return named->detail_json;
  return boost::json::serialize(RenderDetail(kind));
}

std::string Text(const model::MissionRunStatus& body) {
  return boost::json::serialize(Render(body));
}

std::string Text(const model::UiCapabilities& body) { return boost::json::serialize(Render(body)); }

std::string Text(const model::CurrentSettings& body) {
  return boost::json::serialize(RenderByKey(body));
}

std::string Text(const model::AgentInfo& body) { return boost::json::serialize(Render(body)); }

std::string Text(const model::Pose& pose) { return boost::json::serialize(Render(pose)); }

std::string Text(const model::Trajectory& trajectory) {
  return boost::json::serialize(Render(trajectory));
}

std::string Text(const model::RcanState& state, std::string_view ruri) {
  return boost::json::serialize(Render(state, ruri));
}

std::string TextsText(const std::map<std::string, std::string>& texts) {
  boost::json::object object;
  for (const auto& [name, text] : texts) object[name] = text;
  return boost::json::serialize(object);
}

std::map<std::string, std::string> TextsIn(std::string_view text) {
  std::map<std::string, std::string> texts;
  boost::json::error_code error;
  const boost::json::value body =
      boost::json::parse(boost::json::string_view(text.data(), text.size()), error);
  if (error || !body.is_object()) return texts;
  for (const auto& member : body.get_object()) {
    if (!member.value().is_string()) continue;
    const boost::json::string& value = member.value().get_string();
    const auto name = member.key();
    texts.emplace(std::string(name.data(), name.size()), std::string(value.data(), value.size()));
  }
  return texts;
}

std::optional<double> NumberIn(std::string_view text, std::string_view name) {
  const boost::json::value value = MemberIn(text, name);
  if (!value.is_number()) return std::nullopt;
  return value.to_number<double>();
}

std::optional<std::string> StringIn(std::string_view text, std::string_view name) {
  const boost::json::value value = MemberIn(text, name);
  if (!value.is_string()) return std::nullopt;
  return std::string(value.get_string());
}

std::string GeometryText(const model::ShapeData& data) {
  return boost::json::serialize(RenderGeometry(data));
}

}  // namespace uplink::json
