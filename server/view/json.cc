#include "server/view/json.h"

#include <cstddef>

#include <absl/status/status.h>
#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "server/view/list_text.h"
#include "server/view/message_printer.h"
#include "server/view/messages.h"
#include "server/view/page_token.h"

namespace uplink::view {
namespace {

/// Bytes of a text in an error; enough for a RURI with every byte shown as hex.
constexpr std::size_t kErrorTextBytesMax = 2048;

/// A text as JSON string. PrintableUtf8 leaves no control character in it.
std::string Quoted(std::string_view text) {
  std::string json = "\"";
  for (const char c : PrintableUtf8(text, kErrorTextBytesMax)) {
    if (c == '"' || c == '\\') json += '\\';
    json += c;
  }
  return json + '"';
}

}  // namespace

absl::StatusOr<std::string> ToJson(const RobotView& robot, const PartSet& parts) {
  return MessagePrinter().Print(ToMessage(robot), TextsOf(robot, parts));
}

absl::StatusOr<std::string> ToJson(const RobotsPage& page, const PartSet& parts) {
  v1::ListRobotsResponse response;
  response.set_total(page.total);
  response.set_next_page_token(page.next_token);
  ListText list;
  const RobotView* last = nullptr;
  for (const RobotView& robot : page.robots) {
    if (list.bytes() >= storage::kPageBytesMax) {
      response.set_next_page_token(RobotsToken(last->id.ruri));
      break;
    }
    const absl::Status added = list.Add(ToMessage(robot), TextsOf(robot, parts));
    if (!added.ok()) return added;
    last = &robot;
  }
  return list.TakeIn(response);
}

absl::StatusOr<std::string> ToJson(const StatusView& status,
                                   const std::vector<std::string>& degraded) {
  return MessagePrinter().Print(ToMessage(status, degraded));
}

std::string WordsJson(std::string_view key, const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) {
    if (!list.empty()) list += ',';
    list += Quoted(word);
  }
  return fmt::format("{{{}:[{}]}}", Quoted(key), list);
}

std::string ErrorJson(const ErrorText& error) {
  std::string json = fmt::format(R"({{"error":{{"code":{},"message":{})", Quoted(error.code),
                                 Quoted(error.message));
  if (!error.field.empty()) json += fmt::format(R"(,"field":{})", Quoted(error.field));
  return json + "}}";
}

}  // namespace uplink::view
