// How PEM files are read.
#include "server/identity/pem_file.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/temp_folder.h"

namespace uplink::identity {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ReadPemTest : public ::testing::Test {
 protected:
  std::string File(std::size_t bytes) {
    std::string path = folder_.File("file.pem");
    std::ofstream(path, std::ios::binary) << std::string(bytes, 'x');
    return path;
  }

  testing::TempFolder folder_;
};

TEST_F(ReadPemTest, ReadsTheWholeFileWhateverItsSize) {
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, std::size_t{16} * 1024,
                                  std::size_t{16} * 1024 + 1, kPemBytesMax}) {
    const auto pem = ReadPem(File(bytes));
    ASSERT_TRUE(pem.ok()) << bytes << ": " << pem.status();
    EXPECT_EQ(pem->text, std::string(bytes, 'x')) << bytes;
  }
}

TEST_F(ReadPemTest, TakesNoMoreMemoryThanAFileNeeds) {
  const auto pem = ReadPem(File(2000));
  ASSERT_TRUE(pem.ok());
  EXPECT_LE(pem->text.capacity(), 8000U);
}

TEST_F(ReadPemTest, AFileThatIsTooLargeIsNamedWithTheLimit) {
  const auto pem = ReadPem(File(kPemBytesMax + 1));
  EXPECT_THAT(pem.status().message(),
              AllOf(HasSubstr("file.pem"), HasSubstr("is larger than 4194304 bytes")));
}

TEST_F(ReadPemTest, AFileThatIsNotThereIsNamed) {
  const auto pem = ReadPem(folder_.File("none.pem"));
  EXPECT_THAT(pem.status().message(), HasSubstr("none.pem: cannot be read: No such file"));
}

TEST_F(ReadPemTest, AFolderAndAPipeAreNamedWithoutWaitingForAWriter) {
  const std::string pipe = folder_.File("pipe.pem");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(ReadPem(pipe).status().message(), pipe + ": is not a regular file; name a PEM file");
  const std::string folder = folder_.File("folder");
  std::filesystem::create_directory(folder);
  EXPECT_EQ(ReadPem(folder).status().message(),
            folder + ": is not a regular file; name a PEM file");
}

}  // namespace
}  // namespace uplink::identity
