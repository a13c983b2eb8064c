#include "storage/refusal.h"

#include <string>

#include "schema/base/utf8.h"
#include "schema/model/ids.h"
#include "storage/bounds.h"

namespace uplink::storage {

model::Rejection TooManyActiveFaults() {
  return {model::RejectReason::kTooManyItems, "faultId",
          "the robot has " + std::to_string(kActiveFaultsPerRobotMax) +
              " active faults already; clear some"};
}

model::Rejection TooManyShapes() {
  return {model::RejectReason::kTooManyItems, "upsert.identity.id",
          "the robot has " + std::to_string(kShapesPerRobotMax) +
              " shapes already; delete some or let them expire"};
}

model::Rejection TooManyObjects() {
  return {model::RejectReason::kTooManyItems, "upsert.id",
          "the robot has " + std::to_string(kObjectsPerRobotMax) +
              " objects already; delete some or let them expire"};
}

model::Rejection TooManyOpenRequests() {
  return {model::RejectReason::kTooManyItems, "requestId",
          "the robot has " + std::to_string(kOpenRequestsPerRobotMax) +
              " open requests already; withdraw some"};
}

model::Rejection StoreRefused(std::string_view cause) {
  std::string detail = "the store does not take it: ";
  detail += IsCleanUtf8(cause) ? cause : std::string_view("no cause given");
  return {model::RejectReason::kStoreRefused, "",
          std::string(Utf8Prefix(detail, model::kDetailBytesMax))};
}

}  // namespace uplink::storage
