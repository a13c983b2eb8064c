#pragma once

#include <cstddef>
#include <cstdint>

#include "tests/component/front/front_client.h"
#include "tests/support/relay_world.h"

namespace uplink::testing {

/// A world that takes TLS 1.2 too.
[[nodiscard]] RelayWorld::Options With12();

/// A robot of this number connects and has one message stored, within `patience`.
[[nodiscard]] bool ServesNewRobot(const RelayWorld& world, int number,
                                  std::chrono::milliseconds patience = kPatience);

/// Memory that the process has now.
[[nodiscard]] std::size_t ResidentBytes();
/// Whether what a process takes says something about its code.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kMemoryCounts = false;
#else
inline constexpr bool kMemoryCounts = true;
#endif

/// While it lives, the process seems to have so many descriptors at most.
class DescriptorLimit final {
 public:
  explicit DescriptorLimit(std::size_t descriptors_max);
  ~DescriptorLimit();
  DescriptorLimit(const DescriptorLimit&) = delete;
  DescriptorLimit& operator=(const DescriptorLimit&) = delete;

 private:
  std::uint64_t before_ = 0;
};

}  // namespace uplink::testing
