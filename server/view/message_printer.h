#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "server/view/text_members.h"

namespace google::protobuf {
class Message;
namespace util {
class TypeResolver;
}
}  // namespace google::protobuf

namespace uplink::view {

/// Prints messages of the fleet contract by the proto3 JSON mapping: default scalars printed, the
/// members of maps in the order of their names.
///
/// Errors:  kInternal if the mapping refuses a message.
/// Thread:  confined to one thread.
class MessagePrinter final {
 public:
  MessagePrinter();
  ~MessagePrinter();
  MessagePrinter(const MessagePrinter&) = delete;
  MessagePrinter& operator=(const MessagePrinter&) = delete;

  /// `texts` come after the message's own members. The message has at least one scalar.
  [[nodiscard]] absl::StatusOr<std::string> Print(const google::protobuf::Message& message,
                                                  const TextMembers& texts = {}) const;

 private:
  const std::unique_ptr<google::protobuf::util::TypeResolver> types_;
};

}  // namespace uplink::view
