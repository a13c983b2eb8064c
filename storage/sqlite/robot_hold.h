#pragma once

#include <algorithm>
#include <optional>
#include <string_view>

#include "storage/robot_hold.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

/// Who holds a robot: `owner` in the column, `epoch` in the next one. Nothing if there is no row.
[[nodiscard]] inline std::optional<RobotHold> HoldIn(const Rows& rows, int column) {
  if (rows.Null(column)) return std::nullopt;
  RobotHold hold{.owner = {}, .epoch = static_cast<Epoch>(rows.Int(column + 1))};
  const std::string_view owner = rows.Bytes(column);
  std::copy_n(owner.begin(), std::min(owner.size(), hold.owner.size()), hold.owner.begin());
  return hold;
}

}  // namespace uplink::storage::sqlite
