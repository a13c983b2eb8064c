#include "schema/rules/texts.h"

#include "schema/base/utf8.h"
#include "schema/limits.h"

namespace uplink::schema {

TextFinding ReadText(const Path& path, std::string_view text, std::size_t bytes_max) {
  if (text.size() > bytes_max) return {.violation = TextTooLong(path, text.size(), bytes_max)};
  const std::optional<std::size_t> controls = CountControls(text);
  if (!controls) return {.violation = TextNotUtf8(path, text)};
  return {.violation = {}, .controls = *controls};
}

std::string KeptText(Violations& violations, std::string_view text, std::size_t controls) {
  if (controls == 0) [[likely]]
    return std::string(text);
  violations.CountControls(controls);
  return ReplaceControls(text, controls);
}

std::optional<std::string> Text(Violations& violations, const Path& path, std::string_view text,
                                std::size_t bytes_max) {
  const TextFinding found = ReadText(path, text, violations.TextBytesMax(bytes_max));
  if (found.violation) {
    violations.Content(*found.violation);
    return std::nullopt;
  }
  return KeptText(violations, text, found.controls);
}

std::string DurableText(Violations& violations, const Path& path, std::string_view text,
                        std::size_t bytes_max) {
  return Text(violations, path, text, bytes_max).value_or(std::string());
}

std::string RequiredText(Violations& violations, const Path& path, std::string_view text,
                         std::size_t bytes_max) {
  if (text.empty()) violations.Content(MissingField(path, "is empty"));
  return DurableText(violations, path, text, bytes_max);
}

std::string LiveKey(Violations& violations, const Path& path, std::string_view text) {
  const TextFinding found = ReadText(path, text, violations.TextBytesMax(kIdBytesMax));
  if (found.violation) {
    violations.Reject(*found.violation);
    return {};
  }
  return KeptText(violations, text, found.controls);
}

std::string RequiredLiveKey(Violations& violations, const Path& path, std::string_view text) {
  if (text.empty()) violations.Reject(MissingField(path, "is empty"));
  return LiveKey(violations, path, text);
}

std::optional<std::string> CutText(Violations& violations, const Path& path, std::string_view text,
                                   std::size_t bytes_max) {
  TextFinding found = ReadText(path, text, text.size());
  if (found.violation) {
    violations.Content(*found.violation);
    return std::nullopt;
  }
  const std::size_t kept_max = violations.TextBytesMax(bytes_max);
  if (text.size() > kept_max) {
    violations.Content(TextTooLong(path, text.size(), kept_max));
    text = Utf8Prefix(text, kept_max);
    if (found.controls > 0) found.controls = CountControls(text).value_or(0);
  }
  if (found.controls == 0) [[likely]]
    return violations.NewText(text);
  return KeptText(violations, text, found.controls);
}

}  // namespace uplink::schema
