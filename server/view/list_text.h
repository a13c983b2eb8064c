#pragma once

#include <cstddef>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/view/form.h"
#include "server/view/message_printer.h"

namespace uplink::view {

/// An answer that is a list, written item by item in one form: only one item at a time exists as a
/// message beside its text. Confined to one thread.
class ListText final {
 public:
  explicit ListText(Form form = Form::kJson) : form_(form) {}

  /// Errors: as MessagePrinter.
  [[nodiscard]] absl::Status Add(const google::protobuf::Message& item, const TextMembers& texts);
  /// Bytes of all items so far.
  [[nodiscard]] std::size_t bytes() const { return text_.size(); }
  /// The whole answer. `response` lists nothing, and its first field is the list.
  [[nodiscard]] absl::StatusOr<std::string> TakeIn(const google::protobuf::Message& response);

 private:
  const Form form_;
  MessagePrinter printer_;
  std::string text_;
};

}  // namespace uplink::view
