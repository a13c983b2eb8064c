#include <map>
#include <utility>

#include <absl/strings/str_split.h>

#include "schema/base/check.h"
#include "schema/base/clock.h"
#include "storage/postgres/parts.h"
#include "storage/postgres/reader.h"
#include "storage/postgres/store.h"
#include "tests/contract/store_under_test.h"
#include "tests/support/postgres_database.h"

namespace uplink::testing {
namespace {

template <typename Part>
void Keep(absl::StatusOr<std::unique_ptr<Part>> made, std::unique_ptr<Part>& part) {
  UPLINK_CHECK(made.ok(), made.status().ToString());
  part = *std::move(made);
}

class PostgresUnderTest final : public StoreUnderTest {
 public:
  explicit PostgresUnderTest(const storage::StoreRules& rules) : rules_(rules) {}

  storage::Store& Process(std::uint8_t number) override {
    One& one = processes_[number];
    if (one.store == nullptr) Open(number, one);
    return *one.store;
  }

  storage::Reader& reader() override {
    if (reader_ == nullptr) {
      storage::postgres::ReaderOptions options;
      options.url = database_.url();
      auto opened = storage::postgres::PostgresReader::Open(options, clock_);
      UPLINK_CHECK(opened.ok(), opened.status().ToString());
      reader_ = *std::move(opened);
    }
    return *reader_;
  }

  storage::Leases* LeasesOf(std::uint8_t number) override {
    static_cast<void>(Process(number));  // makes the schema
    auto& leases = leases_[number];
    if (leases == nullptr) {
      Keep(storage::postgres::MakeLeases(OptionsOf(number), clock_), leases);
    }
    return leases.get();
  }

  storage::TopicLeases& TopicLeasesOf(std::uint8_t number) override {
    static_cast<void>(Process(number));  // makes the schema
    auto& leases = topic_leases_[number];
    if (leases == nullptr) {
      Keep(storage::postgres::MakeTopicLeases(OptionsOf(number), clock_), leases);
    }
    return *leases;
  }

  storage::ClockMarks* clock_marks() override {
    static_cast<void>(Process(1));  // makes the schema
    if (marks_ == nullptr) {
      Keep(storage::postgres::MakeClockMarks(OptionsOf(1), clock_), marks_);
    }
    return marks_.get();
  }

  storage::RobotRemoval* removal() override { return &Forget().removal(); }
  storage::ForgetRequests& forget_requests() override { return Forget().requests(); }
  storage::AccessStore& access() override {
    static_cast<void>(Process(1));  // makes the schema
    if (access_ == nullptr) {
      Keep(storage::postgres::MakeAccessStore(OptionsOf(1), clock_), access_);
    }
    return *access_;
  }
  storage::SharedItems& shared_items() override {
    static_cast<void>(Process(1));  // makes the schema
    if (shared_items_ == nullptr) {
      Keep(storage::postgres::MakeSharedItems(OptionsOf(1), clock_), shared_items_);
    }
    return *shared_items_;
  }
  void AddChanges(std::size_t count) override {
    // Always as the same writer, as one session would.
    const std::string writer = "'0a000000-0000-0000-0000-000000000000'::uuid";
    PostgresShell shell = database_.Shell();
    shell.Run("INSERT INTO uplinkd.change_writers VALUES (" + writer + ") ON CONFLICT DO NOTHING");
    shell.Run("INSERT INTO uplinkd.changes SELECT " + writer +
              ", n + coalesce((SELECT max(number) FROM uplinkd.changes WHERE writer = " + writer +
              "), 0), now(), 2, 'rcan://robots/x', 'i' FROM generate_series(1, " +
              std::to_string(count) + ") AS n");
  }
  void RemoveRobot(const std::string& ruri) override { RemoveFrom(*removal(), ruri); }
  void AgeForgetRequests(std::chrono::seconds time) override {
    database_.Shell().Run(
        "UPDATE uplinkd.forget_requests SET touched_at = touched_at - make_interval(secs => " +
        std::to_string(time.count()) + ")");
  }
  std::vector<std::string> TablesOfRobots() override {
    static_cast<void>(Process(1));  // makes the schema
    return absl::StrSplit(
        database_.Shell().Read(
            "SELECT c.relname FROM pg_attribute AS a JOIN pg_class AS c ON c.oid = a.attrelid"
            " WHERE c.relnamespace = 'uplinkd'::regnamespace AND c.relkind IN ('r', 'p')"
            " AND NOT c.relispartition AND a.attname = 'ruri' AND NOT a.attisdropped ORDER BY 1"),
        '\n', absl::SkipEmpty());
  }
  void NoteQuarantineDropped(const std::string& ruri) override {
    database_.Shell().Run("INSERT INTO uplinkd.quarantine_dropped (ruri, reason, count) VALUES ('" +
                          ruri + "', 1, 1)");
  }

