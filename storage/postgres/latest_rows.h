#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "schema/model/mission.h"
#include "storage/postgres/connection.h"
#include "storage/reader.h"
#include "storage/types.h"

// The latest of its key: a batch writes each key once, in order of the keys. Views and pointers
// lead into the batch.
namespace uplink::storage::postgres {

class MissionRunRows final {
 public:
  void Add(const CommitRecord& record, const model::MissionRunStatus& report,
           std::string report_json, std::int32_t place);
  void MoveInto(std::vector<Call>& calls) const;

 private:
  struct Run {
    const CommitRecord* last = nullptr;
    model::MissionStatus status = model::MissionStatus::kUnknown;
    std::string latest_json;
    /// The last name that a report of the batch gave; nullptr if none did.
    const std::string* name = nullptr;
    SystemTime first_at;
    std::int32_t place = 0;
    std::int64_t updates = 0;
  };
  using Key = std::tuple<std::string_view, std::string_view, std::string_view>;
  void MoveSome(bool named, std::vector<Call>& calls) const;

  std::map<Key, Run> runs_;
};

class LatestRows final {
 public:
  void Add(const CommitRecord& record, LatestKind kind) {
    last_[{record.robot->ruri, kind}] = &record;
  }
  void MoveInto(std::vector<Call>& calls) const;

 private:
  std::map<std::pair<std::string_view, LatestKind>, const CommitRecord*> last_;
};

/// Changes of presence: their history, and the last of each robot.
class PresenceRows final {
 public:
  void Add(const PresenceItem& item, std::int32_t place) { items_.emplace_back(&item, place); }
  void MoveInto(std::vector<Call>& calls) const;

 private:
  std::vector<std::pair<const PresenceItem*, std::int32_t>> items_;
};

class GapRows final {
 public:
  void Add(const GapItem& gap, std::int32_t place);
  void MoveInto(std::vector<Call>& calls) const;

 private:
  struct Gap {
    const GapItem* first = nullptr;
    std::int32_t place = 0;
    model::Seq last = 0;
  };
  std::map<std::tuple<std::string_view, model::SessionId, model::Seq>, Gap> gaps_;
};

}  // namespace uplink::storage::postgres
