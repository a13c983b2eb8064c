#include <mutex>
#include <string>

#include "tests/support/fake_database.h"

namespace uplink::testing {

void FakeKinds::CopyRowsOf(const FakeKinds& other) {
  events_ = other.events_;
  messages_ = other.messages_;
  reports_ = other.reports_;
  scope_updates_ = other.scope_updates_;
  requests_ = other.requests_;
  runs_ = other.runs_;
  changes_ = other.changes_;
  shapes_.CopyRowsOf(other.shapes_);
  objects_.CopyRowsOf(other.objects_);
  latest_ = other.latest_;
  runs_closed_ = other.runs_closed_;
}

void FakeDatabase::CopyRowsOf(const FakeDatabase& other) {
  const std::scoped_lock lock(mutex_, other.mutex_);
  robots_ = other.robots_;
  faults_history_ = other.faults_history_;
  quarantine_ = other.quarantine_;
  kinds_.CopyRowsOf(other.kinds_);
  presence_ = other.presence_;
  connections_ = other.connections_;
  access_ = other.access_;
  live_ = other.live_;
  leases_ = other.leases_;
  topics_ = other.topics_;
  applications_ = other.applications_;
  entries_ = other.entries_;
  transactions_ = other.transactions_;
  epochs_ = other.epochs_;
  epochs_in_each_row_ = other.epochs_in_each_row_;
  ++server_runs_;
}

std::string FakeDatabase::ServerRun() const {
  const std::lock_guard lock(mutex_);
  return std::to_string(server_runs_);
}

}  // namespace uplink::testing
