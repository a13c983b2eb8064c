#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/identity/token_file.h"

namespace uplink::ctl {

/// Whether a file of tokens must be there before a change. Closed.
enum class Missing : std::uint8_t { kIsEmpty, kIsAnError };

/// What a change makes of a file; `read` is what it holds.
using TokensChange = std::function<absl::StatusOr<std::string>(const identity::ReadTokens& read)>;

/// Changes a file of tokens, so that a server that reads it meanwhile sees the old or the new one,
/// and no other call's change is lost. The file keeps its owner, group and mode; a new one is
/// readable by the folder's group, which is the server's in a package. A link stays one.
///
/// Errors: those of ReadTokenFile, so that a broken file is not made worse; kFailedPrecondition if
///         everybody may write the file, if the result would not be read, or if what stands there
///         cannot be kept as it is; the change's own. Then the file is as it was.
/// Thread: any; blocks on the file, and while another call changes one of the folder.
[[nodiscard]] absl::Status ChangeTokens(const std::string& path, Missing missing,
                                        const TokensChange& change);

}  // namespace uplink::ctl
