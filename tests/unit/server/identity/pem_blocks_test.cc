// How a PEM text is split into blocks; authorities_test.cc has the damaged lines.
#include "server/identity/pem_blocks.h"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/pem_texts.h"

namespace uplink::identity {
namespace {

using ::testing::AllOf;
using testing::BlockOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using testing::WithCrlf;

constexpr std::string_view kMark = "\xEF\xBB\xBF";

std::vector<PemBlock> Split(const std::string& text) {
  const NamedPem pem{"a.pem", text};
  auto blocks = BlocksOf(pem);
  EXPECT_TRUE(blocks.ok()) << blocks.status();
  if (!blocks.ok()) return {};
  const absl::Status good = CheckBlocks(pem, *blocks);
  EXPECT_TRUE(good.ok()) << good;
  return *std::move(blocks);
}

std::vector<PemKind> Kinds(const std::string& text) {
  std::vector<PemKind> kinds;
  for (const PemBlock& block : Split(text)) kinds.push_back(block.kind);
  return kinds;
}

/// The error message for the text; empty if it is good.
std::string ErrorOf(const std::string& text) {
  const NamedPem pem{"a.pem", text};
  const auto blocks = BlocksOf(pem);
  return std::string((blocks.ok() ? CheckBlocks(pem, *blocks) : blocks.status()).message());
}

TEST(PemBlocks, EachLabelHasItsKind) {
  for (const char* label : {"CERTIFICATE", "X509 CERTIFICATE", "TRUSTED CERTIFICATE"}) {
    EXPECT_THAT(Kinds(BlockOf(label)), ElementsAre(PemKind::kCertificate)) << label;
  }
  for (const char* label : {"PRIVATE KEY", "EC PRIVATE KEY", "RSA PRIVATE KEY"}) {
    EXPECT_THAT(Kinds(BlockOf(label)), ElementsAre(PemKind::kKey)) << label;
    EXPECT_THAT(Kinds(BlockOf(label, "Proc-Type: 4,ENCRYPTED\nDEK-Info: AES-128-CBC,00\n\nAA\n")),
                ElementsAre(PemKind::kEncryptedKey))
        << label;
  }
  EXPECT_THAT(Kinds(BlockOf("ENCRYPTED PRIVATE KEY")), ElementsAre(PemKind::kEncryptedKey));
  for (const char* label :
       {"EC PARAMETERS", "DH PARAMETERS", "X9.42 DH PARAMETERS", "DSA PARAMETERS", "PUBLIC KEY",
        "RSA PUBLIC KEY", "CERTIFICATE REQUEST", "NEW CERTIFICATE REQUEST"}) {
    EXPECT_THAT(Kinds(BlockOf(label)), ElementsAre(PemKind::kPassedOver)) << label;
  }
}

TEST(PemBlocks, OtherLabelsAreRefusedByNumberLineAndName) {
  const std::string first = BlockOf("CERTIFICATE");
  for (const char* label : {"OPENSSH PRIVATE KEY", "DSA PRIVATE KEY", "PKCS7", "certificates",
                            "CERTIFICATES", "PGP MESSAGE"}) {
    EXPECT_THAT(
        ErrorOf(first + BlockOf(label)),
        AllOf(HasSubstr("a.pem: PEM block 2, from line 3, cannot be used"), HasSubstr(label)))
        << label;
  }
  EXPECT_THAT(ErrorOf(first + BlockOf("X509 CRL")),
              HasSubstr("block 2, from line 3, cannot be used: lists of revoked certificates"));
}

TEST(PemBlocks, ALabelIsRepeatedAsFarAsItIsTextAndShort) {
  EXPECT_THAT(ErrorOf(BlockOf("A\x1b[2J\xff")), HasSubstr("holds no A\\x1b[2J\\xff"));
  EXPECT_LT(ErrorOf(BlockOf(std::string(100'000, 'A'))).size(), 200U);
}

TEST(PemBlocks, KnowWhereTheyStand) {
  const std::string text = "notes\n\n" + BlockOf("CERTIFICATE", "AA\n") + "between\n" +
                           BlockOf("PRIVATE KEY", "BB\n") + "\nbehind";
  const std::vector<PemBlock> blocks = Split(text);
  ASSERT_THAT(blocks, SizeIs(2));
  EXPECT_EQ(blocks[0].number, 1U);
  EXPECT_EQ(blocks[0].line, 3U);
  const NamedPem pem{"a.pem", text};
  EXPECT_EQ(std::string(TextOf(pem, blocks[0])) + "\n", BlockOf("CERTIFICATE", "AA\n"));
  EXPECT_EQ(blocks[1].number, 2U);
  EXPECT_EQ(blocks[1].line, 7U);
  EXPECT_EQ(std::string(TextOf(pem, blocks[1])) + "\n", BlockOf("PRIVATE KEY", "BB\n"));
}

TEST(PemBlocks, ATextMayHaveNoneAndEndInTheMiddleOfALine) {
  EXPECT_THAT(Split(""), IsEmpty());
  EXPECT_THAT(Split("\n\n"), IsEmpty());
  EXPECT_THAT(Split(std::string(1, '\0')), IsEmpty());
  std::string last = BlockOf("PRIVATE KEY");
  last.pop_back();
  EXPECT_THAT(Split(last), SizeIs(1));
}

TEST(PemBlocks, LinesMayEndAsOnWindowsAndInBlanks) {
  EXPECT_THAT(Kinds(WithCrlf(BlockOf("EC PARAMETERS") + BlockOf("PRIVATE KEY"))),
              ElementsAre(PemKind::kPassedOver, PemKind::kKey));
  EXPECT_THAT(Kinds("-----BEGIN PRIVATE KEY----- \t\n-----END PRIVATE KEY-----  \n"),
              ElementsAre(PemKind::kKey));
}

TEST(PemBlocks, AByteOrderMarkMayBeginATextAndNoOtherLineOfABlock) {
  EXPECT_THAT(Kinds(std::string(kMark) + BlockOf("PRIVATE KEY")), ElementsAre(PemKind::kKey));
  EXPECT_EQ(ErrorOf(std::string(kMark) + "notes\n" + BlockOf("PRIVATE KEY")), "");
  EXPECT_EQ(
      ErrorOf(BlockOf("CERTIFICATE") + std::string(kMark) + BlockOf("PRIVATE KEY")),
      "a.pem: PEM block 2, from line 3, is broken: a byte order mark stands before its BEGIN");
}

TEST(PemBlocks, AKeyWhoseLinesAreDamagedIsNotPassedOver) {
  for (const auto& [first, last] : std::vector<std::pair<std::string, std::string>>{
           {"----BEGIN PRIVATE KEY-----", "-----END PRIVATE KEY-----"},
           {" -----BEGIN PRIVATE KEY-----", "-----END PRIVATE KEY-----"},
           {"-----BEGIN PRIVATE KEY----", "-----END PRIVATE KEY-----"},
           {"----- BEGIN PRIVATE KEY -----", "----- END PRIVATE KEY -----"},
           {"-----BEGIN PRIVATE KEY-----", "-----END EC PRIVATE KEY-----"},
           {"-----BEGIN PRIVATE KEY-----", ""},
           {"", "-----END PRIVATE KEY-----"},
           {"MIIEvQ", ""}}) {
    EXPECT_THAT(ErrorOf(fmt::format("{}{}\nAA\n{}\n", BlockOf("EC PARAMETERS"), first, last)),
                HasSubstr("PEM block 2, from line"))
        << first << last;
  }
}

TEST(PemBlocks, ThereMayBeAsManyAsTheBound) {
  std::string text;
  for (std::size_t i = 0; i < kPemBlocksMax; ++i) text += BlockOf("PUBLIC KEY");
  EXPECT_THAT(Split(text), SizeIs(kPemBlocksMax));
  EXPECT_EQ(ErrorOf(text + BlockOf("PUBLIC KEY")), "a.pem: holds more than 4096 PEM blocks");
}

TEST(PemBlocks, OneMayHaveAsManyBytesAsTheBound) {
  const std::size_t marks = BlockOf("PUBLIC KEY").size() - 1;  // without the last line's end
  const std::string full(kPemBlockBytesMax - marks - 1, 'A');
  EXPECT_THAT(Split(BlockOf("PUBLIC KEY", full + "\n")), SizeIs(1));
  EXPECT_THAT(ErrorOf(BlockOf("PUBLIC KEY", full + "A\n")),
              HasSubstr("block 1, from line 1, cannot be used: it has 65537 bytes, at most 65536"));
}

}  // namespace
}  // namespace uplink::identity
