#pragma once

#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/session/session_bench.h"

namespace uplink::session {

/// A server on a database that survives it. Whatever a script does, the conservation law holds
/// after it.
class SessionTest : public ::testing::Test {
 protected:
  ~SessionTest() override { ExpectBalanced(); }

  /// A new process on the same database; the old one is gone as after a kill.
  BenchServer& Start() {
    ExpectBalanced();
    server_.reset();
    server_ = std::make_unique<BenchServer>(clock_, database_, ++processes_, limits_);
    return *server_;
  }
  BenchServer& server() { return server_ != nullptr ? *server_ : Start(); }
  void ExpectBalanced() const {
    if (server_ == nullptr) return;
    EXPECT_TRUE(server_->counts().Balanced());
  }
  [[nodiscard]] std::vector<model::Seq> Stored(std::uint8_t session) const {
    return database_.Log(kRobot, SessionOf(session)).stored;
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  BenchLimits limits_;
  std::uint8_t processes_ = 0;
  std::unique_ptr<BenchServer> server_;
};

}  // namespace uplink::session
