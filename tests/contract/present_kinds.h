#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "schema/model/record.h"
#include "storage/reader.h"

namespace uplink::testing {

/// The members of a shape or an object that the rules of both look at.
struct PresentSeen {
  model::RobotId robot;
  std::string id;
  std::string name;
  std::int64_t expires_at_ms = 0;
  SystemTime received_at;

  friend bool operator==(const PresentSeen&, const PresentSeen&) = default;
};

struct PresentUpsert {
  std::string id;
  std::string name;
  /// 0: none is named.
  std::int64_t expires_at_ms = 0;
};

/// Shapes, or objects: both are present sets with the same rules.
struct PresentKind {
  const char* name;
  std::size_t per_robot_max;
  std::function<model::Body(const PresentUpsert& upsert)> upsert;
  std::function<model::Body(const std::string& id)> deletion;
  std::function<absl::StatusOr<storage::Page<PresentSeen>>(storage::Reader& reader,
                                                           const storage::PresentQuery& query)>
      read;
  std::function<model::Rejection()> too_many;
};

[[nodiscard]] std::array<PresentKind, 2> PresentKinds();

}  // namespace uplink::testing
