#pragma once

#include <cstddef>
#include <string>

#include "schema/model/extras.h"
#include "schema/model/health.h"
#include "schema/model/motion.h"
#include "schema/model/operator_request.h"
#include "schema/model/rcan.h"
#include "schema/model/record.h"
#include "schema/model/rejection.h"
#include "schema/model/scope_update.h"
#include "schema/model/status.h"
#include "schema/model/uncrew/value.h"

namespace uplink::model {

/// What a value holds in memory besides itself, in bytes: what its texts and lists have allocated,
/// with what each allocation costs. A few nanoseconds per text.
[[nodiscard]] std::size_t HeldBytes(const Body& body);
[[nodiscard]] std::size_t HeldBytes(const Record& record);
[[nodiscard]] std::size_t HeldBytes(const Rejection& rejection);
[[nodiscard]] std::size_t HeldBytes(const ScopeUpdate& update);
[[nodiscard]] std::size_t HeldBytes(const OperatorRequest& request);
[[nodiscard]] std::size_t HeldBytes(const std::string& text);
[[nodiscard]] std::size_t HeldBytes(const Value& value);
[[nodiscard]] std::size_t HeldBytes(const MotionTelemetry& motion);
[[nodiscard]] std::size_t HeldBytes(const StatusTelemetry& status);
[[nodiscard]] std::size_t HeldBytes(const SystemHealth& health);
[[nodiscard]] std::size_t HeldBytes(const UsageTelemetry& usage);
[[nodiscard]] std::size_t HeldBytes(const ConsumableStatus& status);
[[nodiscard]] std::size_t HeldBytes(const SpatialDirectiveStatus& status);
[[nodiscard]] std::size_t HeldBytes(const RcanState& state);
[[nodiscard]] std::size_t HeldBytes(const uncrew::Value& value);

}  // namespace uplink::model
