#include "tools/terminal/terminal.h"

#include <array>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace uplink {
namespace {

/// The side of a pseudo terminal that programs write to.
class PseudoTerminal {
 public:
  PseudoTerminal() : master_(posix_openpt(O_RDWR | O_NOCTTY)) {
    EXPECT_EQ(grantpt(master_), 0);
    EXPECT_EQ(unlockpt(master_), 0);
    std::array<char, 64> name{};
    EXPECT_EQ(ptsname_r(master_, name.data(), name.size()), 0);
    slave_ = open(name.data(), O_RDWR | O_NOCTTY);
    EXPECT_GE(slave_, 0);
  }
  ~PseudoTerminal() {
    close(slave_);
    close(master_);
  }
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  [[nodiscard]] int descriptor() const { return slave_; }

 private:
  int master_;
  int slave_ = -1;
};

/// A pipe, which is no terminal.
class Pipe {
 public:
  Pipe() { EXPECT_EQ(pipe(ends_.data()), 0); }
  ~Pipe() {
    for (const int end : ends_) close(end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  [[nodiscard]] int descriptor() const { return ends_[1]; }

 private:
  std::array<int, 2> ends_{};
};

template <std::size_t N>
Terminal Of(int descriptor, const std::array<const char*, N>& variables) {
  std::array<const char*, N + 1> environment{};
  std::copy(variables.begin(), variables.end(), environment.begin());
  return TerminalOf(descriptor, environment.data());
}

TEST(TerminalTest, ATerminalHasUpdatesAndColours) {
  const PseudoTerminal terminal;
  const Terminal found = Of(terminal.descriptor(), std::array{"HOME=/", "TERM=xterm"});
  EXPECT_TRUE(found.updates);
  EXPECT_TRUE(found.colours);
}

TEST(TerminalTest, NoColorTakesTheColoursAlone) {
  const PseudoTerminal terminal;
  const Terminal found = Of(terminal.descriptor(), std::array{"TERM=xterm", "NO_COLOR=1"});
  EXPECT_TRUE(found.updates);
  EXPECT_FALSE(found.colours);
  EXPECT_TRUE(Of(terminal.descriptor(), std::array{"TERM=xterm", "NO_COLOR="}).colours);
  EXPECT_TRUE(Of(terminal.descriptor(), std::array{"TERM=xterm", "NO_COLORS=1"}).colours);
}

TEST(TerminalTest, ADumbTerminalAndOneWithoutANameHaveNeither) {
  const PseudoTerminal terminal;
  for (const char* term : {"TERM=dumb", "TERM=", "TERMINFO=xterm"}) {
    const Terminal found = Of(terminal.descriptor(), std::array{term});
    EXPECT_FALSE(found.updates) << term;
    EXPECT_FALSE(found.colours) << term;
  }
  EXPECT_FALSE(TerminalOf(terminal.descriptor(), nullptr).updates);
}

TEST(TerminalTest, APipeHasNeither) {
  const Pipe pipe;
  const Terminal found = Of(pipe.descriptor(), std::array{"TERM=xterm"});
  EXPECT_FALSE(found.updates);
  EXPECT_FALSE(found.colours);
}

TEST(TerminalTest, SizeIsWhatTheTerminalSaysOrTheUsualOne) {
  const PseudoTerminal terminal;
  const winsize size{.ws_row = 50, .ws_col = 120, .ws_xpixel = 0, .ws_ypixel = 0};
  ASSERT_EQ(ioctl(terminal.descriptor(), TIOCSWINSZ, &size), 0);
  EXPECT_EQ(SizeOf(terminal.descriptor()).columns, 120U);
  EXPECT_EQ(SizeOf(terminal.descriptor()).rows, 50U);
  const Pipe pipe;
  EXPECT_EQ(SizeOf(pipe.descriptor()).columns, 80U);
  EXPECT_EQ(SizeOf(pipe.descriptor()).rows, 24U);
}

TEST(PaletteTest, PaintsOnlyWithColours) {
  const Palette plain({.updates = true, .colours = false});
  EXPECT_EQ(plain.Good("ok") + plain.Bad("no") + plain.Heading("head"), "oknohead");
  const Palette coloured({.updates = true, .colours = true});
  EXPECT_EQ(coloured.Good("ok"), "\x1b[32mok\x1b[0m");
  EXPECT_EQ(coloured.Bad("no"), "\x1b[1;31mno\x1b[0m");
  EXPECT_EQ(coloured.Good(""), "") << "an empty cell has no colour";
}

}  // namespace
}  // namespace uplink
