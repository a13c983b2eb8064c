#include "server/view/list_text.h"

#include <cstdint>
#include <string_view>
#include <utility>

#include <google/protobuf/descriptor.h>

#include "schema/base/check.h"
#include "server/view/message_wire.h"

namespace uplink::view {
namespace {

/// The number of the list's field in each response.
constexpr std::uint32_t kListField = 1;

}  // namespace

absl::Status ListText::Add(const google::protobuf::Message& item, const TextMembers& texts) {
  if (form_ == Form::kWire) {
    AppendField(kListField, WireOf(item, texts), text_);
    return absl::OkStatus();
  }
  const absl::StatusOr<std::string> printed = printer_.Print(item, texts);
  if (!printed.ok()) return printed.status();
  if (!text_.empty()) text_ += ',';
  text_ += *printed;
  return absl::OkStatus();
}

absl::StatusOr<std::string> ListText::TakeIn(const google::protobuf::Message& response) {
  if (form_ == Form::kWire) {
    UPLINK_CHECK(response.GetDescriptor()->field(0)->number() == int{kListField},
                 "a response begins with its list");
    text_ += WireOf(response);
    return std::exchange(text_, {});
  }
  const absl::StatusOr<std::string> around = printer_.Print(response);
  if (!around.ok()) return around.status();
  const std::size_t list = around->find("[]");
  UPLINK_CHECK(list != std::string::npos, "a response begins with its list");
  const std::string_view frame(*around);
  text_.insert(0, frame.substr(0, list + 1));
  text_ += frame.substr(list + 1);
  return std::exchange(text_, {});
}

}  // namespace uplink::view
