#pragma once

#include <string>
#include <string_view>

// Apart from json.h, so that uplinkctl says what went wrong without all that a server shows.
namespace uplink::view {

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
