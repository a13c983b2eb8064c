// How PEM files are read.
#include "server/identity/server_pair.h"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/certificates.h"
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
  EXPECT_THAT(pem.status().message(), AllOf(HasSubstr("none.pem"), HasSubstr("cannot be read")));
}

// A broker may take certificates without an extended key usage, or with whatever it likes.
TEST(ClientPair, IsACertificateAndItsOwnKey) {
  const testing::TestAuthority authority;
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.key_usages.clear();
  const testing::KeyPair pair = authority.Issue(spec);
  EXPECT_TRUE(CheckClientPair({"c.crt", pair.certificate}, {"c.key", pair.key}).ok());
  EXPECT_THAT(
      CheckClientPair({"c.crt", pair.certificate}, {"c.key", authority.Issue(spec).key}).message(),
      HasSubstr("c.key: is not the key of c.crt"));
  EXPECT_THAT(CheckClientPair({"c.crt", "text"}, {"c.key", pair.key}).message(),
              HasSubstr("c.crt: holds no PEM certificate"));
}

}  // namespace
}  // namespace uplink::identity
