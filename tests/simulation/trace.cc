#include "tests/simulation/trace.h"

namespace uplink::simulation {
namespace {

/// FNV-1a's prime for 64 bits.
constexpr std::uint64_t kPrime = 0x0000'0100'0000'01B3;

}  // namespace

void Trace::Mix(std::uint8_t byte) { digest_ = (digest_ ^ byte) * kPrime; }

void Trace::Add(std::string_view line) {
  for (const char byte : line) Mix(static_cast<std::uint8_t>(byte));
  Mix('\n');
  if (show_) show_(line);
}

}  // namespace uplink::simulation
