#pragma once

#include <cstdint>
#include <string_view>

#include "schema/model/mission.h"
#include "schema/model/rejection.h"
#include "schema/model/reports.h"
#include "storage/postgres/connection.h"
#include "storage/postgres/parameters.h"
#include "storage/types.h"

// Rows that a batch adds to the histories: a column is an array, a table one statement. `place` is
// the row's place in the batch, from which its entry comes.
namespace uplink::storage::postgres {

/// Columns that all histories of robots' messages have.
class ReportColumns final {
 public:
  void Add(const CommitRecord& record, std::int32_t place);
  void MoveInto(Parameters& parameters);
  [[nodiscard]] bool empty() const { return ruri_.size() == 0; }

 private:
  Array ruri_{Type::kText}, received_at_{Type::kTime}, place_{Type::kInt4}, fleet_{Type::kText},
      session_{Type::kUuid}, seq_{Type::kInt8};
};

class FaultHistoryRows final {
 public:
  void Add(const CommitRecord& record, const model::Fault& fault, std::int32_t place);
  void MoveInto(std::vector<Call>& calls);

 private:
  ReportColumns common_;
  Array sampled_ms_{Type::kInt8}, fault_id_{Type::kText}, source_{Type::kText},
      severity_{Type::kInt4}, active_{Type::kBool}, category_{Type::kText},
      description_{Type::kText}, suggested_action_{Type::kText};
};

class EventRows final {
 public:
  void Add(const CommitRecord& record, const model::EventTelemetry& event, std::int32_t place);
  void MoveInto(std::vector<Call>& calls);

 private:
  ReportColumns common_;
  Array sampled_ms_{Type::kInt8}, kind_{Type::kText}, detail_{Type::kText};
};

class MessageRows final {
 public:
  void Add(const CommitRecord& record, const model::Message& message, std::int32_t place);
  void MoveInto(std::vector<Call>& calls);

 private:
  ReportColumns common_;
  Array sampled_ms_{Type::kInt8}, level_{Type::kInt4}, message_{Type::kText};
};

class MissionReportRows final {
 public:
  /// `report_json` is the report's own text.
  void Add(const CommitRecord& record, const model::MissionRunStatus& report,
           std::string_view report_json, std::int32_t place);
  void MoveInto(std::vector<Call>& calls);

 private:
  ReportColumns common_;
  Array mission_id_{Type::kText}, run_id_{Type::kText}, status_{Type::kInt4}, report_{Type::kText};
};

/// How much of a rejected payload its row keeps: less where the database refuses more.
enum class QuarantineDetail : std::uint8_t { kAll, kWithoutPayload, kBare };

class QuarantineRows final {
 public:
  void Add(const CommitRecord& record, const model::Rejection& rejection, QuarantineDetail detail,
           std::int32_t place);
  void MoveInto(std::vector<Call>& calls);

 private:
  ReportColumns common_;
  Array reason_{Type::kInt4}, field_{Type::kText}, detail_{Type::kText},
      payload_bytes_{Type::kInt8}, payload_{Type::kBytes};
};

}  // namespace uplink::storage::postgres
