#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "server/transport/call_handler.h"

namespace uplink::front {

using transport::kPrefixBytes;
using transport::SharedMessage;

/// What of one call is to go out: one message of its own, or some that it shares with others. Those
/// are not copied, so that a thousand peers that read nothing hold them once. Confined to its
/// owner's thread.
class Outbound final {
 public:
  /// With its prefix; nothing else waits.
  void Set(std::string message);
  /// One after the other, each behind its prefix; at least one, and nothing else waits.
  void Set(std::vector<SharedMessage> messages);
  /// Copies what is next, at most `size` bytes, and returns how many.
  std::size_t Take(char* into, std::size_t size);
  /// All was taken.
  [[nodiscard]] bool empty() const { return own_.empty() && shared_.empty(); }
  /// Some was taken of what was set last.
  [[nodiscard]] bool begun() const { return from_ > 0 || next_ > 0; }
  void Clear();

 private:
  std::size_t TakeShared(char* into, std::size_t size);

  std::string own_;
  std::vector<SharedMessage> shared_;
  /// Of these, the one that is taken now.
  std::size_t next_ = 0;
  /// Bytes of it that were taken, its prefix included.
  std::size_t from_ = 0;
};

}  // namespace uplink::front
