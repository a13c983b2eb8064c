#pragma once

#include <memory>
#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/log/logger.h"
#include "tools/link/http_client.h"

namespace uplink::ctl {

/// Takes commands of operators, and questions about them, where no server does: on the store
/// itself, which servers read when they start. It answers as the server would.
///
/// Thread: confined to one thread; blocks.
class StoreDesk final {
 public:
  /// The store of a server's configuration file.
  ///
  /// Errors: of the file and of the store; each names it.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<StoreDesk>> Open(const std::string& config);
  ~StoreDesk();
  StoreDesk(const StoreDesk&) = delete;
  StoreDesk& operator=(const StoreDesk&) = delete;

  /// The answer to `POST target` with this body, or to `GET target` if there is none; nothing where
  /// only a server can answer.
  [[nodiscard]] std::optional<link::HttpAnswer> Answer(const std::string& target,
                                                       const std::string* json);

 private:
  struct Parts;
  explicit StoreDesk(std::unique_ptr<Parts> parts);

  const std::unique_ptr<Parts> parts_;
};

}  // namespace uplink::ctl
