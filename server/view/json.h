#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "server/view/form.h"
#include "server/view/parts.h"
#include "server/view/queries.h"
#include "server/view/text_members.h"

namespace google::protobuf {
class Message;
}  // namespace google::protobuf

namespace uplink::view {

// Answers, as messages of the fleet contract in a form (message_printer.h, message_wire.h,
// list_text.h). What robots reported is in JSON as the texts that the store keeps.
//
// Errors:  kInternal if the JSON mapping refuses a message.
// Thread:  pure; any thread.

[[nodiscard]] absl::StatusOr<std::string> Encode(Form form,
                                                 const google::protobuf::Message& message,
                                                 const TextMembers& texts);
[[nodiscard]] absl::StatusOr<std::string> Encode(Form form, const RobotView& robot,
                                                 const PartSet& parts);
/// The page ends, with its token, after the robot with which the answer passes kPageBytesMax.
[[nodiscard]] absl::StatusOr<std::string> Encode(Form form, const RobotsPage& page,
                                                 const PartSet& parts);
[[nodiscard]] absl::StatusOr<std::string> Encode(Form form, const FleetsPage& page);
/// `by` is a word of fleet::kTopByNames.
[[nodiscard]] absl::StatusOr<std::string> Encode(
    Form form, const std::vector<fleet::TopSenders::Sender>& senders, std::string_view by);
[[nodiscard]] absl::StatusOr<std::string> Encode(Form form,
                                                 const std::vector<fleet::Candidate>& candidates);
[[nodiscard]] absl::StatusOr<std::string> Encode(Form form, const StatusView& status,
                                                 const std::vector<std::string>& degraded);

[[nodiscard]] inline absl::StatusOr<std::string> ToJson(const StatusView& status,
                                                        const std::vector<std::string>& degraded) {
  return Encode(Form::kJson, status, degraded);
}
/// Any other of them as JSON.
template <typename... Answer>
[[nodiscard]] absl::StatusOr<std::string> ToJson(const Answer&... answer) {
  return Encode(Form::kJson, answer...);
}

/// `{"<key>":["<word>",...]}`: the body of /readyz. The words need no escapes: they are our own.
[[nodiscard]] std::string WordsJson(std::string_view key, const std::vector<std::string>& words);

}  // namespace uplink::view
