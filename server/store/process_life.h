#pragma once

#include <string>
#include <string_view>

namespace uplink::store {

/// The id of the kernel's boot, from the kernel, otherwise from the service manager, in one form.
/// Empty if neither knows.
[[nodiscard]] std::string BootId(std::string_view from_kernel, std::string_view from_manager);

/// Identifies this run of this process anywhere: the boot of its kernel, its namespace of process
/// numbers, its number, and when it started. Empty if the kernel does not say.
[[nodiscard]] std::string LifeOfThisProcess();

/// True if the process with this life has surely ended: it ran under the same boot of the kernel
/// and in the same namespace, and no process there has its number and start. False for processes
/// that cannot be seen from here.
[[nodiscard]] bool IsGone(std::string_view life);

/// The name of this machine; `localhost` where it has none.
[[nodiscard]] std::string HostName();

}  // namespace uplink::store
