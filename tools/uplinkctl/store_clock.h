#pragma once

#include <string>

namespace uplink::ctl {

struct StoreClockRequest {
  /// Of the store, of either kind.
  std::string url;
  std::string password_file;
  /// Set the mark to this machine's time.
  bool confirm = false;
  /// Without asking.
  bool yes = false;
};

/// Shows the store's mark, this machine's clock and the database's, and whether the clock is
/// vouched for; sets the mark if that is asked for. Returns the exit code: kExitFailed if it is not
/// vouched for in the end.
[[nodiscard]] int StoreClock(const StoreClockRequest& request);

}  // namespace uplink::ctl
