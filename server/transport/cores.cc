#include "server/transport/cores.h"

#include <algorithm>
#include <thread>

#include <sched.h>

namespace uplink::transport {

std::size_t UsableCores() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  // More cores than the set has room for.
  if (sched_getaffinity(0, sizeof cores, &cores) != 0) {
    return std::max(1U, std::thread::hardware_concurrency());
  }
  return std::max<std::size_t>(1, static_cast<std::size_t>(CPU_COUNT(&cores)));
}

}  // namespace uplink::transport
