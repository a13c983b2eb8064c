#pragma once

#include <absl/status/statusor.h>

#include "schema/nexus_command/command.h"
#include "server/forward/item.h"
#include "storage/shared_items.h"

// The frames that forwarding sends, serialized once for all receivers.
namespace uplink::forward {

[[nodiscard]] EncodedFrame SnapshotBegin();
[[nodiscard]] EncodedFrame SnapshotEnd();
/// The item as the others get it.
///
/// Errors: what the store holds is no shape or object: the message says of which item.
[[nodiscard]] absl::StatusOr<EncodedFrame> UpsertFrame(const storage::SharedItem& item,
                                                       const nexus_command::CommandId& command);
/// What the frame of the item has at least, without making it: a position of its geometry is two
/// numbers of eight bytes.
[[nodiscard]] std::size_t LeastFrameBytes(const storage::SharedItem& item);
/// The item is there no more.
[[nodiscard]] EncodedFrame DeleteFrame(const ItemKey& key, const nexus_command::CommandId& command);

}  // namespace uplink::forward
