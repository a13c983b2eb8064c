#pragma once

#include <cstddef>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "tools/link/http_client.h"
#include "tools/uplinkctl/ask/server_url.h"

namespace uplink::ctl {

/// Files by which a server is believed, and by which it learns who asks; each may be empty. A
/// value.
struct AccessFiles {
  /// Authorities of the server's certificate; empty: those of the system.
  std::string ca_file = {};
  /// An operator's certificate and its key; both or none.
  std::string certificate_file = {};
  std::string key_file = {};
  /// Its first line is a token.
  std::string token_file = {};

  friend bool operator==(const AccessFiles&, const AccessFiles&) = default;
};

/// Bytes of the largest file with a token.
inline constexpr std::size_t kTokenFileBytesMax = std::size_t{4} * 1024;

/// kInvalidArgument for files that mean nothing at that URL, and for one of a pair alone.
[[nodiscard]] absl::Status CheckAccess(const ServerUrl& url, const AccessFiles& files);

/// The first line of a file that only its owner, and at most its group, may read.
///
/// Errors: kInvalidArgument names the file and what to do; no error repeats the line.
[[nodiscard]] absl::StatusOr<std::string> ReadToken(const std::string& path);

/// A server with what the files hold. `server_certificate_file` is the one that the server's own
/// configuration names; empty: authorities decide.
///
/// Errors: those of CheckAccess and ReadToken; kInvalidArgument for a file that cannot be read, or
///         holds something else.
/// Thread: any; blocks on files.
[[nodiscard]] absl::StatusOr<link::HttpServer> ServerWith(
    const ServerUrl& url, const AccessFiles& files, const std::string& server_certificate_file);

/// A server that is asked for its health and is shown nothing, so any certificate will do: one that
/// has expired does not make it dead.
[[nodiscard]] absl::StatusOr<link::HttpServer> ServerToProbe(const ServerUrl& url);

/// Whether a token goes to another machine where the network can read it.
[[nodiscard]] bool ShowsToken(const link::HttpServer& server);

}  // namespace uplink::ctl
