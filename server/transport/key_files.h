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

/// Whether texts are good together: the certificate is a server's, the key its own, the authority
/// readable.
///
/// Errors: kFailedPrecondition with a sentence that names the one that is invalid.
[[nodiscard]] absl::Status CheckTexts(const PemTexts& texts);

/// The PEM files of a listener, and the last texts of them that were good together: whoever copies
/// a new certificate in place leaves halves behind for a moment.
///
/// Thread: confined to one.
class KeyFiles final {
 public:
  explicit KeyFiles(PemFiles files) : files_(std::move(files)) {}

  /// Reads the files again. True if the texts are new and good together, and were taken over; false
  /// if they are the same.
  ///
  /// Errors: kFailedPrecondition names the file that cannot be read, that does not fit, or that
  ///         everybody may write; the last good ones stay.
  [[nodiscard]] absl::StatusOr<bool> Refresh();

  /// The last good ones; empty before the first.
  [[nodiscard]] const PemTexts& texts() const { return texts_; }
  /// What they are, for the log; nothing before the first.
  [[nodiscard]] const identity::ServedPems& served() const { return served_; }

 private:
  const PemFiles files_;
  PemTexts texts_;
  identity::ServedPems served_;
};

}  // namespace uplink::transport
