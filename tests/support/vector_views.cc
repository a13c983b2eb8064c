#include "tests/support/vector_views.h"

#include <array>
#include <cstdlib>
#include <ctime>
#include <utility>

#include "schema/base/check.h"
#include "tests/support/exact_json.h"

namespace uplink::test {
namespace {

using boost::json::array;
using boost::json::object;
using boost::json::value;

std::string TextOf(const value& text) { return {text.as_string().data(), text.as_string().size()}; }

std::string Encoded(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<std::uint8_t>(c);
    encoded += '%';
    encoded += kDigits[byte >> 4U];
    encoded += kDigits[byte & 0xFU];
  }
  return encoded;
}

constexpr std::int64_t kMsPerSecond = 1000;

/// Unix milliseconds as proto3's JSON has a time.
std::string TimeText(std::int64_t ms) {
  const std::time_t second = ms / kMsPerSecond;
  std::tm parts{};
  gmtime_r(&second, &parts);
  std::array<char, 64> text{};
  std::string shown(text.data(),
                    std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts));
  if (ms % kMsPerSecond == 0) return shown + "Z";
  const std::string fraction = std::to_string(ms % kMsPerSecond);
  return shown + "." + std::string(3 - fraction.size(), '0') + fraction + "Z";
}

/// A row that repeats members of the vector and names its robot.
class Row {
 public:
  Row(const std::string& ruri, const object& from) : from_(from) { row_["ruri"] = ruri; }

  Row& Same(std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) Set(name, from_.at(Key(name)));
    return *this;
  }
  /// A time of the vector; 0 is none.
  Row& Time(std::string_view name, std::string_view of) {
    const auto ms = static_cast<std::int64_t>(from_.at(Key(of)).as_double());
    return ms == 0 ? *this : Set(name, value(TimeText(ms)));
  }
  Row& Set(std::string_view name, value member) {
    row_[Key(name)] = std::move(member);
    return *this;
  }
  [[nodiscard]] object Take() { return std::move(row_); }

 private:
  static boost::json::string_view Key(std::string_view name) { return {name.data(), name.size()}; }

  const object& from_;
  object row_;
};

/// Builds the views of one vector's body.
struct Views {
  std::string ruri;
  std::vector<VectorView> views;

  [[nodiscard]] std::string RobotTarget() const { return "/api/v1/robots/" + Encoded(ruri); }
  [[nodiscard]] std::string ListTarget(const std::string& list) const {
    return "/api/v1/" + list + "?ruri=" + Encoded(ruri);
  }
  /// What the robot itself carries; an empty name: no part.
  void Part(std::string_view name, value part) {
    object row;
    if (!name.empty()) row[boost::json::string_view(name.data(), name.size())] = std::move(part);
    views.push_back({RobotTarget(), "", std::move(row), {}});
  }
  void PartByKey(std::string_view name, const std::string& key, const object& body) {
    Part(name, object{{key, body}});
  }
};

void AddExtras(const object& body, Views& out) {
  object extras;
  for (const value& reading : body.at("kv").as_array()) {
    const object& fields = reading.as_object();
    const value* own = fields.if_contains("unixTimeMs");
    const value& sampled = own != nullptr ? *own : body.at("unixTimeMs");
    object shown{{"value", fields.at("value")}};
    const auto ms = static_cast<std::int64_t>(sampled.as_double());
    if (ms != 0) shown["sampledAt"] = TimeText(ms);
    extras[fields.at("key").as_string()] = std::move(shown);
  }
  out.Part(extras.empty() ? "" : "extras", extras);
}

void AddSettings(const array& body, Views& out) {
  object settings;
  for (const value& update : body) {
    settings[update.as_object().at("key").as_string()] = update.as_object().at("value");
  }
  out.Part("settings", settings);
}

