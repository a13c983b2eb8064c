#include "schema/encode/encode_body.h"

namespace uplink::schema {

void EncodeMember(const model::TelemetryExtras& in, wire::UplinkMsg::Builder message) {
  auto out = message.initTelemetryExtras();
  out.setUnixTimeMs(in.unix_time_ms);
  auto kv = out.initKv(Count(in.kv));
  for (unsigned i = 0; i < kv.size(); ++i) {
    kv[i].setKey(Text(in.kv[i].key));
    EncodeValue(in.kv[i].value, kv[i].initValue());
    kv[i].setHasUnixTimeMs(in.kv[i].unix_time_ms.has_value());
    kv[i].setUnixTimeMs(in.kv[i].unix_time_ms.value_or(0));
  }
}

}  // namespace uplink::schema
