#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/identity/revocation_list.h"
#include "server/log/logger.h"

namespace uplink::transport {

/// A file of lists, and that of the authorities that sign them.
struct CrlFile {
  std::string lists;
  std::string authorities;

  friend bool operator==(const CrlFile&, const CrlFile&) = default;
};

/// Follows the lists of revoked certificates (CRLs) that authorities write. A file that cannot be
/// used leaves its last good lists in use; one that is over counts all the same. A change, a
/// failure, its end and a list that is over have a line in the log each.
///
/// Thread: one at a time, which blocks on the files; what says so any.
class CrlFiles final {
 public:
  /// The references outlive it. `files`: as they are now, asked at each look.
  CrlFiles(std::function<std::vector<CrlFile>()> files, const Clock& clock,
           const log::Logger& logger)
      : files_(std::move(files)), clock_(clock), logger_(logger) {}
  CrlFiles(const CrlFiles&) = delete;
  CrlFiles& operator=(const CrlFiles&) = delete;

  /// What all lists revoke, as identity::RevocationList::revoked, if that has changed since the
  /// last call; nothing: it has not.
  [[nodiscard]] std::optional<std::vector<identity::SignedSerial>> Look();
  /// As of the last look a file could not be used, or a list of it is over. Any thread.
  [[nodiscard]] bool unread() const { return unread_.load(); }

 private:
  struct Followed {
    CrlFile file;
    std::string text;
    std::string authorities;
    std::vector<identity::RevocationList> lists;
    /// Why it did not fit at the last look.
    std::string why;
    /// That a list of it is over was told.
    bool told_over = false;
  };

  /// True if what is in use has changed.
  bool LookAt(Followed& followed);
  void TellOver(Followed& followed);

  const std::function<std::vector<CrlFile>()> files_;
  const Clock& clock_;
  const log::Logger& logger_;
  std::vector<Followed> followed_;
  std::atomic<bool> unread_{false};
};

}  // namespace uplink::transport
