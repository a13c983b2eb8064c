#include "server/view/list_text.h"

#include <string_view>
#include <utility>

#include "schema/base/check.h"

namespace uplink::view {

absl::Status ListText::Add(const google::protobuf::Message& item, const TextMembers& texts) {
  const absl::StatusOr<std::string> printed = printer_.Print(item, texts);
  if (!printed.ok()) return printed.status();
  if (!text_.empty()) text_ += ',';
  text_ += *printed;
  return absl::OkStatus();
}

absl::StatusOr<std::string> ListText::TakeIn(const google::protobuf::Message& response) {
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
