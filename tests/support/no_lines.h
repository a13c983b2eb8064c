#pragma once

#include <string_view>

#include "server/log/logger.h"

namespace uplink::testing {

/// Drops each line, for parts that want a logger where a test looks at none.
class NoLines final : public log::LineSink {
 public:
  void Write(log::Level /*level*/, std::string_view /*line*/) override {}
};

}  // namespace uplink::testing
