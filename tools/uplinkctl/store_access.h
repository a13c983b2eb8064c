#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/admin/asker.h"
#include "storage/access_store.h"
#include "storage/reader.h"

namespace uplink::ctl {

/// What operators decide, in a store that is named by its URL. `clock` outlives it.
///
/// Errors: of TargetOf, and of the store.
[[nodiscard]] absl::StatusOr<std::unique_ptr<storage::AccessStore>> OpenAccess(
    const std::string& url, const std::string& password_file, const Clock& clock);

/// What a store that is named by its URL has for readers. `clock` outlives it.
///
/// Errors: of TargetOf, and of the store.
[[nodiscard]] absl::StatusOr<std::unique_ptr<storage::Reader>> OpenReader(
    const std::string& url, const std::string& password_file, const Clock& clock);

/// The user of this process, for the audit: `ann`, or `root, by sudo of ann`.
[[nodiscard]] admin::Asker ThisUser();

/// Adds to the audit what this process has done to the store: a word of server/admin/actions.h, and
/// what it was about. An error becomes a line on standard error, since the work is done.
void NoteDone(const std::string& url, const std::string& password_file, std::string_view action,
              const std::string& target);

}  // namespace uplink::ctl
