#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/view/foreign_glances.h"
#include "server/view/queries.h"

// The live parts of robots that other processes hold, and the versions that they reported: those
// processes keep them in the store.
namespace uplink::view {

/// The RURIs of the robots that other processes hold, ascending.
[[nodiscard]] std::vector<std::string> ForeignOf(const std::vector<RobotView>& robots);

/// Fills in what was read for `foreign`, the RURIs that ForeignOf gave. Returns how
/// many of `robots`, from the first, are complete: 0 only if they are not in the order of their
/// RURIs, and then the first one must be read alone.
[[nodiscard]] std::size_t PutForeign(const std::vector<std::string>& foreign,
                                     const ForeignRead& read, std::vector<RobotView>& robots);

}  // namespace uplink::view
