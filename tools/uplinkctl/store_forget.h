#pragma once

#include <string>

namespace uplink::ctl {

struct StoreForgetRequest {
  /// Of the store, of either kind.
  std::string url;
  std::string password_file;
  std::string ruri;
  /// End the robot's stream first, and wait for its records.
  bool end_stream = false;
  /// Without asking.
  bool yes = false;
};

/// Shows what a store has of a robot, asks, has the server that holds it let go of it, and deletes
/// all of that. Returns the exit code: kExitFailed if the robot stays, and why is printed.
[[nodiscard]] int StoreForget(const StoreForgetRequest& request);

}  // namespace uplink::ctl
