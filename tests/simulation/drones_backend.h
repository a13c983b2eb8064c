#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "storage/leases.h"
#include "storage/reader.h"
#include "storage/store.h"
#include "tests/support/fake_leases.h"
#include "tests/support/fake_store.h"

namespace uplink::simulation {

/// The store of a world of drones: each life of a process opens it anew.
class DronesBackend {
 public:
  virtual ~DronesBackend() = default;
  /// How many processes may have it at a time.
  [[nodiscard]] virtual std::size_t places() const = 0;
  /// A store for a new process at that place; the one before there is gone as after a kill.
  virtual storage::Store& Open(std::size_t place, const storage::ProcessId& process) = 0;
  /// Reads beside the store that was opened last at that place, until the next one is.
  virtual storage::Reader& ReaderAt(std::size_t place) = 0;
  /// Null where one process alone has the store.
  virtual std::unique_ptr<storage::Leases> LeasesOf(const storage::ProcessId& process) = 0;
  /// The connection at that place ends, and what is connected to anew may be another store.
  virtual void Break(std::size_t /*place*/) {}
};

/// The fake store, which two processes share.
class FakeDronesBackend final : public DronesBackend {
 public:
  /// Planted faults: samples that were stored before a claim are taken once more after it; samples
  /// are taken under whatever claim.
  enum class Fault : std::uint8_t { kNone, kSamplesForgotten, kClaimsNotCompared };
  explicit FakeDronesBackend(Fault fault = Fault::kNone) : fault_(fault) {
    if (fault == Fault::kSamplesForgotten) database_.ForgetSamplesAtClaims();
  }

  [[nodiscard]] std::size_t places() const override { return stores_.size(); }
  storage::Store& Open(std::size_t place, const storage::ProcessId& process) override {
    stores_[place] = std::make_unique<testing::FakeStore>(database_, process);
    stores_[place]->SetRules({.samples_without_claim = fault_ == Fault::kClaimsNotCompared});
    return *stores_[place];
  }
  storage::Reader& ReaderAt(std::size_t place) override { return *stores_[place]; }
  std::unique_ptr<storage::Leases> LeasesOf(const storage::ProcessId& process) override {
    return std::make_unique<testing::FakeLeases>(database_, process);
  }
  void Break(std::size_t place) override { stores_[place]->Break(); }

 private:
  const Fault fault_;
  testing::FakeDatabase database_;
  std::array<std::unique_ptr<testing::FakeStore>, 2> stores_;
};

}  // namespace uplink::simulation
