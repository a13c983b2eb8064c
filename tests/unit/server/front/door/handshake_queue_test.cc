#include "server/front/door/handshake_queue.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <random>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::front {
namespace {

using ::testing::ElementsAre;

SourceAddress From(std::uint32_t number) {
  return SourceAddress::Of(in_addr{.s_addr = htonl(number)});
}

/// Who serves by the rate is in handshake_rates_test.cc: here no source is over it.
constexpr SteadyTime kNow{};

const SourceAddress kA = From(0x0A000001);
const SourceAddress kB = From(0x0A000002);
const SourceAddress kC = From(0x0A000003);

/// Connections first, first + 1, ... of one source.
void ArriveMany(HandshakeQueue& queue, std::uint64_t first, std::size_t count,
                const SourceAddress& source, Rank rank = Rank::kStranger) {
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_EQ(queue.Arrive(first + i, source, rank, kNow), std::nullopt) << first + i;
  }
}

/// The handshakes that may begin, until no place is free or none waits.
std::vector<std::uint64_t> TakeAll(HandshakeQueue& queue) {
  std::vector<std::uint64_t> taken;
  while (const auto id = queue.Next(kNow)) taken.push_back(*id);
  return taken;
}

TEST(HandshakeQueue, IsEmptyAtFirst) {
  HandshakeQueue queue({.under_way_max = 2, .waiting_max = 2});
  EXPECT_EQ(queue.Next(kNow), std::nullopt);
  EXPECT_EQ(queue.ChooseToCut(), std::nullopt);
  EXPECT_FALSE(queue.pressed());
}

TEST(HandshakeQueue, FillsThePlacesAndNoMore) {
  HandshakeQueue queue({.under_way_max = 2, .waiting_max = 10});
  ArriveMany(queue, 1, 3, kA);
  EXPECT_THAT(TakeAll(queue), ElementsAre(1, 2));
  EXPECT_EQ(queue.under_way(), 2U);
  EXPECT_EQ(queue.waiting(), 1U);
  EXPECT_TRUE(queue.pressed());
  queue.Ended(2);
  EXPECT_EQ(queue.Next(kNow), 3U);
  EXPECT_FALSE(queue.pressed());
}

TEST(HandshakeQueue, OneSourceUsesEveryPlaceThatNobodyElseWants) {
  HandshakeQueue queue({.under_way_max = 64, .waiting_max = 10'000});
  ArriveMany(queue, 0, 5'000, kA);
  for (std::uint64_t served = 0; served < 5'000; ++served) {
    const auto id = queue.Next(kNow);
    ASSERT_EQ(id, served) << "first in, first out";
    if (queue.under_way() == 64) queue.Ended(served - 63);
  }
  EXPECT_EQ(queue.waiting(), 0U);
}

TEST(HandshakeQueue, TheSourceWithTheFewestUnderWayIsNext) {
  HandshakeQueue queue({.under_way_max = 4, .waiting_max = 100});
  ArriveMany(queue, 10, 5, kA);
  ArriveMany(queue, 20, 5, kB);
  ASSERT_THAT(TakeAll(queue), ElementsAre(10, 20, 11, 21));
  queue.Ended(21);
  queue.Ended(20);
  EXPECT_THAT(TakeAll(queue), ElementsAre(22, 23)) << "until both have two";
}

TEST(HandshakeQueue, EqualSourcesAlternate) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 100});
  ArriveMany(queue, 10, 2, kA);
  ArriveMany(queue, 20, 2, kB);
  ArriveMany(queue, 30, 2, kC);
  std::vector<std::uint64_t> served;
  while (const auto id = queue.Next(kNow)) {
    served.push_back(*id);
    queue.Ended(*id);
  }
  EXPECT_THAT(served, ElementsAre(10, 20, 30, 11, 21, 31));
}

TEST(HandshakeQueue, ASourceThatComesAgainIsNotServedBeforeThoseThatWait) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 100});
  ArriveMany(queue, 1, 1, kA);
  ASSERT_EQ(queue.Next(kNow), 1U);
  ArriveMany(queue, 20, 1, kB);
  ArriveMany(queue, 30, 1, kC);
  queue.Ended(1);
  ArriveMany(queue, 2, 1, kA);
  EXPECT_EQ(queue.Next(kNow), 20U);
  queue.Ended(20);
  EXPECT_EQ(queue.Next(kNow), 30U);
}

