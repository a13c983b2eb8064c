#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/support/server_process.h"
#include "tests/support/server_world.h"

namespace uplink::http {
namespace {

/// Runs Prometheus' own checker on a text; its exit code and words.
std::pair<int, std::string> Promtool(const std::string& text) {
  const std::string path = ::testing::TempDir() + "scrape_" + std::to_string(getpid()) + ".txt";
  std::ofstream(path) << text;
  testing::ServerProcess checker({"/bin/sh", "-c", "exec promtool check metrics < \"$0\"", path});
  const std::optional<int> code = checker.WaitForExit();
  std::remove(path.c_str());
  return {code.value_or(-1), checker.text()};
}

TEST(Promtool, HasNothingToSayAboutAScrape) {
  testing::ServerWorld world;
  metrics::MessageCounts counts;
  counts.received = 2;
  counts.stored = 1;
  counts.rejected = 1;
  world.ledgers.NewPage().Publish(counts);
  world.sessions.ack_seconds.Observe(0.003);
  const auto [code, words] = Promtool(world.ScrapeText());
  EXPECT_EQ(code, 0) << words;
  EXPECT_EQ(words, "");
}

TEST(Promtool, CanComplain) {
  EXPECT_NE(Promtool("# TYPE a counter\na 1\n").first, 0);
  EXPECT_NE(Promtool("a{ 1\n").first, 0);
}

}  // namespace
}  // namespace uplink::http