void AddFault(const object& body, Views& out) {
  const object row = Row(out.ruri, body)
                         .Same({"faultId", "source", "severity", "active", "category",
                                "description", "suggestedAction"})
                         .Time("sampledAt", "unixTimeMs")
                         .Take();
  object report = row;
  out.views.push_back({out.ListTarget("faults"), "faults", report, {"receivedAt"}});
  VectorView active{out.ListTarget("faults") + "&active=true", "faults", {}, {}};
  if (body.at("active").as_bool()) {
    active.row = row;
    active.times = {"receivedAt", "raisedAt"};
  }
  out.views.push_back(active);
}

void AddEvent(const object& body, Views& out) {
  const auto& [kind, detail] = *body.at("kind").as_object().begin();
  out.views.push_back({out.ListTarget("events"),
                       "events",
                       Row(out.ruri, body)
                           .Set("kind", value(kind))
                           .Set("detail", detail.is_null() ? value(object()) : detail)
                           .Time("sampledAt", "unixTimeMs")
                           .Take(),
                       {"receivedAt"}});
}

void AddMessage(const object& body, Views& out) {
  out.views.push_back(
      {out.ListTarget("messages"),
       "messages",
       Row(out.ruri, body).Same({"level", "message"}).Time("sampledAt", "unixTimeMs").Take(),
       {"receivedAt"}});
}

void AddMissionRun(const object& body, Views& out) {
  const value* name = body.if_contains("name");
  out.views.push_back({out.ListTarget("missions"),
                       "missions",
                       Row(out.ruri, body)
                           .Same({"missionId", "runId", "status"})
                           .Set("name", name != nullptr ? *name : value(""))
                           .Set("latest", body)
                           .Set("updates", "1")
                           .Set("closedWhy", "")
                           .Take(),
                       {"firstReceivedAt", "lastReceivedAt"}});
}

array Coordinates(const value& ring) {
  array coordinates;
  for (const value& point : ring.as_array()) {
    coordinates.push_back(array{point.as_object().at("lon"), point.as_object().at("lat")});
  }
  return coordinates;
}

/// The polygon of the vectors, whose rings are closed already.
object Polygon(const object& polygon) {
  array rings{Coordinates(polygon.at("exterior"))};
  for (const value& hole : polygon.at("holes").as_array()) rings.push_back(Coordinates(hole));
  return {{"type", "Polygon"}, {"coordinates", rings}};
}

void AddShape(const object& body, Views& out) {
  VectorView view{out.ListTarget("shapes"), "shapes", {}, {}};
  if (const value* found = body.if_contains("upsert")) {
    const object& shape = found->as_object();
    const object& identity = shape.at("identity").as_object();
    view.row = Row(out.ruri, shape)
                   .Same({"areaType", "scope", "minZM", "maxZM", "levelId"})
                   .Set("id", identity.at("id"))
                   .Set("name", identity.at("name"))
                   .Set("rev", identity.at("rev"))
                   .Set("hash", identity.at("hash"))
                   .Set("geometry", Polygon(shape.at("data").at("polygon").as_object()))
                   .Time("expiresAt", "expireTimeMs")
                   .Take();
    view.times = {"receivedAt"};
  }
  out.views.push_back(view);
}

void AddObject(const object& body, Views& out) {
  VectorView view{out.ListTarget("objects"), "objects", {}, {}};
  if (const value* found = body.if_contains("upsert")) {
    const object& tracked = found->as_object();
    view.row = Row(out.ruri, tracked)
                   .Same({"id", "name", "objectType", "scope", "location", "trajectory", "radiusM"})
                   .Time("sampledAt", "unixTimeMs")
                   .Time("expiresAt", "expiresUnixTimeMs")
                   .Take();
    view.times = {"receivedAt"};
  }
  out.views.push_back(view);
}

