#include "server/journal/quarantine_notes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

void NoteRows(QuarantineNotes& notes, const std::string& ruri, std::size_t rows) {
  for (std::size_t i = 0; i < rows; ++i) notes.Note(ruri);
}

TEST(QuarantineNotesTest, ARobotIsLookedAtWithItsFirstRowAndWithEveryThousandthAfterThat) {
  QuarantineNotes notes;
  EXPECT_FALSE(notes.any());
  notes.Note("a");
  EXPECT_THAT(notes.First(9), ElementsAre("a"));
  notes.Done("a");
  NoteRows(notes, "a", kQuarantineRowsPerLook - 1);
  EXPECT_FALSE(notes.any());
  notes.Note("a");
  EXPECT_THAT(notes.First(9), ElementsAre("a"));
  notes.Done("a");
  NoteRows(notes, "a", kQuarantineRowsPerLook - 1);
  EXPECT_FALSE(notes.any());
}

TEST(QuarantineNotesTest, RobotsComeByTheirNamesAndSomeAtATime) {
  QuarantineNotes notes;
  for (const char* ruri : {"c", "a", "b", "a"}) notes.Note(ruri);
  EXPECT_THAT(notes.First(2), ElementsAre("a", "b"));
  notes.Done("a");
  notes.Done("b");
  EXPECT_THAT(notes.First(2), ElementsAre("c"));
  notes.Done("c");
  EXPECT_THAT(notes.First(2), IsEmpty());
}

TEST(QuarantineNotesTest, PastTheBoundRobotsAreCountedAnew) {
  QuarantineNotes notes(2);
  notes.Note("a");
  notes.Note("b");
  notes.Done("a");
  notes.Done("b");
  notes.Note("c");
  notes.Done("c");
  notes.Note("a");
  EXPECT_THAT(notes.First(9), ElementsAre("a")) << "one look too many, and no row unseen";
}

TEST(QuarantineNotesTest, WithoutRoomARobotWaitsForLaterRows) {
  QuarantineNotes notes(2);
  notes.Note("a");
  notes.Note("b");
  notes.Note("c");
  EXPECT_THAT(notes.First(9), ElementsAre("a", "b"));
  notes.Done("a");
  NoteRows(notes, "c", kQuarantineRowsPerLook);
  EXPECT_THAT(notes.First(9), ElementsAre("b", "c"));
}

}  // namespace
}  // namespace uplink::journal
