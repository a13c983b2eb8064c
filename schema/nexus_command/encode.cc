#include "schema/nexus_command/encode.h"

#include <capnp/message.h>

#include "schema/encode/encode_body.h"
#include "schema/encode/spatial.h"
#include "schema/nexus_command.capnp.h"

namespace uplink::nexus_command {
namespace {

/// A command in the making.
class Draft final {
 public:
  explicit Draft(const CommandId& id) : command_(builder_.initRoot<wire::NexusCommand>()) {
    command_.setId({id.data(), id.size()});
  }

  [[nodiscard]] wire::InternalCommand::Builder Fill() { return command_.initCommand(); }
  [[nodiscard]] std::string Framed() { return schema::Framed(builder_); }

 private:
  capnp::MallocMessageBuilder builder_;
  wire::NexusCommand::Builder command_;
};

}  // namespace

std::string EncodeUpsert(const CommandId& command, const model::ReportedShape& shape,
                         std::string_view origin_ruri) {
  Draft draft(command);
  auto out = draft.Fill().initFeature().initUpsert().initShape();
  schema::EncodeArea(shape, ForwardedId(shape.identity.id, origin_ruri), out);
  out.setAreaType(schema::Enum<wire::LayerRole>(model::LayerRoleOf(shape.area_type)));
  return draft.Framed();
}

std::string EncodeUpsert(const CommandId& command, const model::Object& object,
                         std::string_view origin_ruri) {
  Draft draft(command);
  schema::EncodeObject(object, ForwardedId(object.id, origin_ruri),
                       draft.Fill().initObject().initUpsert());
  return draft.Framed();
}

std::string EncodeDelete(const CommandId& command, ItemKind kind, std::string_view id,
                         std::string_view origin_ruri) {
  Draft draft(command);
  const std::string forwarded = ForwardedId(id, origin_ruri);
  switch (kind) {
    case ItemKind::kShape:
      draft.Fill().initFeature().setDelete(schema::Text(forwarded));
      break;
    case ItemKind::kObject:
      draft.Fill().initObject().setDelete(schema::Text(forwarded));
      break;
  }
  return draft.Framed();
}

}  // namespace uplink::nexus_command
