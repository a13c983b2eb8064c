#pragma once

namespace uplink::store {

/// The kernel says that something (an NTP daemon, the hypervisor) keeps its civil clock
/// synchronised. False also where it may not be asked. Any thread.
[[nodiscard]] bool KernelClockSynchronised();

}  // namespace uplink::store
