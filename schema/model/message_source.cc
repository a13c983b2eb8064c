#include "schema/model/message_source.h"

#include "schema/base/check.h"

namespace uplink::model {

std::string_view ToText(MessageSource source) {
  switch (source) {
    case MessageSource::kUplink:
      return "uplink";
    case MessageSource::kCyberwave:
      return "cyberwave";
  }
  CheckFailed(__FILE__, __LINE__, "source", "a source that does not exist");
}

std::optional<MessageSource> MessageSourceFromText(std::string_view text) {
  for (const MessageSource source : {MessageSource::kUplink, MessageSource::kCyberwave}) {
    if (ToText(source) == text) return source;
  }
  return std::nullopt;
}

}  // namespace uplink::model
