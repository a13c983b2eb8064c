#include "schema/model/message_source.h"

#include "schema/base/check.h"

namespace uplink::model {
namespace {

/// Empty for a number that no source has.
constexpr std::string_view WordOf(MessageSource source) {
  switch (source) {
    case MessageSource::kUplink:
      return "uplink";
    case MessageSource::kCyberwave:
      return "cyberwave";
    case MessageSource::kUncrew:
      return "uncrew";
  }
  return {};
}

// The switch names every source, so the compiler finds one that the list lacks.
static_assert(WordOf(static_cast<MessageSource>(kAllMessageSources.size())).empty(),
              "kAllMessageSources lacks a source");
static_assert(WordOf(kAllMessageSources.back()) ==
                  WordOf(static_cast<MessageSource>(kAllMessageSources.size() - 1)),
              "kAllMessageSources is in number order");

}  // namespace

std::string_view ToText(MessageSource source) {
  const std::string_view word = WordOf(source);
  UPLINK_CHECK(!word.empty(), "a source that does not exist");
  return word;
}

std::optional<MessageSource> MessageSourceFromText(std::string_view text) {
  for (const MessageSource source : kAllMessageSources) {
    if (ToText(source) == text) return source;
  }
  return std::nullopt;
}

}  // namespace uplink::model
