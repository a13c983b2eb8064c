#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "schema/base/clock.h"
#include "tests/support/certificates.h"

namespace uplink::bench {

/// A robot that is new to the server, at an address that is new to it too.
struct NewRobot {
  std::uint16_t port = 0;
  std::string server_ca;
  testing::KeyPair identity;
};
inline constexpr const char* kNewRobotSource = "127.0.0.200";
/// A robot that gets in later counts as shut out.
inline constexpr milliseconds kGetsInWithin{10'000};

/// How long it takes until one durable message of its own is acked; it tries again and again, for
/// kGetsInWithin, after which there is no value.
///
/// Thread: any; blocks.
[[nodiscard]] std::optional<milliseconds> TimeToGetIn(const NewRobot& robot, const Clock& clock);

}  // namespace uplink::bench
