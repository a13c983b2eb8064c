#include "schema/model/connection.h"

#include "schema/base/check.h"

namespace uplink::model {

std::string_view ToText(ConnectionEnd end) {
  switch (end) {
    case ConnectionEnd::kOrderly:
      return "orderly";
    case ConnectionEnd::kBroken:
      return "broken";
    case ConnectionEnd::kSilent:
      return "silent";
    case ConnectionEnd::kReplaced:
      return "replaced";
    case ConnectionEnd::kDrained:
      return "drained";
    case ConnectionEnd::kNotRead:
      return "not_read";
    case ConnectionEnd::kProtocolError:
      return "protocol_error";
    case ConnectionEnd::kRefused:
      return "refused";
    case ConnectionEnd::kCertificateExpired:
      return "certificate_expired";
    case ConnectionEnd::kServerEnded:
      return "server_ended";
  }
  CheckFailed(__FILE__, __LINE__, "end", "an end that does not exist");
}

std::optional<ConnectionEnd> ConnectionEndFromText(std::string_view text) {
  for (const ConnectionEnd end : kAllConnectionEnds) {
    if (text == ToText(end)) return end;
  }
  return std::nullopt;
}

}  // namespace uplink::model
