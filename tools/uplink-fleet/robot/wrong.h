#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "tools/uplink-fleet/robot/behaviour/faults.h"
#include "tools/uplink-fleet/robot/behaviour/seeded.h"
#include "tools/uplink-fleet/robot/send_queue.h"

namespace uplink::synthetic {

class Account;

/// How many ways of being wrong there are.
inline constexpr std::size_t kWaysToBeWrong = 14;

/// Messages that are wrong on purpose, in their structure or in a field, of durable and of live
/// kinds; with what the server must say of each.
/// Source: the validation sheet.
class Wrong final {
 public:
  Wrong(Seeded random, const std::string& mark)
      : random_(random), faults_(random, mark, "uplink-fleet/wrong", 0) {}

  /// The next one, entered into the account. The agent keeps it until an Ack covers it, as if it
  /// were durable, so that what it was told is known.
  [[nodiscard]] Outgoing Next(std::int64_t now_ms, Account& account);
  /// The `way`th way to be wrong.
  [[nodiscard]] Outgoing Make(std::size_t way, std::int64_t now_ms, Account& account);

 private:
  Seeded random_;
  Faults faults_;
};

}  // namespace uplink::synthetic
