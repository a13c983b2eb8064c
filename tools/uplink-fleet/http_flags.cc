#include "tools/uplink-fleet/http_flags.h"

#include <cstddef>
#include <cstdio>

#include <absl/status/status.h>
#include <fmt/core.h>

#include "tools/uplinkctl/ask/server_url.h"

namespace uplink::synthetic {
namespace {

/// As uplinkctl takes it; a HOST:PORT alone is asked by http.
absl::StatusOr<ctl::ServerUrl> ServerOf(const std::string& text) {
  const bool is_url = text.find("://") != std::string::npos || text.starts_with("unix:");
  if (const std::string problem = is_url ? "" : IsAddress().problem(text); !problem.empty()) {
    return absl::InvalidArgumentError(problem);
  }
  absl::StatusOr<ctl::ServerUrl> url =
      ctl::ParseServerUrl(is_url ? text : "http://" + text, "the URL");
  if (url.ok() && !url->prefix.empty()) {
    return absl::InvalidArgumentError("\"" + text + "\" has a path, which is not asked for");
  }
  return url;
}

config::FlagForm IsServer() {
  return {"HOST:PORT|URL",
          [](const std::string& text) { return std::string(ServerOf(text).status().message()); }};
}

}  // namespace

config::FlagForm IsAddress() {
  return {"HOST:PORT", [](const std::string& text) {
            const std::size_t colon = text.rfind(':');
            const bool good = colon != std::string::npos && colon > 0 && colon + 1 < text.size() &&
                              text.find_first_not_of("0123456789", colon + 1) == std::string::npos;
            return good ? std::string() : "\"" + text + "\" is not HOST:PORT";
          }};
}

HttpFlags::HttpFlags(config::Flags& flags) {
  flags.Add({"--http",
             "The server's HTTP listener, for the comparison: HOST:PORT, https://HOST:PORT or "
             "unix:/PATH"},
            server_, IsServer());
  flags.Add({"--http-ca", "Authorities of an https server (without it the system's)"},
            files_.ca_file);
  flags.Add({"--http-token-file", "A file whose first line is a token of a viewer of all fleets"},
            files_.token_file);
}

absl::StatusOr<link::HttpServer> HttpFlags::Read() const {
  const absl::StatusOr<ctl::ServerUrl> url = ServerOf(server_);
  if (!url.ok()) return url.status();
  if (!url->tls && !files_.ca_file.empty()) {
    return absl::InvalidArgumentError("--http-ca: it is for https://");
  }
  absl::StatusOr<link::HttpServer> server = ctl::ServerWith(*url, files_, "");
  if (server.ok() && ctl::ShowsToken(*server)) {
    fmt::print(stderr,
               "uplink-fleet: the network can read the token on its way; is there https?\n");
  }
  return server;
}

}  // namespace uplink::synthetic