TEST(HandshakeQueue, KnownSourcesComeFirstAndEveryFourthPlaceIsAStrangers) {
  HandshakeQueue queue({.under_way_max = 8, .waiting_max = 100});
  ArriveMany(queue, 10, 10, kA);
  ArriveMany(queue, 20, 10, kB, Rank::kKnown);
  EXPECT_THAT(TakeAll(queue), ElementsAre(20, 21, 22, 10, 23, 24, 25, 11));
}

TEST(HandshakeQueue, EveryFourthPlaceThatIsFreedIsAStrangersWhereOneIsAll) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 100});
  ArriveMany(queue, 10, 10, kA);
  ArriveMany(queue, 20, 10, kB, Rank::kKnown);
  std::vector<std::uint64_t> served;
  for (int i = 0; i < 8; ++i) {
    served.push_back(queue.Next(kNow).value());
    queue.Ended(served.back());
  }
  EXPECT_THAT(served, ElementsAre(20, 21, 22, 10, 23, 24, 25, 11));
}

TEST(HandshakeQueue, SlowStrangersGetNoMoreThanAFourthOfThePlacesWhileKnownSourcesWait) {
  HandshakeQueue queue({.under_way_max = 8, .waiting_max = 100});
  ArriveMany(queue, 1'000, 50, kA);
  ArriveMany(queue, 0, 50, kB, Rank::kKnown);
  for (int i = 0; i < 50; ++i) {
    for (const std::uint64_t id : TakeAll(queue)) {
      if (id < 1'000) queue.Ended(id);
    }
  }
  EXPECT_EQ(queue.waiting(), 50U - 8U)
      << "the known ones are all served; then strangers get it all";
  EXPECT_EQ(queue.under_way(), 8U);
}

TEST(HandshakeQueue, StrangersThatHoldTheirFourthAreServedAgainWhenOneHasEnded) {
  HandshakeQueue queue({.under_way_max = 4, .waiting_max = 100});
  ArriveMany(queue, 10, 10, kA);
  ArriveMany(queue, 20, 20, kB, Rank::kKnown);
  ASSERT_THAT(TakeAll(queue), ElementsAre(20, 21, 22, 10));
  for (const std::uint64_t id : {20U, 21U, 22U, 23U}) {
    queue.Ended(id);
    EXPECT_EQ(queue.Next(kNow), id + 3) << "one stranger is a fourth";
  }
  queue.Ended(10);
  EXPECT_EQ(queue.Next(kNow), 11U);
}

TEST(HandshakeQueue, ASourceThatBecomesKnownTakesAllThatWaitWithIt) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 100});
  ArriveMany(queue, 10, 1, kA);
  ArriveMany(queue, 20, 1, kB);
  ArriveMany(queue, 21, 1, kB, Rank::kKnown);
  EXPECT_EQ(queue.Next(kNow), 20U);
}

TEST(HandshakeQueue, PastItRefusesTheNewestOfTheSourceThatHasTheMost) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 3});
  ArriveMany(queue, 1, 2, kA);
  ArriveMany(queue, 3, 1, kB);
  EXPECT_EQ(queue.Arrive(4, kC, Rank::kStranger, kNow), 2U);
  EXPECT_EQ(queue.waiting(), 3U);
  EXPECT_EQ(queue.Next(kNow), 1U);
}

TEST(HandshakeQueue, PastItRefusesTheNewcomerIfItsSourceHasTheMost) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 3});
  ArriveMany(queue, 1, 1, kA);
  ArriveMany(queue, 2, 2, kB);
  EXPECT_EQ(queue.Arrive(4, kB, Rank::kStranger, kNow), 4U);
  EXPECT_EQ(queue.waiting(), 3U);
}

TEST(HandshakeQueue, PastItRefusesTheNewcomerIfAllHaveAsMany) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 2});
  ArriveMany(queue, 1, 1, kA);
  ArriveMany(queue, 2, 1, kB);
  EXPECT_EQ(queue.Arrive(3, kC, Rank::kStranger, kNow), 3U);
  EXPECT_EQ(queue.sources(), 2U) << "the source is forgotten with it";
}

TEST(HandshakeQueue, PastItRefusesAStrangerBeforeAKnownSourceThatHasMore) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 4});
  ArriveMany(queue, 1, 2, kA, Rank::kKnown);
  ArriveMany(queue, 3, 2, kB);
  EXPECT_EQ(queue.Arrive(5, kA, Rank::kKnown, kNow), 4U);
}

