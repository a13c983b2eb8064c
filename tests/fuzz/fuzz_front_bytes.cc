// Any bytes that a robot may send inside TLS, cut anywhere, while time passes and the store works:
// HTTP/2, calls and sessions never crash, what is answered is in order, and in the end everything
// is given back.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/front_bench.h"
#include "tests/fuzz/front_steps.h"
#include "tests/fuzz/input.h"

namespace uplink::fuzz {
namespace {

/// Steps of one input; more would only cost time.
constexpr std::size_t kStepsMax = 400;

void Do(std::uint8_t step, FrontBench& bench, Input& input) {
  FrontWire& wire = *bench.wires().back();
  if (step >= kPlainBytes) return wire.Receive(input.Bytes(step - kPlainBytes + std::size_t{1}));
  switch (static_cast<BytesStep>(step % kBytesSteps)) {
    case BytesStep::kMany:
      return wire.Receive(input.Bytes(input.Word()));
    case BytesStep::kTime:
      return bench.Pass(milliseconds(50) * input.Byte());
    case BytesStep::kWakes:
      return bench.DeliverWakes();
    case BytesStep::kCommit:
      return bench.Commit();
    case BytesStep::kStopReading:
      return wire.StopReading();
    case BytesStep::kReadAgain:
      return wire.ReadAgain();
    case BytesStep::kDrain:
      return bench.Drain(milliseconds(50) * input.Byte());
    case BytesStep::kConnect:
      bench.Connect(input.Byte());
      return;
  }
}

}  // namespace
}  // namespace uplink::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using uplink::fuzz::FrontBench;
  uplink::fuzz::Input input(data, size);
  FrontBench bench;
  bench.Connect(0);
  for (std::size_t steps = 0; input.more() && steps < uplink::fuzz::kStepsMax; ++steps) {
    uplink::fuzz::Do(input.Byte(), bench, input);
    bench.Check();
  }
  bench.End();
  return 0;
}
