#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "schema/model/spatial.h"
#include "schema/nexus_command/command.h"

/// One serialized NexusCommand: standard stream framing, not packed, as an UplinkMsg comes in. Of a
/// shape or an object everything is kept as it was reported, but the id, which becomes the
/// forwarded one. They judge nothing. Pure; any thread.
namespace uplink::nexus_command {

/// `feature.upsert.shape`. A shape's expiry is not said: when it comes, send EncodeDelete.
[[nodiscard]] std::string EncodeUpsert(const CommandId& command, const model::ReportedShape& shape,
                                       std::string_view origin_ruri);
/// `object.upsert`, with the object's expiry.
[[nodiscard]] std::string EncodeUpsert(const CommandId& command, const model::Object& object,
                                       std::string_view origin_ruri);

enum class ItemKind : std::uint8_t { kShape, kObject };

/// `feature.delete` or `object.delete`. `id` is the one by which the origin knows the item.
[[nodiscard]] std::string EncodeDelete(const CommandId& command, ItemKind kind, std::string_view id,
                                       std::string_view origin_ruri);

}  // namespace uplink::nexus_command
