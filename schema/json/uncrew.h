#pragma once

#include <cstdint>
#include <string>

#include <boost/json.hpp>

#include "schema/base/clock.h"
#include "schema/model/uncrew/value.h"

/// What drones say, by the contract's names with capitals in place of underscores. What is not
/// known is absent, enumerants are names, `unrecognized_77` if they have none. Pure; any thread.
namespace uplink::json {

/// When a sample was taken and when it came. A value.
struct SampleTimes {
  /// Unix microseconds by the drone's clock; 0: unknown, and then absent.
  std::int64_t sampled_at_us = 0;
  SystemTime received_at;
};

/// One type as `Robot.uncrew` shows it under its name, and under its key if it has one, with
/// `sampledAt`, to the microsecond, and `receivedAt`. Of a set each item, by its id.
[[nodiscard]] boost::json::object Render(const model::uncrew::Value& value,
                                         const SampleTimes& times);

/// What an event says of such a value: the text of an object.
[[nodiscard]] std::string Text(const model::uncrew::Value& value);

/// `{from, to}` of two values of a type that is durable on change: a mode, whether it is armed, or
/// the mission item whole. Without `from` if `before` is null.
[[nodiscard]] std::string ChangeText(const model::uncrew::Value* before,
                                     const model::uncrew::Value& now);

}  // namespace uplink::json
