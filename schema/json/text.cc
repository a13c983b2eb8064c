#include "schema/json/text.h"

#include "schema/json/geojson.h"
#include "schema/json/render.h"

namespace uplink::json {

std::string DetailText(const model::EventKind& kind) {
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

std::string GeometryText(const model::ShapeData& data) {
  return boost::json::serialize(RenderGeometry(data));
}

}  // namespace uplink::json
