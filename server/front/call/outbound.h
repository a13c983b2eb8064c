#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "server/transport/call_handler.h"

namespace uplink::front {

using transport::kPrefixBytes;
using transport::SharedMessage;

/// What one call sends: one message of its own, or several shared with other calls. Shared messages
/// are not copied, so a thousand peers that read nothing hold them once. Confined to its owner's
/// thread.
class Outbound final {
 public:
  /// Sets one message with its prefix; nothing else may wait.
  void Set(std::string message);
  /// Sets at least one message, each to be sent behind its prefix; nothing else may wait.
  void Set(std::vector<SharedMessage> messages);
  /// Copies the next bytes, at most `size`, and returns how many.
  std::size_t Take(char* into, std::size_t size);
  /// All was taken.
  [[nodiscard]] bool empty() const { return own_.empty() && shared_.empty(); }
  /// Some bytes were taken since the last Set.
  [[nodiscard]] bool begun() const { return from_ > 0 || next_ > 0; }
  void Clear();

 private:
  std::size_t TakeShared(char* into, std::size_t size);

  std::string own_;
  std::vector<SharedMessage> shared_;
  /// The index of the shared message that is being taken.
  std::size_t next_ = 0;
  /// Bytes that were taken of the current message, its prefix included.
  std::size_t from_ = 0;
};

}  // namespace uplink::front
