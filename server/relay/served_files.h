#pragma once

#include <array>
#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "server/identity/served_pems.h"
#include "server/transport/key_files.h"
#include "server/transport/options.h"

namespace uplink::relay {

/// What gRPC reads in place of the PEM files: copies in memory of the last that were good together.
/// gRPC 1.51 takes whatever it finds: a key that is not the certificate's ends all handshakes, and
/// an empty file, as a copy in place leaves for a moment, ends the process by an assertion.
///
/// The copies are memory files, named by their descriptors; a change puts a whole new one under the
/// same number at once, so that a reader sees the old or the new text and nothing between.
///
/// Thread: Refresh on one thread; gRPC opens the paths on its own.
class ServedFiles final {
 public:
  /// Errors: kFailedPrecondition names the file that cannot be read, that does not fit, or that
  ///         everybody may write.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<ServedFiles>> Make(
      const transport::PemFiles& files);
  ~ServedFiles();
  ServedFiles(const ServedFiles&) = delete;
  ServedFiles& operator=(const ServedFiles&) = delete;

  /// Looks at the files again and takes them over if they are good together; otherwise says what is
  /// wrong, and the last good ones stay.
  [[nodiscard]] absl::Status Refresh();

  /// What is served.
  [[nodiscard]] const identity::ServedPems& served() const { return files_.served(); }
  /// Where gRPC reads.
  [[nodiscard]] const transport::PemFiles& paths() const { return paths_; }

 private:
  static constexpr std::size_t kFiles = 3;

  explicit ServedFiles(transport::PemFiles files) : files_(std::move(files)) {}
  [[nodiscard]] absl::Status Replace(const std::array<std::string, kFiles>& texts);

  transport::KeyFiles files_;
  transport::PemFiles paths_;
  /// Certificate, key, client authority; -1 before the first.
  std::array<int, kFiles> descriptors_{-1, -1, -1};
  /// What they hold.
  std::array<std::string, kFiles> texts_;
  /// They hold the last good texts.
  bool served_ = false;
};

}  // namespace uplink::relay
