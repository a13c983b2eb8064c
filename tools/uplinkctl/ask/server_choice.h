#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "server/config/load.h"
#include "tools/uplinkctl/ask/access.h"
#include "tools/uplinkctl/ask/server_url.h"

namespace uplink::ctl {

/// Where a server answers unless something names another.
inline constexpr const char* kServerDefault = "http://127.0.0.1:7480";
/// The variable that names one.
inline constexpr const char* kServerVariable = "UPLINKCTL_SERVER";
/// The variable that names a file with a token.
inline constexpr const char* kTokenVariable = "UPLINKCTL_TOKEN_FILE";

/// What the flags of a verb name; at most one of the first three is set. A value.
struct ServerFlags {
  std::string server;
  std::string context;
  /// The server's configuration file, which says where it listens.
  std::string config;
  AccessFiles files = {};
};

/// What else names a server. A value.
struct ServerSources {
  /// What kServerVariable holds.
  std::string variable;
  /// The file of contexts.
  std::string contexts_file;
  /// Lies over the server's configuration file.
  config::Environment environment;
  /// What kTokenVariable holds.
  std::string token_file = {};
};
/// Of this process.
[[nodiscard]] ServerSources ProcessSources();

/// The server that is asked. A value.
struct ServerChoice {
  ServerUrl url;
  /// Where it comes from, for people: `that of the context hall`.
  std::string source;
  AccessFiles files = {};
  /// As ProbeTarget has it.
  std::string certificate_file = {};
};

/// By flag, else variable, else current context, else kServerDefault. The token by flag, else that
/// of a context that a flag names, else variable, else current context; a context's files count
/// only where its server is asked.
///
/// Errors: kInvalidArgument for a URL of no server, a context that is not there, a file that cannot
///         be read.
[[nodiscard]] absl::StatusOr<ServerChoice> ChooseServer(const ServerFlags& flags,
                                                        const ServerSources& sources);

}  // namespace uplink::ctl
