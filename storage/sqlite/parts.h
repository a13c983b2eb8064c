#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "storage/access_store.h"
#include "storage/clock_marks.h"
#include "storage/forget_store.h"
#include "storage/shared_items.h"
#include "storage/sqlite/damage.h"
#include "storage/topic_leases.h"

// What a process does with an SQLite file beside its writer and its reader, each over a connection
// of its own. The file must be there and migrated. A write is short, and takes no lock but SQLite's
// own, so that an operator may make it while a server runs.
//
// Errors: kFailedPrecondition, naming the path: no file, not ours, not this program's schema
//         version, or another name of it (FileLock::Join). Of the calls, as of the interface.
// Thread: as of the interface.
namespace uplink::storage::sqlite {

[[nodiscard]] absl::StatusOr<std::unique_ptr<ClockMarks>> OpenClockMarks(
    const std::string& path, DamagePtr damage = nullptr);

/// Its program reads each second: nothing wakes it.
[[nodiscard]] absl::StatusOr<std::unique_ptr<AccessStore>> OpenAccessStore(
    const std::string& path, DamagePtr damage = nullptr);

/// Requests go by the time of the machine.
[[nodiscard]] absl::StatusOr<std::unique_ptr<ForgetStore>> OpenForgetStore(
    const std::string& path, DamagePtr damage = nullptr);

/// Only reads. All changes have one writer, and no times: one transaction writes at a time.
[[nodiscard]] absl::StatusOr<std::unique_ptr<SharedItems>> OpenSharedItems(
    const std::string& path, DamagePtr damage = nullptr);

/// One process has the store at a time. Leases that earlier processes took count all the same.
[[nodiscard]] absl::StatusOr<std::unique_ptr<TopicLeases>> OpenTopicLeases(
    const std::string& path, const ProcessId& process, DamagePtr damage = nullptr);

}  // namespace uplink::storage::sqlite
