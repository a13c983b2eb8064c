#include "storage/migration.h"

#include <algorithm>
#include <cstddef>

namespace uplink::storage {

absl::Status CheckOldest(std::string_view store, std::int64_t oldest, std::int64_t newest,
                         std::int64_t ours) {
  if (ours >= oldest) return absl::OkStatus();
  std::string text(store);
  text += " has schema version " + std::to_string(newest) +
          ", which shuts out programs of versions below " + std::to_string(oldest) +
          ", and this program's is " + std::to_string(ours) + ": run a newer uplinkd";
  return absl::UnimplementedError(text);
}

absl::Status TablesWithoutSteps(std::string_view store) {
  return absl::FailedPreconditionError(
      std::string(store) +
      " is damaged: it has tables, and schema_migrations does not say by which steps they were"
      " made; restore it from a backup");
}

absl::StatusOr<std::span<const Migration>> CheckApplied(std::string_view store,
                                                        std::span<const AppliedStep> applied,
                                                        std::span<const Migration> ours) {
  std::int64_t oldest = 0;
  const std::size_t common = std::min(applied.size(), ours.size());
  for (std::size_t i = 0; i < applied.size(); ++i) {
    const AppliedStep& step = applied[i];
    if (step.oldest == 0) {
      return absl::UnimplementedError(
          std::string(store) +
          " was made by an earlier build, and this program cannot bring it up: give it an empty"
          " store, or run that build");
    }
    oldest = std::max(oldest, step.oldest);
    if (i < common && (step.version != ours[i].version || step.sha256 != ours[i].sha256)) {
      return absl::UnimplementedError(std::string(store) + " was migrated by another " +
                                      ours[i].name +
                                      " than this program's; restore it from a backup");
    }
  }
  if (!applied.empty()) {
    absl::Status let_in =
        CheckOldest(store, oldest, applied.back().version, static_cast<std::int64_t>(ours.size()));
    if (!let_in.ok()) return let_in;
  }
  return ours.subspan(common);
}

}  // namespace uplink::storage
