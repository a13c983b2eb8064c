#pragma once

#include <memory>

#include "tests/simulation/drones_backend.h"
#include "tests/simulation/sqlite_backend.h"

namespace uplink::simulation {

/// The real SQLite store on a file of its own, which one process has at a time.
class SqliteDronesBackend final : public DronesBackend {
 public:
  /// A planted fault: samples that were stored before a restart are taken once more after it.
  enum class Fault : std::uint8_t { kNone, kSamplesForgotten };
  explicit SqliteDronesBackend(Fault fault = Fault::kNone) : fault_(fault) {}

  [[nodiscard]] std::size_t places() const override { return 1; }
  storage::Store& Open(std::size_t /*place*/, const storage::ProcessId& process) override {
    storage::Store& store = backend_.Reopen(process);
    if (fault_ == Fault::kSamplesForgotten) backend_.ForgetSamples();
    reader_ = &backend_.Rows();
    return store;
  }
  storage::Reader& ReaderAt(std::size_t /*place*/) override { return *reader_; }
  std::unique_ptr<storage::Leases> LeasesOf(const storage::ProcessId& /*process*/) override {
    return nullptr;
  }

 private:
  const Fault fault_;
  SqliteBackend backend_;
  storage::Reader* reader_ = nullptr;
};

}  // namespace uplink::simulation
