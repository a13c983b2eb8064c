// All of forwarding in one server, over a store of the test's: what its page of metrics says, and
// the numbers of commands.
#include "server/forward/forwarding.h"

#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "schema/nexus_command/decode.h"
#include "tests/support/eventually.h"
#include "tests/support/fake_trust.h"
#include "tests/support/kept_lines.h"
#include "tests/unit/server/forward/receiving.h"
#include "tests/unit/server/forward/scripted_items.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::forward {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

/// Streams that are not woken: the test takes by itself. Thread-safe, since it does nothing.
class Nobody final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t /*stream*/) override {}
};

class ForwardingTest : public ::testing::Test {
 protected:
  ForwardingTest() {
    forwarding_.Start();
    EXPECT_TRUE(testing::Eventually([&] { return !forwarding_.incomplete(); }));
  }
  ~ForwardingTest() override { forwarding_.Stop(); }

  std::unique_ptr<session::ForwardReceiver> Join(const std::string& robot) {
    return forwarding_.source().Join({.ruri = robot, .fleet = "north"}, {&nobody_, 1});
  }
  /// One change of the item is followed, before the next is made.
  void Set(const std::string& id) {
    Change([&](ScriptedItems& items) {
      items.Set(KeyOf("a", id), 0,
                R"({"type":"Point","coordinates":[)" + std::to_string(++places_) + R"(.5,2.0]})");
    });
  }
  void Erase(const std::string& id) {
    Change([&](ScriptedItems& items) { items.Erase(KeyOf("a", id)); });
  }
  std::string Page() const {
    metrics::Exposition page;
    forwarding_.AddSamples(page);
    return page.Text();
  }
  static std::vector<EncodedFrame> Take(session::ForwardReceiver& receiver) {
    std::vector<EncodedFrame> frames;
    for (std::size_t before = 1; before != frames.size();) {
      before = frames.size();
      receiver.Take(frames);
    }
    return frames;
  }
  /// The number of the one command among the frames.
  static nexus_command::CommandId CommandOf(const std::vector<EncodedFrame>& frames) {
    EXPECT_THAT(frames, SizeIs(1));
    v1::RelayResponse response;
    if (frames.empty() || !response.ParseFromString(*frames.front())) return {};
    const auto command = nexus_command::Decode(response.forward().nexus_command());
    EXPECT_TRUE(command.ok()) << command.status();
    return command.ok() ? command->id : nexus_command::CommandId{};
  }

 private:
  template <typename Do>
  void Change(const Do& change) {
    items_.With(change);
    ++changes_;
    forwarding_.Wake();
    const std::string followed =
        "\nuplinkd_forward_changes_total " + std::to_string(changes_) + "\n";
    ASSERT_TRUE(testing::Eventually([&] { return Page().find(followed) != std::string::npos; }));
  }

  SystemClock clock_;
  testing::FakeTrust trust_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  LockedItems items_;
  Nobody nobody_;
  int changes_ = 0;
  int places_ = 0;
  Forwarding forwarding_{
      {.clock = clock_, .logger = logger_, .items = items_, .clock_trust = trust_, .seed = 1}};
};

TEST_F(ForwardingTest, EachWayInWhichAForwardIsSettledHasItsLabel) {
  {
    const auto leaves = Join("leaves");
    Take(*leaves);
    Set("1");
  }
  const auto reads = Join("reads");
  Take(*reads);
  for (const char* id : {"2", "2", "2"}) Set(id);
  Take(*reads);
  for (const char* id : {"3", "4", "5"}) {
    Set(id);
    Take(*reads);
  }
  const auto waits = Join("waits");
  for (const char* id : {"6", "7", "8"}) Set(id);
  const std::string page = Page();
  // 1 for `leaves`; 3, 3 and 3 for `reads`; 3 for `waits`, to which no snapshot began.
  EXPECT_THAT(page, HasSubstr("\nuplinkd_forwards_due_total 13\n"));
  EXPECT_THAT(page, HasSubstr("\nuplinkd_forwards_settled_total{outcome=\"written\"} 4\n"));
  EXPECT_THAT(page, HasSubstr("\nuplinkd_forwards_settled_total{outcome=\"coalesced\"} 2\n"));
  EXPECT_THAT(page, HasSubstr("\nuplinkd_forwards_settled_total{outcome=\"snapshot\"} 3\n"));
  EXPECT_THAT(page, HasSubstr("\nuplinkd_forwards_settled_total{outcome=\"dropped\"} 1\n"));
  EXPECT_THAT(page, HasSubstr("\nuplinkd_forwards_waiting 3\n"));
}

TEST_F(ForwardingTest, EachChangeHasANumberOfItsOwn) {
  const auto receiver = Join("b");
  Take(*receiver);
  std::set<nexus_command::CommandId> commands;
  Set("pit");
  commands.insert(CommandOf(Take(*receiver)));
  Erase("pit");
  commands.insert(CommandOf(Take(*receiver)));
  Set("pit");
  commands.insert(CommandOf(Take(*receiver)));
  Set("pit");
  commands.insert(CommandOf(Take(*receiver)));
  EXPECT_THAT(commands, SizeIs(4)) << "the end of an item, and its next beginning, too";
}

}  // namespace
}  // namespace uplink::forward
