#include "schema/nexus_command/decode.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

#include <absl/status/status.h>
#include <fmt/format.h>

#include "schema/decode/message.h"
#include "schema/decode/spatial.h"
#include "schema/limits.h"
#include "schema/nexus_command.capnp.h"

namespace uplink::nexus_command {
namespace {

using schema::Path;
using schema::Violations;
using What = decltype(Command::what);

/// What a FeatureOp may hold.
using FeatureOp = std::variant<Shape, model::Deletion>;

absl::Status NoCommand(std::string_view why) {
  return absl::InvalidArgumentError(fmt::format("not a command that is sent: {}", why));
}

Shape DecodeFeature(wire::SpatialFeature::Reader in, const Path& path, Violations& violations) {
  if (!in.isShape()) {
    violations.Content(UnknownVariant(path, static_cast<unsigned>(in.which())));
    return {};
  }
  const Path shape = path.Field("shape");
  if (!in.hasShape()) {
    violations.Content(MissingField(shape, "is a null pointer"));
    return {};
  }
  return schema::DecodeArea<Shape>(in.getShape(), shape, violations);
}

What DecodeFeatureOp(wire::FeatureOp::Reader in, Violations& violations) {
  auto op = schema::DecodeOp<FeatureOp>(in, violations, DecodeFeature);
  if (auto* const deletion = std::get_if<model::Deletion>(&op)) {
    return ShapeDeletion{std::move(deletion->id)};
  }
  return std::get<Shape>(std::move(op));
}

What DecodeObjectOp(wire::ObjectOp::Reader in, Violations& violations) {
  model::ObjectOp op = schema::DecodeObject(in, violations);
  if (auto* const deletion = std::get_if<model::Deletion>(&op.op)) {
    return ObjectDeletion{std::move(deletion->id)};
  }
  return std::get<model::Object>(std::move(op.op));
}

absl::StatusOr<What> DecodeWhat(wire::InternalCommand::Reader in) {
  // As in a durable message: any violation is an error.
  Violations violations({.durable = true, .texts = schema::TextForm::kAsForwarded});
  What what;
  if (in.isFeature()) {
    if (!in.hasFeature()) return NoCommand("feature is a null pointer");
    what = DecodeFeatureOp(in.getFeature(), violations);
  } else if (in.isObject()) {
    if (!in.hasObject()) return NoCommand("object is a null pointer");
    what = DecodeObjectOp(in.getObject(), violations);
  } else {
    return NoCommand(fmt::format("it holds union member {}, neither feature (8) nor object (9)",
                                 static_cast<unsigned>(in.which())));
  }
  if (violations.rejected()) {
    const model::Rejection rejection = violations.TakeRejection();
    return NoCommand(fmt::format("{}: {}", rejection.field, rejection.detail));
  }
  return what;
}

absl::StatusOr<Command> DecodeRoot(wire::NexusCommand::Reader in) {
  Command command;
  const auto id = in.getId();
  if (id.size() != command.id.size()) {
    return NoCommand(fmt::format("its id has {} bytes, not {}", id.size(), command.id.size()));
  }
  std::copy(id.begin(), id.end(), command.id.begin());
  if (!in.hasCommand()) return NoCommand("command is a null pointer");
  absl::StatusOr<What> what = DecodeWhat(in.getCommand());
  if (!what.ok()) return what.status();
  command.what = *std::move(what);
  return command;
}

}  // namespace

absl::StatusOr<Command> Decode(std::string_view bytes) {
  if (bytes.size() > schema::kCommandBytesMax) {
    return NoCommand(
        fmt::format("it has {} bytes, more than {}", bytes.size(), schema::kCommandBytesMax));
  }
  const std::string_view framing_error =
      schema::FramingError(std::as_bytes(std::span(bytes.data(), bytes.size())));
  if (!framing_error.empty()) return NoCommand(framing_error);
  auto words = kj::heapArray<capnp::word>(bytes.size() / schema::kWordBytes);
  std::memcpy(words.begin(), bytes.data(), bytes.size());
  const auto read = [&](capnp::FlatArrayMessageReader& reader) -> absl::StatusOr<Command> {
    const auto root = reader.getRoot<wire::NexusCommand>();
    if (reader.getEnd() != words.end()) return NoCommand("bytes follow the message");
    return DecodeRoot(root);
  };
  return schema::ReadMessage(words.asPtr(), read, NoCommand);
}

}  // namespace uplink::nexus_command
