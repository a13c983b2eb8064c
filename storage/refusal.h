#pragma once

#include <string_view>

#include "schema/model/rejection.h"

namespace uplink::storage {

/// The verdict on a raise of a fault beyond kActiveFaultsPerRobotMax. One text for every store.
[[nodiscard]] model::Rejection TooManyActiveFaults();

/// The verdicts on an upsert of a shape beyond kShapesPerRobotMax, and of an object beyond
/// kObjectsPerRobotMax.
[[nodiscard]] model::Rejection TooManyShapes();
[[nodiscard]] model::Rejection TooManyObjects();

/// The verdict on a request to an operator beyond kOpenRequestsPerRobotMax.
[[nodiscard]] model::Rejection TooManyOpenRequests();

/// The verdict on a record that the database itself will not take. `cause` is its own sentence; cut
/// to kDetailBytesMax.
[[nodiscard]] model::Rejection StoreRefused(std::string_view cause);

}  // namespace uplink::storage
