#pragma once

#include <memory>
#include <optional>
#include <string>

#include "tests/simulation/world.h"
#include "tests/support/fake_store.h"

namespace uplink::simulation {

/// The fake store on a database that outlives the processes. It can refuse records for good.
class FakeBackend final : public Backend {
 public:
  /// Planted faults: a cursor that may be lowered; changes of presence that no cursor guards.
  enum class Cursor : std::uint8_t { kTrue, kMayFall, kNoneForPresence };
  explicit FakeBackend(Cursor cursor = Cursor::kTrue) : cursor_(cursor) {}

  storage::Store& Reopen(const storage::ProcessId& process) override;
  std::optional<std::string> Compare(const Recorder& recorder) override;
  storage::Reader& Rows() override { return *store_; }

 private:
  const Cursor cursor_;
  testing::FakeDatabase database_;
  std::unique_ptr<testing::FakeStore> store_;
};

}  // namespace uplink::simulation
