// Faults that ./dev lint must find: each comment names the checks that must report its line, and
// nothing else in here may be reported. Only clang-tidy reads this file.
#include "tools/dev/lint/planted/faults.h"

#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#define UPLINK_PLANTED_DOUBLE(x) x * 2  // finds: bugprone-macro-parentheses
#define UPLINK_PLANTED_CASE(name) std::size_t name(std::string value)

namespace uplink::planted {
namespace {

UPLINK_PLANTED_CASE(MovedInMacro) {
  const std::string moved = std::move(value);
  return moved.size() + value.size();  // finds: bugprone-use-after-move
}

enum class Colour { kRed, green };  // finds: readability-identifier-naming

struct Moves {
  Moves() = default;
  Moves(Moves&& other) {  // finds: performance-noexcept-move-constructor
    text = std::move(other.text);
  }
  std::string text;
};

int lower_case_counter = 0;

void BadParameter(int BadName) {  // finds: readability-identifier-naming
  lower_case_counter += BadName;
}

std::size_t Copied(std::string text) {  // finds: performance-unnecessary-value-param
  return text.size();
}

std::string LongText(const std::map<int, std::string>& texts) {
  std::string sum;
  for (const auto& each : texts) {
    const std::string& text = each.second;
    sum = sum + text;  // finds: performance-inefficient-string-concatenation
  }
  return sum;
}

std::size_t CopyOfFirst(const std::vector<std::string>& texts) {
  const std::string first = texts.front();  // finds: performance-unnecessary-copy-initialization
  return first.size();
}

int Branch(int number) {
  if (number > 3) {  // finds: bugprone-branch-clone
    return 1;
  } else {
    return 1;
  }
}

void Endless(int number) {
  int other = 0;
  while (number < 10) {  // finds: bugprone-infinite-loop
    ++other;
  }
}

int Number(const char* text) { return std::atoi(text); }  // finds: cert-err34-c

const char* Cause(int number) { return std::strerror(number); }  // finds: concurrency-mt-unsafe

std::string_view Dangling() {
  std::string_view view = std::string("gone");  // finds: clang-diagnostic-dangling-gsl
  return view;
}

void Lambda() {
  auto owned = std::make_unique<int>(1);
  auto use = [&owned] {
    auto taken = std::move(owned);
    return *owned + *taken;  // finds: bugprone-use-after-move
  };
  lower_case_counter += use();
}

int Nested(int number) {  // finds: readability-function-size
  if (number > 1) {
    if (number > 2) {
      if (number > 3) {
        if (number > 4) {
          if (number > 5) {
            return 1;
          }
        }
      }
    }
  }
  return 0;
}

int Shadowed(int number) {
  if (number > 1) {
    const int number = 2;  // finds: clang-diagnostic-shadow
    return number;
  }
  return number;
}

}  // namespace

std::size_t All() {
  BadParameter(static_cast<int>(Colour::green));
  Endless(Branch(1) + Nested(2) + Shadowed(3) + Number("4"));
  Lambda();
  Moves moves;
  const Moves moved = std::move(moves);
  const int doubled = UPLINK_PLANTED_DOUBLE(2);
  return Copied(LongText({})) + Dangling().size() + std::strlen(Cause(doubled)) +
         CopyOfFirst({"a"}) + MovedInMacro("b") + moved.text.size() +
         SizeAfterMove(std::string("text")) + Characters({});
}

}  // namespace uplink::planted
