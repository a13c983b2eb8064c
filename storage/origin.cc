#include "storage/origin.h"

#include "schema/base/utf8.h"

namespace uplink::storage {

OriginRef OriginOf(model::MessageSource source, std::string_view topic) {
  return std::make_shared<const Origin>(Origin{source, PrintableUtf8(topic, kTopicBytesMax)});
}

}  // namespace uplink::storage