TEST(HandshakeQueue, StrangersKeepAFourthOfThoseThatMayWait) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 4});
  ArriveMany(queue, 1, 4, kA, Rank::kKnown);
  EXPECT_EQ(queue.Arrive(5, kB, Rank::kStranger, kNow), 4U);
  EXPECT_EQ(queue.Arrive(6, kA, Rank::kKnown, kNow), 6U);
  EXPECT_EQ(queue.Arrive(7, kC, Rank::kStranger, kNow), 7U) << "it would be more than a fourth";
}

TEST(HandshakeQueue, AnUnknownOneMayEnd) {
  HandshakeQueue queue({.under_way_max = 2, .waiting_max = 10});
  ArriveMany(queue, 1, 2, kA);
  ASSERT_EQ(queue.Next(kNow), 1U);
  queue.Ended(7);
  queue.Ended(1);
  queue.Ended(1);
  EXPECT_EQ(queue.under_way(), 0U);
  EXPECT_EQ(queue.waiting(), 1U);
}

TEST(HandshakeQueue, TheLongestOfTheSourceThatHasTooManyGivesWay) {
  HandshakeQueue queue({.under_way_max = 4, .waiting_max = 100});
  ArriveMany(queue, 1, 10, kA);
  ASSERT_THAT(TakeAll(queue), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(queue.ChooseToCut(), std::nullopt) << "no other wants a place";
  ArriveMany(queue, 20, 3, kB);
  EXPECT_EQ(queue.ChooseToCut(), 1U);
  queue.Ended(1);
  EXPECT_EQ(queue.Next(kNow), 20U);
  EXPECT_EQ(queue.ChooseToCut(), 2U);
  queue.Ended(2);
  EXPECT_EQ(queue.Next(kNow), 21U);
  EXPECT_EQ(queue.ChooseToCut(), std::nullopt) << "both have their share";
}

TEST(HandshakeQueue, NobodyGivesWayWhileAPlaceIsFree) {
  HandshakeQueue queue({.under_way_max = 4, .waiting_max = 100});
  ArriveMany(queue, 1, 3, kA);
  ASSERT_THAT(TakeAll(queue), ElementsAre(1, 2, 3));
  ArriveMany(queue, 20, 1, kB);
  EXPECT_EQ(queue.ChooseToCut(), std::nullopt);
}

TEST(HandshakeQueue, NobodyGivesWayWhereEachHasOneAndMoreWaitThanThereArePlaces) {
  HandshakeQueue queue({.under_way_max = 2, .waiting_max = 100});
  for (std::uint32_t i = 1; i <= 5; ++i) ArriveMany(queue, i, 1, From(i));
  ASSERT_THAT(TakeAll(queue), ElementsAre(1, 2));
  EXPECT_EQ(queue.ChooseToCut(), std::nullopt);
}

TEST(HandshakeQueue, OneOfTwoGivesWayWhereMoreSourcesWaitThanThereArePlaces) {
  HandshakeQueue queue({.under_way_max = 3, .waiting_max = 100});
  ArriveMany(queue, 100, 3, kA);
  ASSERT_THAT(TakeAll(queue), ElementsAre(100, 101, 102));
  for (std::uint32_t i = 1; i <= 5; ++i) ArriveMany(queue, i, 1, From(i));
  EXPECT_EQ(queue.ChooseToCut(), 100U);
  queue.Ended(100);
  ASSERT_EQ(queue.Next(kNow), 1U);
  EXPECT_EQ(queue.ChooseToCut(), 101U);
  queue.Ended(101);
  ASSERT_EQ(queue.Next(kNow), 2U);
  EXPECT_EQ(queue.ChooseToCut(), std::nullopt) << "each share is one";
}

TEST(HandshakeQueue, NobodyGivesWayToAStrangerIfTheKnownSourceWouldGetThePlaceBack) {
  HandshakeQueue queue({.under_way_max = 4, .waiting_max = 100});
  ArriveMany(queue, 1, 20, kA, Rank::kKnown);
  ASSERT_THAT(TakeAll(queue), ElementsAre(1, 2, 3, 4));
  queue.Ended(4);
  ArriveMany(queue, 30, 1, kB);
  ASSERT_EQ(queue.Next(kNow), 30U) << "the fourth place";
  ArriveMany(queue, 40, 1, kC);
  EXPECT_EQ(queue.ChooseToCut(), std::nullopt) << "it is a known source's place, three times";
}

TEST(HandshakeQueue, NoStrangerGivesWayIfThePlaceWouldBeAStrangersAgain) {
  HandshakeQueue queue({.under_way_max = 8, .waiting_max = 100});
  ArriveMany(queue, 100, 2, kA);
  ASSERT_THAT(TakeAll(queue), ElementsAre(100, 101));
  for (std::uint32_t i = 1; i <= 6; ++i) ArriveMany(queue, i, 1, From(i), Rank::kKnown);
  ASSERT_THAT(TakeAll(queue), ElementsAre(1, 2, 3, 4, 5, 6));
  ArriveMany(queue, 7, 1, From(7), Rank::kKnown);
  EXPECT_EQ(queue.ChooseToCut(), 100U) << "the known source has none, and each share is one";
  ArriveMany(queue, 102, 1, kA);
  EXPECT_EQ(queue.ChooseToCut(), std::nullopt) << "strangers with less than their fourth are next";
}

constexpr HandshakeLimits kModelLimits{.under_way_max = 9, .waiting_max = 30};

/// What the queue promises of connections that come and go, by the simplest means.
class Model {
 public:
  void Arrive(std::uint64_t id, const SourceAddress& address, Rank rank) {
    Source& source = sources_[address];
    source.rank = rank;
    source.waiting.push_back(id);
    source_of_[id] = address;
  }

  void End(std::uint64_t id) {
    Source& source = Of(id);
    std::erase(source.waiting, id);
    std::erase(source.under_way, id);
    if (source.waiting.empty() && source.under_way.empty()) sources_.erase(source_of_.at(id));
    source_of_.erase(id);
  }

  void Begin(std::uint64_t id) {
    Source& source = Of(id);
    ASSERT_FALSE(source.waiting.empty());
    ASSERT_EQ(source.waiting.front(), id) << "first in, first out";
    const bool strangers_turn =
        known_in_a_row_ >= 3 && 4 * UnderWay(Rank::kStranger) < kModelLimits.under_way_max;
    if (Waiting(Rank::kStranger) > 0 && Waiting(Rank::kKnown) > 0) {
      ASSERT_EQ(source.rank, strangers_turn ? Rank::kStranger : Rank::kKnown);
    }
    for (const auto& [address, other] : sources_) {
      if (other.rank == source.rank && !other.waiting.empty()) {
        ASSERT_LE(source.under_way.size(), other.under_way.size());
      }
    }
    known_in_a_row_ = source.rank == Rank::kKnown ? known_in_a_row_ + 1 : 0;
    source.under_way.push_back(id);
    source.waiting.pop_front();
  }

  void Refuse(std::uint64_t id) {
    const Source& source = Of(id);
    ASSERT_EQ(source.waiting.back(), id) << "the newest";
    const bool stranger =
        Waiting(Rank::kKnown) == 0 || 4 * Waiting(Rank::kStranger) > kModelLimits.waiting_max;
    ASSERT_EQ(source.rank, stranger ? Rank::kStranger : Rank::kKnown);
    for (const auto& [address, other] : sources_) {
      if (other.rank == source.rank) {
        ASSERT_GE(source.waiting.size(), other.waiting.size());
      }
    }
    End(id);
  }

  void GiveWay(std::uint64_t id) {
    const Source& source = Of(id);
    ASSERT_EQ(source.under_way.front(), id) << "the longest";
    ASSERT_GT(source.under_way.size(), Share());
    for (const auto& [address, other] : sources_) {
      ASSERT_GE(source.under_way.size(), other.under_way.size());
    }
    End(id);
  }

  /// What each source may have under way.
  [[nodiscard]] std::size_t Share() const {
    return std::max<std::size_t>(1, kModelLimits.under_way_max / sources_.size());
  }
  [[nodiscard]] std::size_t UnderWayBeside(std::uint64_t id) const {
    return sources_.at(source_of_.at(id)).under_way.size();
  }
  [[nodiscard]] std::size_t Waiting(Rank rank) const {
    std::size_t count = 0;
    for (const auto& [address, source] : sources_) {
      if (source.rank == rank) count += source.waiting.size();
    }
    return count;
  }
  [[nodiscard]] std::size_t UnderWay(Rank rank) const {
    std::size_t count = 0;
    for (const auto& [address, source] : sources_) {
      if (source.rank == rank) count += source.under_way.size();
    }
    return count;
  }
  [[nodiscard]] std::size_t sources() const { return sources_.size(); }
  [[nodiscard]] std::vector<std::uint64_t> ids() const {
    std::vector<std::uint64_t> ids;
    for (const auto& [id, address] : source_of_) ids.push_back(id);
    return ids;
  }

 private:
  struct Source {
    Rank rank = Rank::kStranger;
    std::deque<std::uint64_t> waiting;
    std::deque<std::uint64_t> under_way;
  };
  [[nodiscard]] Source& Of(std::uint64_t id) { return sources_.at(source_of_.at(id)); }

  std::map<SourceAddress, Source> sources_;
  std::map<std::uint64_t, SourceAddress> source_of_;
  std::size_t known_in_a_row_ = 0;
};

void ExpectTheSame(const HandshakeQueue& queue, const Model& model) {
  ASSERT_LE(queue.waiting(), kModelLimits.waiting_max);
  ASSERT_LE(queue.under_way(), kModelLimits.under_way_max);
  ASSERT_EQ(queue.waiting(), model.Waiting(Rank::kStranger) + model.Waiting(Rank::kKnown));
  ASSERT_EQ(queue.under_way(), model.UnderWay(Rank::kStranger) + model.UnderWay(Rank::kKnown));
  ASSERT_EQ(queue.sources(), model.sources());
}

/// Cuts a handshake short, if one should be: its place is a source's that lacked one.
void LetGiveWay(HandshakeQueue& queue, Model& model) {
  const auto gives_way = queue.ChooseToCut();
  if (!gives_way) return;
  const std::size_t share = model.Share();
  queue.Ended(*gives_way);
  model.GiveWay(*gives_way);
  const auto next = queue.Next(kNow);
  ASSERT_TRUE(next);
  ASSERT_LT(model.UnderWayBeside(*next), share);
  model.Begin(*next);
}

TEST(HandshakeQueue, KeepsItsPromisesWhateverComes) {
  constexpr std::uint32_t kSeed = 20'240;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const auto below = [&random](std::size_t bound) { return random() % bound; };
  HandshakeQueue queue(kModelLimits);
  Model model;
  std::uint64_t last_id = 0;
  SteadyTime now = kNow;
  for (int step = 0; step < 10'000 && !HasFatalFailure(); ++step) {
    const std::size_t what = below(20);
    now += std::chrono::seconds(1);
    if (what < 8) {
      // Few sources come far more often than the others; which are known changes now and then.
      const std::size_t number = below(1 + below(12));
      const bool known = (number + static_cast<std::size_t>(step) / 500) % 3 == 0;
      const Rank rank = known ? Rank::kKnown : Rank::kStranger;
      const SourceAddress source = From(static_cast<std::uint32_t>(number));
      model.Arrive(++last_id, source, rank);
      if (const auto id = queue.Arrive(last_id, source, rank, now)) model.Refuse(*id);
    } else if (what < 14) {
      if (const auto id = queue.Next(now)) model.Begin(*id);
    } else if (what < 19) {
      const std::vector<std::uint64_t> ids = model.ids();
      if (ids.empty()) continue;
      const std::uint64_t id = ids[below(ids.size())];
      queue.Ended(id);
      model.End(id);
    } else {
      LetGiveWay(queue, model);
    }
    ExpectTheSame(queue, model);
  }
}

TEST(HandshakeQueueDeathTest, AnIdThatIsTwiceInItIsOurBug) {
  HandshakeQueue queue({.under_way_max = 1, .waiting_max = 10});
  ArriveMany(queue, 1, 1, kA);
  EXPECT_DEATH(static_cast<void>(queue.Arrive(1, kB, Rank::kStranger, kNow)), "two connections");
}

TEST(HandshakeQueueDeathTest, LimitsOfZeroAreOurBug) {
  EXPECT_DEATH(HandshakeQueue({.under_way_max = 0, .waiting_max = 1}), "could begin");
  EXPECT_DEATH(HandshakeQueue({.under_way_max = 1, .waiting_max = 0}), "could begin");
}

}  // namespace
}  // namespace uplink::front
