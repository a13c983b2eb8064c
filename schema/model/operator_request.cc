#include "schema/model/operator_request.h"

#include "schema/base/check.h"

namespace uplink::model {

std::string_view ToText(OperatorRequestKind kind) {
  switch (kind) {
    case OperatorRequestKind::kConfirmDeliveryReady:
      return "confirm_delivery_ready";
    case OperatorRequestKind::kConfirmDeliveryComplete:
      return "confirm_delivery_complete";
  }
  CheckFailed(__FILE__, __LINE__, "kind", "a kind of request that does not exist");
}

std::optional<OperatorRequestKind> OperatorRequestKindFromText(std::string_view text) {
  for (const OperatorRequestKind kind : {OperatorRequestKind::kConfirmDeliveryReady,
                                         OperatorRequestKind::kConfirmDeliveryComplete}) {
    if (ToText(kind) == text) return kind;
  }
  return std::nullopt;
}

}  // namespace uplink::model
