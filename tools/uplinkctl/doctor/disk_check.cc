#include "tools/uplinkctl/doctor/disk_check.h"

#include <cstdint>

#include <fmt/core.h>

#include "schema/base/doc_page.h"
#include "server/store/space_judge.h"

namespace uplink::ctl {

Finding DiskFinding(const std::string& place, const storage::DiskSpace& space,
                    std::size_t free_min) {
  constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
  store::SpaceFacts facts;
  facts.free_bytes = space.free_bytes;
  facts.free_min = store::FreeMinOf(free_min, space.total_bytes);
  const std::string text =
      fmt::format("{} has {} MiB free of {}; store.free_min is {} MiB", place,
                  space.free_bytes / kMiB, space.total_bytes / kMiB, facts.free_min / kMiB);
  const std::string remedy =
      "make room, or use a larger disk; see " + DocPage("docs/operate/server.md", "The disk fills");
  switch (store::JudgeSpace(facts)) {
    case store::SpaceState::kEnough:
      return Ok("disk", text);
    case store::SpaceState::kScarce:
      return Warning("disk", text + ": robots that store most are slowed down", remedy);
    case store::SpaceState::kStopped:
      return Error("disk", text + ": below half of it nothing is stored", remedy);
  }
  return {};
}

}  // namespace uplink::ctl
