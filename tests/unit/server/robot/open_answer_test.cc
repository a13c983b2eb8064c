#include "server/robot/open_answer.h"

#include <gtest/gtest.h>

namespace uplink::robot {
namespace {

TEST(OpenAnswerTest, TheAnswerToTheLastQuestionIsTakenOnce) {
  OpenAnswer open_answer;
  const std::uint64_t id = open_answer.Ask();
  EXPECT_FALSE(open_answer.answered(id));
  open_answer.Answer(id, {.cursor = 9});
  EXPECT_TRUE(open_answer.answered(id));
  const auto answer = open_answer.Take(id);
  ASSERT_TRUE(answer.has_value());
  EXPECT_EQ(answer->cursor, 9U);
  EXPECT_FALSE(open_answer.Take(id).has_value());
}

TEST(OpenAnswerTest, AnAnswerToAnOlderQuestionDoesNotCount) {
  OpenAnswer open_answer;
  const std::uint64_t first = open_answer.Ask();
  const std::uint64_t second = open_answer.Ask();
  open_answer.Answer(first, {.cursor = 9});
  EXPECT_FALSE(open_answer.answered(first));
  EXPECT_FALSE(open_answer.Take(second).has_value());
}

TEST(OpenAnswerTest, AfterWelcomeALateAnswerIsNotKept) {
  OpenAnswer open_answer;
  const std::uint64_t id = open_answer.Ask();
  EXPECT_FALSE(open_answer.Take(id).has_value());
  open_answer.Answer(id, {.cursor = 9});
  EXPECT_FALSE(open_answer.answered(id));
}

TEST(OpenAnswerTest, ALateAnswerIsKeptWhereItIsWanted) {
  OpenAnswer open_answer;
  const std::uint64_t id = open_answer.Ask();
  EXPECT_FALSE(open_answer.Take(id).has_value());
  open_answer.WantLate();
  EXPECT_FALSE(open_answer.came_late());
  open_answer.Answer(id, {.cursor = 9});
  EXPECT_TRUE(open_answer.came_late());
  EXPECT_EQ(open_answer.Take(id)->cursor, 9U);
  EXPECT_FALSE(open_answer.came_late());
}

TEST(OpenAnswerTest, ANewQuestionWantsNoLateAnswerToTheOlder) {
  OpenAnswer open_answer;
  const std::uint64_t first = open_answer.Ask();
  EXPECT_FALSE(open_answer.Take(first).has_value());
  open_answer.WantLate();
  const std::uint64_t second = open_answer.Ask();
  open_answer.Answer(first, {.cursor = 9});
  open_answer.Answer(second, {.cursor = 9});
  EXPECT_FALSE(open_answer.came_late()) << "Welcome waits for it";
}

TEST(OpenAnswerTest, WhatIsForgottenIsNotAnswered) {
  OpenAnswer open_answer;
  const std::uint64_t id = open_answer.Ask();
  open_answer.Answer(id, {.cursor = 9});
  open_answer.Forget();
  EXPECT_FALSE(open_answer.answered(id));
}

}  // namespace
}  // namespace uplink::robot
