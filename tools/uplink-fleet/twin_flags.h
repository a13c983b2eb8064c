#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "server/config/flags.h"
#include "tools/uplink-fleet/run/run_options.h"

namespace uplink::synthetic {

/// The flags of twins behind a broker. Flags::Parse writes into it, so it stays where it is until
/// then.
class TwinFlags {
 public:
  explicit TwinFlags(config::Flags& flags);
  TwinFlags(const TwinFlags&) = delete;
  TwinFlags& operator=(const TwinFlags&) = delete;

  /// For so many twins; nothing: the run has none.
  ///
  /// Errors: kInvalidArgument, beginning with the flag: no URL of a broker, TLS without who vouches
  ///         for the broker, a prefix that no topic has, a file without a password.
  [[nodiscard]] absl::StatusOr<std::optional<TwinSwarmOptions>> Read(std::size_t twins) const;

 private:
  std::string url_;
  std::string password_file_;
  TwinSwarmOptions options_;
};

}  // namespace uplink::synthetic
