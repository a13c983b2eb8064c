#pragma once

#include <memory>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <sys/types.h>

#include "tools/pki/authority.h"

namespace uplink::pki {

/// Bytes of the largest PEM file that is read.
inline constexpr std::size_t kPemBytesMax = std::size_t{64} * 1024;

/// What to do when a file is already there.
enum class Existing { kRefuse, kReplace };

/// What decides who may replace a folder's files. A value.
struct FolderFacts {
  uid_t owner = 0;
  mode_t mode = 0;
};

/// Whether root and the caller alone may replace the folder's files.
///
/// Errors: kFailedPrecondition with a sentence that says what to do.
/// Thread: pure; any thread.
[[nodiscard]] absl::Status CheckFolder(const std::string& path, const FolderFacts& facts,
                                       uid_t caller);

/// A folder of PEM files: `NAME.crt` and `NAME.key`, every file 0600, the folder 0700 if it is made
/// here. Files are written aside and renamed, so a reader never sees half of one; what a call left
/// aside that was killed is removed when its file is written next.
///
/// Errors: each names the path: kAlreadyExists, kNotFound, kPermissionDenied, kInternal.
/// Thread: any; holds only its path.
class Directory final {
 public:
  explicit Directory(std::string path) : path_(std::move(path)) {}

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string CertificatePath(const std::string& name) const;
  [[nodiscard]] std::string KeyPath(const std::string& name) const;

  /// Makes the folder if it is missing.
  ///
  /// Errors: those of CheckFolder.
  [[nodiscard]] absl::Status Prepare() const;
  /// Whether the certificate and its key are there.
  ///
  /// Errors: kFailedPrecondition if one is there without the other, which a call that was
  ///         interrupted or a restore of half a backup leaves.
  [[nodiscard]] absl::StatusOr<bool> HasPair(const std::string& name) const;
  /// kAlreadyExists if Write(name, ..., kRefuse) would refuse.
  [[nodiscard]] absl::Status CheckFree(const std::string& name) const;
  [[nodiscard]] absl::Status Write(const std::string& name, const Credentials& credentials,
                                   Existing existing) const;
  /// The certificate without its key; replaces one that is there.
  [[nodiscard]] absl::Status WriteCertificate(const std::string& name,
                                              const Credentials& credentials) const;
  [[nodiscard]] absl::StatusOr<Credentials> Read(const std::string& name) const;
  /// The authority in `ca.crt` and `ca.key`.
  [[nodiscard]] absl::StatusOr<std::unique_ptr<Authority>> LoadAuthority() const;

 private:
  std::string path_;
};

/// Name of the authority's files.
inline constexpr const char* kAuthorityName = "ca";

}  // namespace uplink::pki
