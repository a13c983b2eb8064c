#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/store.h"
#include "tests/support/fake_trust.h"
#include "tests/support/postgres_database.h"
#include "tests/support/records.h"

namespace uplink::storage::postgres {

using testing::PostgresDatabase;
using testing::PostgresShell;

/// A database, and what most tests do there: one robot, one session, one time of arrival. The store
/// goes by a clock that is vouched for until trust_ says otherwise.
class PostgresFixture : public ::testing::Test {
 protected:
  static constexpr std::int64_t kNowMs = 1'763'683'200'000;

  StoreOptions Options(std::uint8_t process = 1) {
    StoreOptions options;
    options.url = database_.url();
    options.process = {process};
    options.rules.clock = &trust_;
    return options;
  }
  std::unique_ptr<PostgresStore> Store(StoreOptions options) {
    auto opened = PostgresStore::Open(std::move(options), clock_);
    EXPECT_TRUE(opened.ok()) << opened.status();
    return *std::move(opened);
  }
  std::unique_ptr<PostgresStore> Store(std::uint8_t process = 1) { return Store(Options(process)); }
  std::unique_ptr<Connection> Connect(std::string session_settings = {}) {
    ConnectionOptions options;
    options.url = *ParseUrl(database_.url());
    options.session_settings = std::move(session_settings);
    auto connection = Connection::Open(options, clock_);
    EXPECT_TRUE(connection.ok()) << connection.status();
    return *std::move(connection);
  }
  OpenResult Open(storage::Store& store, const OpenRequest& request) {
    auto results = store.OpenStreams({&request, 1});
    EXPECT_TRUE(results.ok()) << results.status();
    return results.ok() ? results->front() : OpenResult();
  }
  OpenResult Open(storage::Store& store) {
    return Open(store, {robot_, session_, 0, FromUnixMs(kNowMs), {}});
  }
  /// A good message.
  CommitRecord Note(model::Seq seq, Epoch held_since, std::string text = "hello") const {
    model::Message message;
    message.message = std::move(text);
    return {robot_,  session_, seq, held_since, FromUnixMs(kNowMs), test::RecordOf(message),
            "bytes", 5};
  }
  static Batch BatchOf(std::vector<CommitRecord> records) {
    Batch batch;
    batch.records = std::move(records);
    return batch;
  }

  const SystemClock clock_{};
  testing::FakeTrust trust_;
  PostgresDatabase database_;
  PostgresShell shell_ = database_.Shell();
  const RobotRef robot_ =
      std::make_shared<const model::RobotId>(model::RobotId{"rcan://robots/a", "f1"});
  const model::SessionId session_{{7}};
};

}  // namespace uplink::storage::postgres
