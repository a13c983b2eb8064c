#pragma once

#include <string>
#include <string_view>

namespace uplink::store {

/// The boot of the kernel, as the kernel has it or else as the service manager does: one name for
/// both. Empty if neither knows.
[[nodiscard]] std::string BootId(std::string_view from_kernel, std::string_view from_manager);

/// This life of this process, wherever it runs: the boot of its kernel, its namespace of process
/// numbers, its number and when it started. Empty where the kernel does not say.
[[nodiscard]] std::string LifeOfThisProcess();

/// True if the process that had this life is not there any more, as surely as this process can see
/// it: it ran under the same boot of the kernel and in the same namespace, and no process there has
/// its number and start. False for whatever cannot be seen from here.
[[nodiscard]] bool IsGone(std::string_view life);

/// The name of this machine; `localhost` where it has none.
[[nodiscard]] std::string HostName();

}  // namespace uplink::store
