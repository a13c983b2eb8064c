#include <optional>
#include <utility>

#include "schema/cyberwave/families.h"
#include "schema/json/exact.h"
#include "schema/limits.h"
#include "schema/rules/describe.h"
#include "schema/rules/texts.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;
using model::cyberwave::EdgeHealth;
using model::cyberwave::EdgeStream;
using model::cyberwave::Uuid;
using schema::Path;
using schema::Violations;

constexpr std::string_view kTwin = "twin_uuid";

/// A message that names another twin than its topic rejects.
void CheckTwin(Reader& in, const Uuid& twin) {
  if (in.Find(kTwin) == nullptr) return;
  const std::string said = in.Text(kTwin, schema::kIdBytesMax, Need::kMust);
  if (in.violations().rejected()) return;
  if (Uuid::FromText(said) == twin) return;
  const Path field = in.path().Field(kTwin);
  const std::string own = twin.ToText();
  in.violations().Reject(schema::TopicMismatch(field, said, own));
}

/// The key of the message: an invalid one rejects.
std::string EdgeIdOf(Reader& in, const Uuid& twin) {
  for (const std::string_view name : {"edge_id", "edge_uuid"}) {
    if (in.Find(name) != nullptr) return in.Text(name, schema::kIdBytesMax, Need::kMust);
  }
  return twin.ToText();
}

EdgeStream StreamOf(Reader& in) {
  EdgeStream stream;
  stream.camera_id = in.Text("camera_id", schema::kIdBytesMax);
  stream.connection_state = in.Text("connection_state", schema::kNameBytesMax);
  stream.ice_connection_state = in.Text("ice_connection_state", schema::kNameBytesMax);
  stream.frames_sent = in.Count("frames_sent");
  stream.last_frame_us = in.TimeUs("last_frame_ts");
  stream.fps = in.NotNegative("fps");
  stream.uptime_s = in.NotNegative("uptime_seconds");
  stream.restart_count = in.Count("restart_count");
  stream.is_stale = in.Flag("is_stale");
  stream.is_healthy = in.Flag("is_healthy");
  return stream;
}

std::vector<EdgeStream> StreamsOf(Reader& in) {
  std::vector<EdgeStream> streams;
  const js::object* object = in.Object("streams", Need::kMay);
  if (object == nullptr) return streams;
  const Path path = in.path().Field("streams");
  Violations& violations = in.violations();
  if (object->size() > kStreamsMax) {
    violations.Reject(schema::TooManyItems(path, object->size(), kStreamsMax, "streams"));
    return streams;
  }
  for (const auto& member : *object) {
    if (member.value().is_null()) continue;
    const std::string_view id = FromBoost(member.key());
    const Path field = path.Key(id);
    const js::object* members = member.value().if_object();
    if (members == nullptr) {
      violations.Content(schema::TypeMismatch(field, json::KindOf(member.value()), "object"));
      continue;
    }
    if (id.empty()) {
      violations.Content(schema::MissingField(field, "has a stream without an id"));
      continue;
    }
    std::optional<std::string> kept = schema::Text(violations, field, id, schema::kIdBytesMax);
    if (!kept) continue;
    Reader stream(*members, field, violations);
    streams.push_back(StreamOf(stream));
    streams.back().id = *std::move(kept);
  }
  return streams;
}

}  // namespace

EdgeHealth ReadEdgeHealth(Reader& in, const Uuid& twin) {
  CheckTwin(in, twin);
  EdgeHealth health;
  health.edge_id = EdgeIdOf(in, twin);
  const bool older = in.Find("uptime_seconds") == nullptr;
  health.uptime_s = in.NotNegative(older ? "uptime" : "uptime_seconds");
  health.streams = StreamsOf(in);
  health.stream_count = in.Count("stream_count");
  health.healthy_streams = in.Count("healthy_streams");
  health.host_memory_percent = in.Percent("host_memory_percent");
  health.host_cpu_percent = in.Percent("host_cpu_percent");
  health.host_disk_percent = in.Percent("host_disk_percent");
  health.cpu_temp_c =
      in.NumberIn("cpu_temp_c", {.min = schema::kTemperatureCMin, .max = schema::kTemperatureCMax});
  const EdgeHealth empty = {.edge_id = health.edge_id};
  if (health == empty) in.violations().RejectIfAnyDropped();
  return health;
}

}  // namespace uplink::cyberwave
