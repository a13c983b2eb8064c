#include "tools/uplinkctl/doctor/finding.h"

#include <gtest/gtest.h>

#include "tools/uplinkctl/show/one_line.h"

namespace uplink::ctl {
namespace {

TEST(Finding, ALineSaysHowBadWhereWhatAndWhatToDo) {
  EXPECT_EQ(ToText(Error("listen.relay", "it is taken", "stop it")),
            "error    listen.relay: it is taken; stop it");
  EXPECT_EQ(ToText(Ok("disk", "there is room")), "ok       disk: there is room");
}

TEST(Finding, AForeignTextStaysOnOneLine) {
  EXPECT_EQ(ToText(Error("store.url", "refused\n\tby \x1b[31mhost\n", "start it")),
            "error    store.url: refused  by  [31mhost ; start it");
  EXPECT_EQ(OneLine("C1 \u009B2J, bidi \u202E, \xFF, ä\n"),
            "C1 \\xc2\\x9b2J, bidi \\xe2\\x80\\xae, \\xff, ä");
}

TEST(Finding, TheWorstOneMakesTheExitCode) {
  Findings findings;
  EXPECT_EQ(ExitOfFindings(findings), 0);
  findings.push_back(Ok("a", "b"));
  EXPECT_EQ(ExitOfFindings(findings), 0);
  findings.push_back(Warning("a", "b", "c"));
  EXPECT_EQ(ExitOfFindings(findings), 1);
  findings.insert(findings.begin(), Error("a", "b", "c"));
  EXPECT_EQ(ExitOfFindings(findings), 2);
}

TEST(Finding, TheLastLineCounts) {
  EXPECT_EQ(Summary({Ok("a", "b")}), "0 errors, 0 warnings");
  EXPECT_EQ(Summary({Error("a", "b", "c"), Warning("a", "b", "c"), Warning("a", "b", "c")}),
            "1 error, 2 warnings");
}

}  // namespace
}  // namespace uplink::ctl
