#include "storage/connection.h"

#include "schema/base/utf8.h"

namespace uplink::storage {

ConnectionItem Bounded(ConnectionItem item) {
  for (std::string* const text :
       {&item.server, &item.address, &item.gateway, &item.agent_version, &item.held_back_why,
        &item.certificate.serial, &item.certificate.sha256, &item.certificate.key_sha256}) {
    *text = PrintableUtf8(*text, kConnectionTextMax);
  }
  if (!item.ended) return item;
  item.ended->code = PrintableUtf8(item.ended->code, kConnectionTextMax);
  item.ended->detail = PrintableUtf8(item.ended->detail, kConnectionDetailMax);
  return item;
}

}  // namespace uplink::storage
