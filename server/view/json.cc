#include "server/view/json.h"

#include <cstddef>

#include <absl/status/status.h>
#include <fmt/core.h>

#include "server/view/list_text.h"
#include "server/view/message_printer.h"
#include "server/view/message_wire.h"
#include "server/view/messages.h"

namespace uplink::view {
absl::StatusOr<std::string> Encode(Form form, const google::protobuf::Message& message,
                                   const TextMembers& texts) {
  if (form == Form::kWire) return WireOf(message, texts);
  return MessagePrinter().Print(message, texts);
}

absl::StatusOr<std::string> Encode(Form form, const RobotView& robot, const PartSet& parts) {
  return Encode(form, ToMessage(robot), TextsOf(robot, parts));
}

absl::StatusOr<std::string> Encode(Form form, const RobotsPage& page, const PartSet& parts) {
  v1::ListRobotsResponse response;
  response.set_total(page.total);
  response.set_next_page_token(page.next_token);
  response.set_unjudged(page.unjudged);
  ListText list(form);
  const RobotView* last = nullptr;
  for (const RobotView& robot : page.robots) {
    if (list.bytes() >= storage::kPageBytesMax) {
      response.set_next_page_token(last->next_token);
      break;
    }
    const absl::Status added = list.Add(ToMessage(robot), TextsOf(robot, parts));
    if (!added.ok()) return added;
    last = &robot;
  }
  return list.TakeIn(response);
}

absl::StatusOr<std::string> Encode(Form form, const FleetsPage& page) {
  v1::ListFleetsResponse response;
  response.set_next_page_token(page.next_token);
  ListText list(form);
  for (const FleetView& fleet : page.fleets) {
    if (absl::Status added = list.Add(ToMessage(fleet), {}); !added.ok()) return added;
  }
  return list.TakeIn(response);
}

absl::StatusOr<std::string> Encode(Form form, const std::vector<fleet::TopSenders::Sender>& senders,
                                   std::string_view by) {
  v1::ListTopResponse response;
  response.set_by(std::string(by));
  ListText list(form);
  for (const fleet::TopSenders::Sender& sender : senders) {
    if (absl::Status added = list.Add(ToMessage(sender), {}); !added.ok()) return added;
  }
  return list.TakeIn(response);
}

absl::StatusOr<std::string> Encode(Form form, const std::vector<fleet::Candidate>& candidates) {
  v1::ListCandidatesResponse response;
  ListText list(form);
  for (const fleet::Candidate& candidate : candidates) {
    if (absl::Status added = list.Add(ToMessage(candidate), {}); !added.ok()) return added;
  }
  return list.TakeIn(response);
}

absl::StatusOr<std::string> Encode(Form form, const StatusView& status,
                                   const std::vector<std::string>& degraded) {
  return Encode(form, ToMessage(status, degraded), {});
}

std::string WordsJson(std::string_view key, const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) {
    if (!list.empty()) list += ',';
    list += fmt::format(R"("{}")", word);
  }
  return fmt::format(R"({{"{}":[{}]}})", key, list);
}

}  // namespace uplink::view
