#include "storage/origin.h"

#include <utility>

#include "schema/base/check.h"
#include "schema/base/utf8.h"

namespace uplink::storage {

OriginRef OriginOf(model::MessageSource source, std::string_view topic, TopicHoldRef hold) {
  return std::make_shared<const Origin>(
      Origin{source, PrintableUtf8(topic, kTopicBytesMax), std::move(hold)});
}

std::string NoRobotOf(std::string_view topic_prefix) {
  UPLINK_CHECK(topic_prefix.size() <= kTopicPrefixBytesMax, "no such prefix gets a lease");
  return std::string(kNoRobotPrefix) + std::string(topic_prefix);
}

}  // namespace uplink::storage
