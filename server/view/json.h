#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "server/view/parts.h"
#include "server/view/queries.h"

namespace uplink::view {

// The proto3 JSON mapping of the fleet contract's messages (message_printer.h, list_text.h). What
// robots reported is in it as the texts that the store keeps.
//
// Errors:  kInternal if the mapping refuses a message.
// Thread:  pure; any thread.

[[nodiscard]] absl::StatusOr<std::string> ToJson(const RobotView& robot, const PartSet& parts);
/// The page ends, with its token, after the robot with which the answer passes kPageBytesMax.
[[nodiscard]] absl::StatusOr<std::string> ToJson(const RobotsPage& page, const PartSet& parts);
[[nodiscard]] absl::StatusOr<std::string> ToJson(const FleetsPage& page);
/// `by` is a word of fleet::kTopByNames.
[[nodiscard]] absl::StatusOr<std::string> ToJson(
    const std::vector<fleet::TopSenders::Sender>& senders, std::string_view by);
[[nodiscard]] absl::StatusOr<std::string> ToJson(const std::vector<fleet::Candidate>& candidates);
[[nodiscard]] absl::StatusOr<std::string> ToJson(const StatusView& status,
                                                 const std::vector<std::string>& degraded);

/// `{"<key>":["<word>",...]}`: the body of /readyz. The words need no escapes: they are our own.
[[nodiscard]] std::string WordsJson(std::string_view key, const std::vector<std::string>& words);

/// An answer that says what went wrong. `field` may be empty.
struct ErrorText {
  /// The canonical name: `INVALID_ARGUMENT`.
  std::string_view code;
  std::string_view message;
  std::string_view field{};
};

/// `{"error":{"code":...,"message":...,"field":...}}`; bytes that are no text are shown as hex.
[[nodiscard]] std::string ErrorJson(const ErrorText& error);

}  // namespace uplink::view
