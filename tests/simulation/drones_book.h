#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "storage/batch.h"
#include "storage/claim.h"
#include "storage/identity.h"
#include "storage/outcome.h"
#include "storage/reader.h"
#include "tests/simulation/sim_drone.h"

namespace uplink::simulation {

/// What drones made, and what transactions really applied. It checks what it is told: each
/// sample is stored once, under the drone's claim; changes form a chain; a set that is stored
/// leaves exactly what is in it.
///
/// Thread: confined to its caller.
class DronesBook final {
 public:
  using Violation = std::function<void(const std::string&)>;
  explicit DronesBook(Violation violation) : violation_(std::move(violation)) {}

  void NoteMade(const std::string& ruri, const DroneSampleRef& sample);
  void NoteClaims(const storage::ProcessId& process,
                  std::span<const storage::ClaimRequest> requests,
                  std::span<const storage::ClaimResult> results);
  void NoteCommit(const storage::ProcessId& process, const storage::Batch& batch,
                  std::span<const storage::Outcome> outcomes);

  /// It is stored, or lies in quarantine.
  [[nodiscard]] bool Has(const std::string& ruri, const DroneSample& sample) const;
  /// Ids of a set that the store has as active, or open.
  [[nodiscard]] const std::set<std::string>& Active(const std::string& ruri, SampleType set);
  /// The last mode whose change is stored; nothing if none is.
  [[nodiscard]] std::optional<std::string> Mode(const std::string& ruri, SampleType mode) const;
  /// What lies in the store, against the book; a sentence for the first difference.
  [[nodiscard]] std::optional<std::string> Compare(storage::Reader& reader) const;

  /// Claims that took the drone from another process, or anew.
  [[nodiscard]] std::uint64_t claims() const { return claims_; }
  /// Samples that were judged under a claim that was over.
  [[nodiscard]] std::uint64_t fenced() const { return fenced_; }
  /// Samples that were offered to the store once more.
  [[nodiscard]] std::uint64_t duplicates() const { return duplicates_; }

 private:
  /// Number of the type as it was stored, and digest.
  using Key = std::pair<std::uint32_t, storage::SampleDigest>;
  struct OfDrone {
    std::map<storage::SampleDigest, DroneSampleRef> made;
    std::optional<std::pair<storage::ProcessId, storage::Epoch>> claim;
    std::set<Key> stored;
    /// Kind and time of each event; texts of messages.
    std::multiset<std::pair<std::string, std::int64_t>> events;
    std::multiset<std::string> messages;
    std::size_t fault_reports = 0;
    std::size_t quarantined = 0;
    std::map<SampleType, std::set<std::string>> active;
    /// By kind of event, the JSON to which it changed last.
    std::map<std::string, std::string> modes;
  };
  /// The records of one sample, with its drone.
  struct Committed {
    const std::string& ruri;
    OfDrone& drone;
    std::span<const storage::CommitRecord> records;
  };

  void NoteSample(const storage::ProcessId& process, const Committed& sample,
                  storage::OutcomeKind outcome);
  void NoteStored(const Committed& sample);
  void NoteRecord(const Committed& sample, const storage::CommitContent& content);
  void NoteChange(const Committed& sample, const std::string& kind, const std::string& detail);
  void Toggle(const Committed& sample, SampleType set, const std::string& id, bool active);
  void CheckSet(const Committed& sample);
  [[nodiscard]] std::string NameOf(const Committed& sample) const;
  [[nodiscard]] std::optional<std::string> CompareOne(const std::string& ruri, const OfDrone& drone,
                                                      storage::Reader& reader) const;

  const Violation violation_;
  std::map<std::string, OfDrone> drones_;
  std::uint64_t claims_ = 0;
  std::uint64_t fenced_ = 0;
  std::uint64_t duplicates_ = 0;
};

}  // namespace uplink::simulation
