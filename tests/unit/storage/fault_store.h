#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/sqlite/store.h"
#include "tests/support/records.h"
#include "tests/support/temp_folder.h"

namespace uplink::storage::sqlite {

/// An SQLite store that commits faults, and what other programs do with its files.
class FaultStore : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(real_); }

  void OpenStore(const std::string& path, StoreOptions options = {}) {
    options.process = {1};
    auto opened = SqliteStore::Open(path, options);
    ASSERT_TRUE(opened.ok()) << opened.status();
    store_ = *std::move(opened);
    const OpenRequest request{robot_, {}, 0, FromUnixMs(1), {}};
    ASSERT_TRUE(store_->OpenStreams({&request, 1}).ok());
  }

  absl::StatusOr<std::vector<Outcome>> Commit(model::Seq seq) const {
    model::Fault fault;
    fault.fault_id = "f" + std::to_string(seq);
    fault.active = true;
    Batch batch;
    batch.records.push_back({robot_, {}, seq, 1, FromUnixMs(1), test::RecordOf(fault), "bytes", 5});
    return store_->Commit(batch);
  }

  /// Nothing is told, of any call that writes.
  void ExpectFails(model::Seq seq, const std::string& name) {
    const absl::Status status = Commit(seq).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable) << status;
    EXPECT_THAT(
        std::string(status.message()),
        ::testing::AllOf(::testing::HasSubstr(name), ::testing::HasSubstr("nothing is acked")));
    const OpenRequest request{robot_, {}, 0, FromUnixMs(1), {}};
    EXPECT_FALSE(store_->OpenStreams({&request, 1}).ok());
  }

  /// What a program of its own prints: one in this process would share the store's index.
  std::string Shell(const std::string& path, const std::string& sql) const {
    const std::string out = folder_.File("out");
    const std::string command = "sqlite3 '" + path + "' \"" + sql + "\" >'" + out + "'";
    // NOLINTNEXTLINE(cert-env33-c,concurrency-mt-unsafe): the command is ours, and no thread runs
    EXPECT_EQ(std::system(command.c_str()), 0) << sql;
    std::ostringstream text;
    text << std::ifstream(out).rdbuf();
    return text.str();
  }
  std::string Faults(const std::string& path) const {
    return Shell(path, "SELECT COUNT(*) FROM faults_history");
  }

  uplink::testing::TempFolder folder_;
  const std::string real_ = folder_.File("real");
  const std::string path_ = real_ + "/uplinkd.db";
  const std::string aside_ = folder_.File("aside");
  const RobotRef robot_ = std::make_shared<const model::RobotId>(model::RobotId{"rcan://r", "f"});
  std::unique_ptr<SqliteStore> store_;
};

}  // namespace uplink::storage::sqlite
