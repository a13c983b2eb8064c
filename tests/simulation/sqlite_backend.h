#pragma once

#include <memory>
#include <optional>
#include <string>

#include "storage/sqlite/parts.h"
#include "storage/sqlite/reader.h"
#include "storage/sqlite/store.h"
#include "tests/simulation/world.h"
#include "tests/support/temp_folder.h"

namespace uplink::simulation {

/// The real SQLite store on a file of its own, opened again by each process.
class SqliteBackend final : public Backend {
 public:
  storage::Store& Reopen(const storage::ProcessId& process) override;
  std::optional<std::string> Compare(const Recorder& recorder) override;
  storage::Reader& Rows() override;
  storage::SharedItems& Items() override;
  void DeleteRobotRow(const std::string& ruri) override;
  void RemoveRobot(const std::string& ruri) override;
  bool ReplaceFiles() override;
  void AfterRetain() override { retained_ = true; }
  /// No sample of a drone is known again.
  void ForgetSamples() const;

 private:
  [[nodiscard]] std::string Path() const;

  testing::TempFolder folder_;
  /// How often others took the names of the files.
  std::uint64_t replaced_ = 0;
  /// Quarantine was deleted for its age.
  bool retained_ = false;
  std::unique_ptr<storage::sqlite::SqliteStore> store_;
  std::unique_ptr<storage::sqlite::SqliteReader> reader_;
  std::unique_ptr<storage::SharedItems> items_;
};

}  // namespace uplink::simulation
