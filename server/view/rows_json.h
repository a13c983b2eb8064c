#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "server/view/json.h"
#include "server/view/messages.h"
#include "storage/reader.h"

namespace uplink::view {

/// A list of the store's rows, of any kind that messages.h maps. Errors and thread: as json.h.
template <typename Row>
[[nodiscard]] absl::StatusOr<std::string> ToJson(const storage::Page<Row>& page) {
  return PrintJson(ToMessage(page));
}

[[nodiscard]] inline absl::StatusOr<std::string> ToJson(const QuarantineView& quarantine) {
  return PrintJson(ToMessage(quarantine));
}

}  // namespace uplink::view
