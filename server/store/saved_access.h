#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/access_store.h"

namespace uplink::store {

/// Bytes of the largest saved copy that is read: all revocations, and far more robots than a server
/// takes.
inline constexpr std::size_t kSavedAccessBytesMax = std::size_t{256} * 1024 * 1024;

/// What decides who may come in while the store cannot be read. A value.
struct AccessCopy {
  /// Those that are revoked.
  std::vector<storage::Revocation> revocations;
  /// Robots that are blocked, or that an operator added; of each only these two.
  std::vector<storage::RobotSetting> settings;
  /// Of the store when they were read.
  storage::AccessVersion version = 0;
};

/// Everything that the store has of it, what was taken back included. A value.
struct AllAccess {
  std::vector<storage::Revocation> revocations;
  std::vector<storage::RobotSetting> settings;
};

/// So many decisions of `known` the store never took back and yet has no more: it is an earlier
/// state of itself. The versions tell less, for they go by the clock, and a store that was restored
/// may have been written since.
[[nodiscard]] std::size_t LackedBy(const AllAccess& store, const AccessCopy& known);

/// The copy as text, a line each; `store` is what the log calls the store. What a line cannot hold
/// is left out.
[[nodiscard]] std::string TextOf(const AccessCopy& copy, const std::string& store);

/// Errors: kFailedPrecondition: it is not whole, of another version, or of another store.
[[nodiscard]] absl::StatusOr<AccessCopy> ParseAccess(const std::string& text,
                                                     const std::string& store);

/// The file of the copy: readable by its owner alone, replaced as a whole.
///
/// Errors: a sentence that names the file.
/// Thread: any; blocks on the file.
[[nodiscard]] absl::Status SaveAccess(const std::string& path, const std::string& text);
/// Errors: also kNotFound: there is none; kFailedPrecondition: others than its owner may write it.
[[nodiscard]] absl::StatusOr<std::string> ReadSavedAccess(const std::string& path);

}  // namespace uplink::store
