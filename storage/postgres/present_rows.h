#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>
#include <vector>

#include "schema/model/reports.h"
#include "schema/model/spatial.h"
#include "storage/postgres/connection.h"
#include "storage/postgres/parameters.h"
#include "storage/types.h"

// What is present by its key: a batch writes each key once, whatever it reported of it, in order of
// the keys. Views and pointers lead into the batch.
namespace uplink::storage::postgres {

class ActiveFaultRows final {
 public:
  void Raise(const CommitRecord& record, const model::Fault& fault, std::int32_t place);
  void Clear(const CommitRecord& record, const model::Fault& fault);
  void MoveInto(std::vector<Call>& calls) const;

 private:
  using Key = std::tuple<std::string_view, std::string_view, std::string_view>;
  struct State {
    /// The row that is there goes.
    bool clears = false;
    /// The last raise since; nothing if the fault is clear.
    const CommitRecord* record = nullptr;
    const model::Fault* fault = nullptr;
    /// Of the first raise since.
    SystemTime raised_at;
    std::int32_t place = 0;
  };
  static Key KeyOf(const CommitRecord& record, const model::Fault& fault) {
    return {record.robot->ruri, fault.fault_id, fault.source};
  }

  std::map<Key, State> states_;
};

/// Shapes or objects: what they have in common.
template <typename Body>
class PresentRows final {
 public:
  /// `expires_ms` is the effective one.
  void Upsert(const CommitRecord& record, const Body& body, std::string_view id,
              std::int64_t expires_ms, std::int32_t place);
  /// `ruri` and `id` must live as long as the batch.
  void Delete(std::string_view ruri, std::string_view id);
  void MoveInto(std::vector<Call>& calls) const;

 private:
  struct State {
    /// The row that is there goes if it expires by this time; kAlways: whenever.
    std::int64_t goes_if_expired_ms = 0;
    const CommitRecord* record = nullptr;
    const Body* body = nullptr;
    std::int64_t expires_ms = 0;
    /// Of the upsert that made the id present, if the batch did.
    SystemTime first_at;
    std::int32_t place = 0;
  };
  using States = std::map<std::pair<std::string_view, std::string_view>, State>;

  static Call UpsertCall(const States& states);

  States states_;
};

using ShapeRows = PresentRows<model::ReportedShape>;
using ObjectRows = PresentRows<model::Object>;

}  // namespace uplink::storage::postgres
