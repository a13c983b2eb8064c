#pragma once

#include <cstddef>
#include <string>

#include <absl/status/statusor.h>

namespace uplink::identity {

/// One PEM text, and its name in messages: a path, or a description.
struct NamedPem {
  std::string name;
  std::string text;
};

/// Bytes of the largest PEM file that is read: some thousand certificates.
inline constexpr std::size_t kPemBytesMax = std::size_t{4} * 1024 * 1024;

/// Errors: kFailedPrecondition names the file and the cause: it cannot be read, is no regular file,
///         or is larger than kPemBytesMax.
/// Thread: any; blocks on the file, never on a pipe.
[[nodiscard]] absl::StatusOr<NamedPem> ReadPem(const std::string& path);

}  // namespace uplink::identity
