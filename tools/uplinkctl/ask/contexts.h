#pragma once

#include <cstddef>
#include <map>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "tools/uplinkctl/ask/access.h"

namespace uplink::ctl {

/// A server by a name of the operator's. A value.
struct Context {
  /// As ParseServerUrl reads it.
  std::string server;
  /// Absolute paths.
  AccessFiles files = {};
};

/// What `~/.config/uplinkctl/config.toml` holds. It has no secrets, only where a server is, and
/// where the files are by which it is asked. A value.
struct Contexts {
  /// The one that is used without a flag; empty: none.
  std::string current;
  std::map<std::string, Context> by_name;
};

/// Bytes of the largest file that is read.
inline constexpr std::size_t kContextsBytesMax = std::size_t{256} * 1024;
/// Characters of a context's name.
inline constexpr std::size_t kContextNameMax = 64;

/// Where the file is: below XDG_CONFIG_HOME, else below HOME; empty if neither is set.
/// `environment` ends with a null pointer, as environ does.
[[nodiscard]] std::string ContextsFile(const char* const* environment);

/// kInvalidArgument unless the name has letters, digits, `-` and `_` alone, at most
/// kContextNameMax.
[[nodiscard]] absl::Status CheckContextName(const std::string& name);

/// Checks a context, whose paths become absolute. `key` says in errors where its server comes from.
///
/// Errors: kInvalidArgument for a URL of no server, for files that mean nothing there, and for
///         control characters in paths.
[[nodiscard]] absl::StatusOr<Context> GoodContext(Context context, const std::string& key);

/// Reads the text of a file; `path` stands in errors.
///
/// Errors: kInvalidArgument names the line or the key: no TOML, an unknown key, a URL of no server,
///         a current context that is not there.
[[nodiscard]] absl::StatusOr<Contexts> ParseContexts(const std::string& text,
                                                     const std::string& path);
/// The file at `path`; none is there: no contexts.
[[nodiscard]] absl::StatusOr<Contexts> LoadContexts(const std::string& path);

/// The text that ParseContexts reads back.
[[nodiscard]] std::string ContextsText(const Contexts& contexts);
/// Replaces the file, whose folders are made if they are missing; only its owner may read it.
[[nodiscard]] absl::Status SaveContexts(const Contexts& contexts, const std::string& path);

}  // namespace uplink::ctl
