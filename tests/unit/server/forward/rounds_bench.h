#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/forward/limits.h"
#include "server/forward/rounds.h"
#include "tests/support/fake_trust.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"
#include "tests/unit/server/forward/receiving.h"
#include "tests/unit/server/forward/scripted_items.h"

namespace uplink::forward {

/// Looks at a store of the test's, one by one, on a clock that is moved by hand.
class RoundsTest : public ::testing::Test {
 protected:
  void Round() { static_cast<void>(rounds_.Round()); }
  std::vector<std::string> Ids() const {
    std::vector<std::string> ids;
    for (const ItemKey& key : forwards_.Keys()) ids.push_back(key.id);
    return ids;
  }

  testing::ManualClock clock_;
  testing::FakeTrust trust_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  ScriptedItems items_;
  Forwards forwards_{{kSharedBytesMax, kFleetBytesMax, kRobotBytesMax}, std::mt19937_64(1)};
  ForwardProbe probe_;
  Rounds rounds_{{clock_, logger_, items_, forwards_, probe_, trust_}};
};

}  // namespace uplink::forward
