#include "server/health/process.h"

#include <fstream>

#include <gtest/gtest.h>

namespace uplink::health {
namespace {

TEST(Process, ReadsFiguresThatCannotBeZero) {
  const ProcessFigures figures = ReadProcess();
  EXPECT_GT(figures.resident_bytes, 0U);
  EXPECT_GE(figures.threads, 1U);
  EXPECT_GE(DescriptorsMax(), OpenDescriptors());
}

TEST(Process, CountsADescriptorThatIsOpened) {
  const std::size_t before = OpenDescriptors();
  const std::ifstream open("/proc/self/stat");
  EXPECT_EQ(OpenDescriptors(), before + 1);
}

}  // namespace
}  // namespace uplink::health
