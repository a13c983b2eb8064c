#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "schema/base/check.h"
#include "schema/base/utf8.h"
#include "schema/limits.h"
#include "schema/nexus_command/decode.h"
#include "schema/nexus_command/encode.h"

namespace {

namespace nexus = uplink::nexus_command;
namespace model = uplink::model;

/// A forwarded id as the two parts that it is made of.
struct Parts {
  std::string id;
  std::string origin;
};

Parts PartsOf(const std::string& forwarded) {
  const std::size_t at = forwarded.find('@');
  return {.id = forwarded.substr(0, at), .origin = forwarded.substr(at + 1)};
}

/// Encodes a command again, whose forwarded id has two parts; one overload per kind.
struct Encoder {
  const nexus::CommandId& command;

  std::string operator()(const nexus::Shape& shape) const {
    const Parts parts = PartsOf(shape.identity.id);
    const auto role = static_cast<std::uint16_t>(shape.area_type) - model::kReportedRoleOffset;
    model::ReportedShape reported{.identity = shape.identity,
                                  .data = shape.data,
                                  .area_type = static_cast<model::ReportedLayerRole>(role),
                                  .scope = shape.scope,
                                  .min_z_m = shape.min_z_m,
                                  .max_z_m = shape.max_z_m,
                                  .level_id = shape.level_id};
    reported.identity.id = parts.id;
    return nexus::EncodeUpsert(command, reported, parts.origin);
  }
  std::string operator()(model::Object object) const {
    const Parts parts = PartsOf(object.id);
    object.id = parts.id;
    return nexus::EncodeUpsert(command, object, parts.origin);
  }
  std::string operator()(const nexus::ShapeDeletion& deletion) const {
    return Delete(nexus::ItemKind::kShape, deletion.id);
  }
  std::string operator()(const nexus::ObjectDeletion& deletion) const {
    return Delete(nexus::ItemKind::kObject, deletion.id);
  }

 private:
  [[nodiscard]] std::string Delete(nexus::ItemKind kind, const std::string& forwarded) const {
    const Parts parts = PartsOf(forwarded);
    return nexus::EncodeDelete(command, kind, parts.id, parts.origin);
  }
};

const std::string& IdOf(const nexus::Command& command) {
  if (const auto* shape = std::get_if<nexus::Shape>(&command.what)) return shape->identity.id;
  if (const auto* object = std::get_if<model::Object>(&command.what)) return object->id;
  if (const auto* shape = std::get_if<nexus::ShapeDeletion>(&command.what)) return shape->id;
  return std::get<nexus::ObjectDeletion>(command.what).id;
}

/// True for what our encoder may have made: an id at an origin, and a role that is reported.
bool IsOurs(const nexus::Command& command) {
  if (IdOf(command).find('@') == std::string::npos) return false;
  const auto* const shape = std::get_if<nexus::Shape>(&command.what);
  return shape == nullptr || shape->area_type >= model::LayerRole::kCoverage;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto first = nexus::Decode({reinterpret_cast<const char*>(data), size});
  if (!first.ok()) {
    UPLINK_CHECK(
        uplink::IsCleanUtf8({first.status().message().data(), first.status().message().size()}),
        "an error is text");
    return 0;
  }
  if (!IsOurs(*first)) return 0;
  const std::string encoded = std::visit(Encoder{first->id}, first->what);
  // Shared pointers let a message hold more than its bytes.
  if (encoded.size() > uplink::schema::kCommandBytesMax) return 0;
  const auto second = nexus::Decode(encoded);
  UPLINK_CHECK(second.ok(), "a good command stays good");
  UPLINK_CHECK(*second == *first, "a good command stays the same");
  return 0;
}
