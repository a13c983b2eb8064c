#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "storage/connection.h"

namespace uplink::robot {

/// Open connections of one robot whose certificates are remembered; the oldest goes first.
inline constexpr std::size_t kAgentConnectionsMax = 8;

/// What a robot's connections to this process say about its agent. Thread-safe.
class AgentFacts final {
 public:
  /// A value.
  struct View {
    /// Of the last connection that told one, which may have ended; empty: none did.
    std::string version;
    /// When the certificate of the connection that began last expires. Empty if none is open, or
    /// that one has no certificate.
    std::optional<SystemTime> certificate_not_after;
  };

  /// A connection has begun; its id is set.
  void Begin(const storage::ConnectionItem& item);
  void End(const storage::ConnectionId& id);
  [[nodiscard]] View Get() const;
  /// As View's.
  [[nodiscard]] std::optional<SystemTime> certificate_not_after() const;

 private:
  struct Open {
    storage::ConnectionId id{};
    std::optional<SystemTime> not_after;
  };

  mutable std::mutex mutex_;
  std::string version_;
  /// The one that began last is last.
  std::vector<Open> open_;
};

}  // namespace uplink::robot
