#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "tools/uplink-fleet/run/run_options.h"

namespace CLI {
class App;
}

namespace uplink::synthetic {

/// The flags of twins behind a broker. The application writes into it when it reads the command
/// line, so it stays where it is until then.
class TwinFlags {
 public:
  explicit TwinFlags(CLI::App& app);
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
