#include "tests/contract/store_contract.h"

/// The mark of the civil clock, of stores that last.
namespace uplink::testing {
namespace {

class ClockMarksContract : public StoreContract {
 protected:
  storage::ClockReading Read() {
    const auto reading = store_->clock_marks()->Read();
    EXPECT_TRUE(reading.ok()) << reading.status();
    return reading.ok() ? *reading : storage::ClockReading();
  }
  std::optional<SystemTime> Mark() { return Read().mark; }
};

TEST_P(ClockMarksContract, AStoreHasNoMarkOfItself) {
  EXPECT_EQ(Mark(), std::nullopt);
  Open();
  EXPECT_EQ(Mark(), std::nullopt);
}

TEST_P(ClockMarksContract, GoesWhereItIsSet) {
  ASSERT_TRUE(store_->clock_marks()->Set(Time(5)).ok());
  EXPECT_EQ(Mark(), Time(5));
  ASSERT_TRUE(store_->clock_marks()->Set(Time(9)).ok());
  EXPECT_EQ(Mark(), Time(9));
  ASSERT_TRUE(store_->clock_marks()->Set(Time(-7)).ok());
  EXPECT_EQ(Mark(), Time(-7)) << "also back";
  store_->Reopen();
  EXPECT_EQ(Mark(), Time(-7));
}

TEST_P(ClockMarksContract, AStoreThatCanLoseNothingTakesAnyMark) {
  ASSERT_TRUE(store_->clock_marks()->SetIfEmpty(Time()).ok());
  EXPECT_EQ(Mark(), Time());
  ASSERT_TRUE(store_->clock_marks()->SetIfEmpty(Time(1)).ok());
  EXPECT_EQ(Mark(), Time()) << "it has one";
}

TEST_P(ClockMarksContract, AStoreWithRowsDoesNot) {
  Open();
  ASSERT_TRUE(store_->clock_marks()->SetIfEmpty(Time()).ok());
  EXPECT_EQ(Mark(), std::nullopt);
}

TEST_P(ClockMarksContract, IsSetBesideAWriterThatIsAtWork) {
  Open();
  for (model::Seq seq = 1; seq <= 3; ++seq) {
    Commit({Good(seq)});
    ASSERT_TRUE(store_->clock_marks()->Set(Time(static_cast<std::int64_t>(seq))).ok());
  }
  EXPECT_EQ(Mark(), Time(3));
  EXPECT_EQ(Messages().size(), 3U);
}

TEST_P(ClockMarksContract, TellsTheDatabasesOwnClock) {
  const std::optional<SystemTime> database = Read().database;
  EXPECT_EQ(database.has_value(), std::string_view(GetParam().name) == "Postgres");
  if (database) {
    EXPECT_GT(*database, Time());
  }
}

INSTANTIATE_TEST_SUITE_P(Stores, ClockMarksContract,
                         ::testing::Values(SqliteKind(), PostgresKind()), NameOfKind);

}  // namespace
}  // namespace uplink::testing
