#pragma once

#include <utility>
#include <vector>

#include "server/robot/commit_client.h"

namespace uplink::journal {

/// What may not go to the store, where registration is closed. A value.
template <typename Entry>
struct KeptOut {
  /// Of robots that are not judged yet.
  std::vector<Entry> wait;
  std::vector<Entry> refused;
};

/// Takes such entries out of `entries`, in their order; `registration_of` gives an entry's.
template <typename Entry, typename RegistrationOf>
[[nodiscard]] KeptOut<Entry> TakeKeptOut(std::vector<Entry>& entries,
                                         const RegistrationOf& registration_of) {
  KeptOut<Entry> out;
  std::erase_if(entries, [&](Entry& entry) {
    const robot::Registration registration = registration_of(entry);
    if (registration == robot::Registration::kFits) return false;
    const bool waits = registration == robot::Registration::kUnjudged;
    (waits ? out.wait : out.refused).push_back(std::move(entry));
    return true;
  });
  return out;
}

}  // namespace uplink::journal
