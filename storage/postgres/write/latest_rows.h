#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "storage/postgres/link/connection.h"
#include "storage/tables/latest.h"
#include "storage/tables/missions.h"
#include "storage/tables/set_aside.h"

// The latest of its key: a batch writes each key once, in order of the keys. Views and pointers
// lead into the batch.
namespace uplink::storage::postgres {

class MissionRunRows final {
 public:
  void Add(const MissionReport& report);
  void MoveInto(std::vector<StoreCall>& calls) const;

 private:
  using Key = std::tuple<std::string_view, std::string_view, std::string_view>;

  std::map<Key, MissionRun> runs_;
};

class LatestRows final {
 public:
  void Add(const CommitRecord& record, LatestKind kind) {
    last_[{record.robot->ruri, kind}] = &record;
  }
  void MoveInto(std::vector<StoreCall>& calls) const;

 private:
  std::map<std::pair<std::string_view, LatestKind>, const CommitRecord*> last_;
};

/// Changes of presence: their history, and the last of each robot.
class PresenceRows final {
 public:
  void Add(const PresenceItem& item, std::int32_t place) { changes_.push_back({&item, place}); }
  void MoveInto(std::vector<StoreCall>& calls) const;

 private:
  std::vector<PresenceChange> changes_;
};

class GapRows final {
 public:
  void Add(const GapItem& gap, std::int32_t place);
  void MoveInto(std::vector<StoreCall>& calls) const;

 private:
  std::map<std::tuple<std::string_view, model::SessionId, model::Seq>, Gap> gaps_;
};

}  // namespace uplink::storage::postgres
