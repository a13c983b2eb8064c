// The seeds of fuzz_uncrew: a request of each type with every field.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/unit/schema/uncrew/requests.h"
#include "tests/unit/schema/uncrew/samples.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    static_cast<void>(std::fputs("usage: make_uncrew_corpus FOLDER\n", stderr));
    return 2;
  }
  for (const auto& sample : uplink::uncrew::test::kSamples) {
    const std::filesystem::path path =
        std::filesystem::path(argv[1]) / uplink::model::uncrew::RowOf(sample.type).member;
    std::ofstream file(path, std::ios::binary);
    file << static_cast<char>(sample.type)
         << uplink::uncrew::test::RequestOf(sample.type, sample.text);
    if (!file.flush()) return 1;
  }
  return 0;
}