/// Kinds whose body a Robot carries as it is, or by the body's own key.
bool AddPart(std::string_view variant, const value& body, Views& out) {
  if (variant == "motionTelemetry") return out.Part("motion", body), true;
  if (variant == "statusTelemetry") return out.Part("status", body), true;
  if (variant == "usageTelemetry") return out.Part("usage", body), true;
  if (variant == "agentInfo") return out.Part("agentInfo", body), true;
  if (variant == "uiCapabilities") return out.Part("uiCapabilities", body), true;
  if (variant == "currentSettings") return AddSettings(body.as_array(), out), true;
  const object& fields = body.as_object();
  if (variant == "telemetryExtras") return AddExtras(fields, out), true;
  if (variant == "systemHealth") {
    return out.PartByKey("health", TextOf(fields.at("deviceId")), fields), true;
  }
  if (variant == "consumableStatus") {
    const std::string key = TextOf(fields.at("kind")) + "/" + TextOf(fields.at("tankId"));
    return out.PartByKey("consumables", key, fields), true;
  }
  if (variant == "spatialDirectiveStatus") {
    return out.PartByKey("directives", TextOf(fields.at("directiveId")), fields), true;
  }
  return false;
}

void AddRows(std::string_view variant, const object& body, Views& out) {
  if (variant == "fault") return AddFault(body, out);
  if (variant == "eventTelemetry") return AddEvent(body, out);
  if (variant == "message") return AddMessage(body, out);
  if (variant == "missionRunStatus") return AddMissionRun(body, out);
  if (variant == "shape") return AddShape(body, out);
  if (variant == "object") return AddObject(body, out);
  CheckFailed(__FILE__, __LINE__, "variant", "a vector of a variant that is not known");
}

bool IsTimeIn(const value* time, const TimeSpan& span) {
  if (time == nullptr || !time->is_string()) return false;
  const std::string text = TextOf(*time);
  std::tm parts{};
  const char* const fraction = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  if (fraction == nullptr) return false;
  std::int64_t ms = timegm(&parts) * kMsPerSecond;
  if (*fraction == '.') ms += static_cast<int>(std::strtol(fraction + 1, nullptr, 10));
  // The same time has one text: this says that nothing else stands in it.
  return TimeText(ms) == text && ms >= span.from_ms && ms <= span.to_ms;
}

/// A Robot's parts and nothing else of it.
object PartsOf(const object& robot) {
  object parts;
  for (const char* name : {"motion", "status", "extras", "health", "usage", "consumables",
                           "directives", "agentInfo", "settings", "uiCapabilities", "rcanState"}) {
    if (const value* part = robot.if_contains(name)) parts[name] = *part;
  }
  return parts;
}

std::string Compare(const object& expected, const object& actual) {
  if (expected == actual) return "";
  return "expected: " + boost::json::serialize(expected) +
         "\nactual:   " + boost::json::serialize(actual);
}

}  // namespace

std::vector<VectorView> ViewsOf(const std::string& ruri, std::string_view vector) {
  const std::optional<object> json = ParseExact(vector);
  UPLINK_CHECK(json && json->size() == 1, "a vector's JSON is one member");
  const auto& [key, body] = *json->begin();
  const std::string_view variant(key.data(), key.size());
  Views out{ruri, {}};
  if (AddPart(variant, body, out)) return out.views;
  AddRows(variant, body.as_object(), out);
  out.Part("", {});
  return out.views;
}

std::string RuriOfVector(std::string_view name) { return "rcan://vectors/" + std::string(name); }

std::string Difference(const VectorView& view, std::string_view answer, const TimeSpan& arrival) {
  const std::optional<object> json = ParseExact(answer);
  if (!json) return "no JSON object: " + std::string(answer);
  if (view.list.empty()) return Compare(*view.row, PartsOf(*json));
  const value* rows = json->if_contains(view.list);
  if (rows == nullptr || !rows->is_array()) return "no list: " + std::string(answer);
  if (rows->get_array().size() != (view.row ? 1 : 0)) return "rows: " + std::string(answer);
  if (!view.row) return "";
  object row = rows->get_array().front().as_object();
  for (const std::string& name : view.times) {
    if (!IsTimeIn(row.if_contains(name), arrival)) return name + ": " + std::string(answer);
    row.erase(name);
  }
  return Compare(*view.row, row);
}

}  // namespace uplink::test
