#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "server/config/flags.h"
#include "tools/link/http_client.h"
#include "tools/uplinkctl/ask/access.h"

namespace uplink::synthetic {

/// HOST:PORT.
[[nodiscard]] config::FlagForm IsAddress();

/// The flags that say which server is asked over HTTP, and what it is shown. Outlives the parsing.
class HttpFlags final {
 public:
  explicit HttpFlags(config::Flags& flags);
  HttpFlags(const HttpFlags&) = delete;
  HttpFlags& operator=(const HttpFlags&) = delete;

  /// Notes on standard error if the network can read the token.
  ///
  /// Errors: names the flag, or the file that cannot be used.
  [[nodiscard]] absl::StatusOr<link::HttpServer> Read() const;

 private:
  std::string server_ = "127.0.0.1:7480";
  ctl::AccessFiles files_;
};

}  // namespace uplink::synthetic
