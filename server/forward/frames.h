#pragma once

#include <absl/status/statusor.h>

#include "schema/nexus_command/command.h"
#include "server/forward/item.h"
#include "storage/shared_items.h"

// The frames that forwarding sends, serialized once for all receivers.
namespace uplink::forward {

[[nodiscard]] EncodedFrame SnapshotBegin();
[[nodiscard]] EncodedFrame SnapshotEnd();
/// The item as other robots get it.
///
/// Errors: the store's row is no shape or object: the message names the item.
[[nodiscard]] absl::StatusOr<EncodedFrame> UpsertFrame(const storage::SharedItem& item,
                                                       const nexus_command::CommandId& command);
/// The least size of the item's frame, without making it: a position of its geometry is two numbers
/// of eight bytes.
[[nodiscard]] std::size_t LeastFrameBytes(const storage::SharedItem& item);
/// The deletion of an item.
[[nodiscard]] EncodedFrame DeleteFrame(const ItemKey& key, const nexus_command::CommandId& command);

}  // namespace uplink::forward
