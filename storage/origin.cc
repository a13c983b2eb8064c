#include "storage/origin.h"

#include <utility>

#include "schema/base/utf8.h"

namespace uplink::storage {

OriginRef OriginOf(model::MessageSource source, std::string_view topic, TopicHoldRef hold) {
  return std::make_shared<const Origin>(
      Origin{source, PrintableUtf8(topic, kTopicBytesMax), std::move(hold)});
}

}  // namespace uplink::storage
