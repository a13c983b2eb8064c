#pragma once

#include <string>

#include "server/front/tls/tls_engine.h"
#include "tests/support/memory_tls.h"

namespace uplink::front {

/// Both sides go on until the handshake is over or has failed at the engine, or the client says
/// nothing more. Returns the engine's last step.
[[nodiscard]] inline TlsEngine::Step ShakeHands(TlsEngine& engine, TlsBuffers& buffers,
                                                testing::MemoryTls& client) {
  auto step = TlsEngine::Step::kMore;
  while (step == TlsEngine::Step::kMore) {
    const std::string heard = client.Step(buffers.out);
    buffers.out.clear();
    if (heard.empty()) break;
    buffers.in = heard;
    step = engine.Handshake();
  }
  return step;
}

}  // namespace uplink::front
