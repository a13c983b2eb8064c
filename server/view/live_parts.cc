#include "server/view/live_parts.h"

#include <optional>
#include <string>

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include "schema/base/check.h"
#include "schema/json/fields.h"
#include "schema/json/render.h"
#include "server/view/struct.h"

namespace uplink::view {
namespace {

using json::Fields;
using json::Render;

boost::json::object RenderItem(const robot::Extra& extra) {
  return Fields().Set("value", Render(extra.value)).Set("sampledAtMs", extra.sampled_at_ms).Take();
}

template <typename Message>
boost::json::object RenderItem(const Message& message) {
  return Render(message);
}

// One overload for each way in which a part is held; nothing if it was never reported.
template <typename Message>
std::optional<boost::json::object> RenderPart(const std::optional<Message>& part,
                                              const std::string& /*ruri*/) {
  if (!part) return std::nullopt;
  return Render(*part);
}

/// What the robot said, and the server's own count of what it left out.
std::optional<boost::json::object> RenderPart(const std::optional<model::RcanState>& part,
                                              const std::string& ruri) {
  if (!part) return std::nullopt;
  boost::json::object fields = Render(*part, ruri);
  fields["seq_missing"] = part->seq_missing;
  return fields;
}

/// Key to rendered value.
template <typename Value, std::size_t kMax>
std::optional<boost::json::object> RenderPart(const robot::LatestByKey<Value, kMax>& part,
                                              const std::string& /*ruri*/) {
  if (part.items().empty()) return std::nullopt;
  Fields fields;
  for (const auto& [key, value] : part.items()) fields.Set(key, RenderItem(value));
  return fields.Take();
}

/// Sets the field of that JSON name, which is a Struct.
void SetField(std::string_view name, const boost::json::object& value, v1::Robot& robot) {
  const google::protobuf::FieldDescriptor* field =
      v1::Robot::descriptor()->FindFieldByCamelcaseName(std::string(name));
  UPLINK_CHECK(field != nullptr && field->message_type() == google::protobuf::Struct::descriptor(),
               "every live part has its field in v1::Robot");
  auto* const message = v1::Robot::GetReflection()->MutableMessage(&robot, field);
  static_cast<google::protobuf::Struct&>(*message) = ToStruct(value);
}

}  // namespace

void SetLiveParts(const robot::LiveParts& live, const PartSet& wanted, v1::Robot& robot) {
  robot::ForEachPart(
      [&]<typename Tag>(Tag /*row*/, const auto& part) {
        if (!wanted.Has(ToPart(Tag::kLivePart))) return;
        const std::optional<boost::json::object> value = RenderPart(part, robot.ruri());
        if (value) SetField(storage::RowOf(Tag::kLivePart).view, *value, robot);
      },
      live);
}

}  // namespace uplink::view
