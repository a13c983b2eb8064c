#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/identity/served_pems.h"
#include "server/transport/options.h"

namespace uplink::transport {

/// What a look at the PEM files found. A value.
struct FilesLook {
  /// Not OK: why the files on disk are not served.
  absl::Status status;
  /// What is served.
  identity::ServedPems served;
};

/// Whether texts fit together: the certificate is a server's, the key belongs to it, the authority
/// is readable.
///
/// Errors: kFailedPrecondition with a sentence that names the one that is invalid.
[[nodiscard]] absl::Status CheckTexts(const PemTexts& texts);

/// The PEM files of a listener, and their last texts that fitted together: copying a new
/// certificate in place leaves mismatched files for a moment.
///
/// Thread: confined to one.
class KeyFiles final {
 public:
  explicit KeyFiles(PemFiles files) : files_(std::move(files)) {}

  /// Reads the files again. True if the texts are new and fit together, and are served from now on;
  /// false if they are the same.
  ///
  /// Errors: kFailedPrecondition names the file that cannot be read, that does not fit, or that
  ///         every user may write; the last good ones stay.
  [[nodiscard]] absl::StatusOr<bool> Refresh();

  /// The last good ones; empty before the first.
  [[nodiscard]] const PemTexts& texts() const { return texts_; }
  /// Facts about them, for the log; empty before the first.
  [[nodiscard]] const identity::ServedPems& served() const { return served_; }

 private:
  const PemFiles files_;
  PemTexts texts_;
  identity::ServedPems served_;
};

}  // namespace uplink::transport
