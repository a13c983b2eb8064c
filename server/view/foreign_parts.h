#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/view/queries.h"
#include "storage/reader.h"

// The live parts of robots that other processes hold: those processes keep them in the store.
namespace uplink::view {

/// The RURIs of those that other processes hold.
[[nodiscard]] std::vector<std::string> ForeignOf(const std::vector<RobotView>& robots);

/// Takes over the live parts that were read of `foreign`, as ForeignOf gave them. Returns for how
/// many of `robots`, from the first.
[[nodiscard]] std::size_t PutForeign(const std::vector<std::string>& foreign,
                                     const storage::Reader::LiveRows& live,
                                     std::vector<RobotView>& robots);

}  // namespace uplink::view
