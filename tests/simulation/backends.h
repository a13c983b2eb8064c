#pragma once

#include <memory>
#include <optional>
#include <string>

#include "tests/simulation/world.h"
#include "tests/support/fake_shared_items.h"
#include "tests/support/fake_store.h"

namespace uplink::simulation {

/// The fake store on a database that outlives the processes. It can refuse records for good.
class FakeBackend final : public Backend {
 public:
  /// Planted faults: a cursor that may be lowered; changes of presence that no cursor guards; rows
  /// of robots that batches make; Rejects that go for their age before they were confirmed; holds
  /// that count for their owner whenever they began.
  enum class Fault : std::uint8_t {
    kNone,
    kCursorMayFall,
    kNoCursorForPresence,
    kBatchesMakeRobots,
    kRejectsGoForTheirAge,
    kHoldsOfOwnerAlone,
  };
  explicit FakeBackend(Fault fault = Fault::kNone) : fault_(fault) {
    if (fault_ == Fault::kHoldsOfOwnerAlone) database_.HoldByOwnerAlone();
  }

  storage::Store& Reopen(const storage::ProcessId& process) override;
  std::optional<std::string> Compare(const Recorder& recorder) override;
  storage::Reader& Rows() override { return *store_; }
  storage::SharedItems& Items() override { return items_; }
  void DeleteRobotRow(const std::string& ruri) override { database_.DeleteRobotRow(ruri); }
  void RemoveRobot(const std::string& ruri) override { database_.RemoveRobot(ruri); }
  void AfterRetain() override {
    if (fault_ == Fault::kRejectsGoForTheirAge) database_.ForgetRejects();
  }
  [[nodiscard]] bool CanGoBack() const override { return true; }
  void KeepCopy() override;
  bool GoBack() override;

 private:
  const Fault fault_;
  testing::FakeDatabase database_;
  /// A standby that lacks the last commits.
  testing::FakeDatabase copy_;
  bool has_copy_ = false;
  testing::FakeSharedItems items_{database_};
  std::unique_ptr<testing::FakeStore> store_;
};

}  // namespace uplink::simulation