  void FailNextWrite(std::uint8_t number) override { processes_[number].fail_before = true; }
  void LoseNextAnswer(std::uint8_t number) override { processes_[number].fail_after = true; }

  void Reopen() override {
    reader_ = nullptr;
    marks_ = nullptr;
    forget_ = nullptr;
    access_ = nullptr;
    shared_items_ = nullptr;
    leases_.clear();
    topic_leases_.clear();
    processes_.clear();
  }

  void DeleteRobotRow(const std::string& ruri) override {
    database_.Shell().Run("DELETE FROM uplinkd.robots WHERE ruri = '" + ruri + "'");
  }

  void RefuseFault(const std::string& fault_id) override {
    PostgresShell shell = database_.Shell();
    // The report is in the history by then, so that it shows whether that is taken back.
    shell.Run(
        "CREATE FUNCTION uplinkd.refuse() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN"
        " RAISE EXCEPTION 'the test says so'; END $$");
    shell.Run(
        "CREATE TRIGGER refuse BEFORE INSERT ON uplinkd.faults_active FOR EACH ROW WHEN"
        " (NEW.fault_id = '" +
        fault_id + "') EXECUTE FUNCTION uplinkd.refuse()");
  }

 private:
  storage::ForgetStore& Forget() {
    static_cast<void>(Process(1));  // makes the schema
    if (forget_ == nullptr) {
      Keep(storage::postgres::MakeForgetStore(OptionsOf(1), clock_), forget_);
    }
    return *forget_;
  }

  struct One {
    bool fail_before = false;
    bool fail_after = false;
    std::unique_ptr<storage::postgres::PostgresStore> store;
  };

  static absl::Status Take(bool& order) {
    return std::exchange(order, false) ? absl::UnavailableError("the test said so")
                                       : absl::OkStatus();
  }

  storage::postgres::StoreOptions OptionsOf(std::uint8_t number) const {
    storage::postgres::StoreOptions options;
    options.url = database_.url();
    options.process = {number};
    return options;
  }

  void Open(std::uint8_t number, One& one) {
    storage::postgres::StoreOptions options = OptionsOf(number);
    options.rules = rules_;
    options.before_commit = [&one] { return Take(one.fail_before); };
    options.after_commit = [&one] { return Take(one.fail_after); };
    auto opened = storage::postgres::PostgresStore::Open(std::move(options), clock_);
    UPLINK_CHECK(opened.ok(), opened.status().ToString());
    UPLINK_CHECK((*opened)->open_error().ok(), (*opened)->open_error().ToString());
    one.store = *std::move(opened);
  }

  const SystemClock clock_{};
  const storage::StoreRules rules_;
  PostgresDatabase database_;
  std::map<std::uint8_t, One> processes_;
  std::map<std::uint8_t, std::unique_ptr<storage::Leases>> leases_;
  std::map<std::uint8_t, std::unique_ptr<storage::TopicLeases>> topic_leases_;
  std::unique_ptr<storage::postgres::PostgresReader> reader_;
  std::unique_ptr<storage::ClockMarks> marks_;
  std::unique_ptr<storage::ForgetStore> forget_;
  std::unique_ptr<storage::AccessStore> access_;
  std::unique_ptr<storage::SharedItems> shared_items_;
};

}  // namespace

StoreKind PostgresKind() {
  return {"Postgres", [](const storage::StoreRules& rules) {
            return std::make_unique<PostgresUnderTest>(rules);
          }};
}

}  // namespace uplink::testing
