#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <unordered_map>

#include "tools/uplink-fleet/robot/forwarded_item.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::synthetic {

/// Commands that a ForwardReader remembers; at it all are forgotten.
inline constexpr std::size_t kReadCommandsMax = 8192;

/// What one command says.
struct ReadCommand {
  /// Why it says nothing; empty if it does.
  std::string error{};
  ItemRef item{};
  /// The item has ended; else it is what the fingerprint stands for.
  bool deletion = false;
  std::uint64_t fingerprint = 0;
};

/// Reads each command once for all robots of a thread: the server sends the same bytes to each, and
/// a fleet of thousands could not decode them thousands of times.
///
/// Thread: confined to its thread.
class ForwardReader final {
 public:
  /// Valid until the next call.
  [[nodiscard]] const ReadCommand& Read(const v1::Forward& forward);

  /// The robots that commands came from.
  [[nodiscard]] const std::set<std::string>& origins() const { return origins_; }

 private:
  /// By the serialized command.
  std::unordered_map<std::string, ReadCommand> known_;
  std::set<std::string> origins_;
};

}  // namespace uplink::synthetic
