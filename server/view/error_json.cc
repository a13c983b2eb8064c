#include "server/view/error_json.h"

#include <cstddef>

#include <fmt/core.h>

#include "schema/base/utf8.h"

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

std::string ErrorJson(const ErrorText& error) {
  std::string json = fmt::format(R"({{"error":{{"code":{},"message":{})", Quoted(error.code),
                                 Quoted(error.message));
  if (!error.field.empty()) json += fmt::format(R"(,"field":{})", Quoted(error.field));
  return json + "}}";
}

}  // namespace uplink::view
