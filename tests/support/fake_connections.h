#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "schema/base/clock.h"
#include "storage/connection.h"
#include "storage/identity.h"
#include "storage/rows.h"
#include "tests/support/fake_present.h"

namespace uplink::testing {

/// The connections of robots that a FakeDatabase has. Confined to its lock.
class FakeConnections final {
 public:
  /// As storage::Batch::connections, of a robot that has a row. `entry` is above that of all rows
  /// before.
  void Write(const storage::ConnectionItem& item, std::uint64_t entry);
  /// To the bound, after all of a batch are written.
  void Trim(const std::string& ruri);
  void DeleteAll(const std::string& ruri);

  /// As storage::Store; `self` is the process that asks.
  [[nodiscard]] std::vector<storage::ProcessId> Processes(const storage::ProcessId& self) const;
  std::size_t End(const storage::ProcessId& process, SystemTime at);
  /// As storage::Store::Retain, with the first day that is kept.
  std::size_t EraseHistory(SystemTime until);

  [[nodiscard]] const std::vector<FakeEntry<storage::ConnectionRow>>& rows() const { return rows_; }

 private:
  /// In the order of their entries.
  std::vector<FakeEntry<storage::ConnectionRow>> rows_;
};

}  // namespace uplink::testing
