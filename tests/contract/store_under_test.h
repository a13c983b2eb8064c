#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "storage/access_store.h"
#include "storage/clock_marks.h"
#include "storage/forget_requests.h"
#include "storage/leases.h"
#include "storage/reader.h"
#include "storage/robot_removal.h"
#include "storage/shared_items.h"
#include "storage/store.h"
#include "storage/store_rules.h"
#include "storage/topic_leases.h"

namespace uplink::testing {

/// One database of one kind of store, with what the contract suite must be able to make happen.
class StoreUnderTest {
 public:
  virtual ~StoreUnderTest() = default;

  /// The store as process `number` has it; the same object at each call. A process that is not used
  /// any more is one that was killed.
  virtual storage::Store& Process(std::uint8_t number) = 0;
  virtual storage::Reader& reader() = 0;
  /// The leases as process `number` has them; null for a store that one process has at a time.
  virtual storage::Leases* LeasesOf(std::uint8_t number) = 0;

  /// The leases on topics as process `number` has them.
  virtual storage::TopicLeases& TopicLeasesOf(std::uint8_t number) = 0;

  /// The mark of the clock, as an operator or a server has it beside the writers; null for the
  /// fake, which has none.
  virtual storage::ClockMarks* clock_marks() = 0;
  /// What takes robots out of it, beside the writers; null for the fake.
  virtual storage::RobotRemoval* removal() = 0;
  virtual storage::ForgetRequests& forget_requests() = 0;
  /// What operators decide, beside the writers.
  virtual storage::AccessStore& access() = 0;
  /// The shapes and objects that other robots may see, beside the writers.
  virtual storage::SharedItems& shared_items() = 0;
  /// As if a session of its own had changed a shared item so often.
  virtual void AddChanges(std::size_t count) = 0;
  /// Takes the robot out of the store, with what it has now.
  virtual void RemoveRobot(const std::string& ruri) = 0;
  /// So much time passes for the requests that there are.
  virtual void AgeForgetRequests(std::chrono::seconds time) = 0;
  /// The tables that have a column `ruri`, by name; none for the fake.
  virtual std::vector<std::string> TablesOfRobots() = 0;
  /// As if a row of the robot's quarantine had gone for its bound.
  virtual void NoteQuarantineDropped(const std::string& ruri) = 0;

  /// The next write of the process fails after its work and before its commit: nothing is kept.
  virtual void FailNextWrite(std::uint8_t number) = 0;
  /// The next write of the process is kept, and its answer is an error.
  virtual void LoseNextAnswer(std::uint8_t number) = 0;
  /// The robot's row in `robots` goes, by another hand than a process's; all else of it stays.
  virtual void DeleteRobotRow(const std::string& ruri) = 0;
  /// The database itself refuses raises of this fault.
  virtual void RefuseFault(const std::string& fault_id) = 0;
  /// Ends every connection and makes new ones: what is there afterwards lay in the database.
  virtual void Reopen() = 0;
};

/// Takes the robot out of a store that lasts, whatever its epoch is.
void RemoveFrom(storage::RobotRemoval& removal, const std::string& ruri);

struct StoreKind {
  const char* name;
  std::function<std::unique_ptr<StoreUnderTest>(const storage::StoreRules& rules)> make;
};

[[nodiscard]] StoreKind FakeKind();
[[nodiscard]] StoreKind SqliteKind();
[[nodiscard]] StoreKind PostgresKind();

}  // namespace uplink::testing
