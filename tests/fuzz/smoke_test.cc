// SPDX-License-Identifier: MIT
// The fuzzers' targets in every build: each seed, and thousands of damaged copies of it that are
// the same in every run. Files that once broke a reader are seeds too.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "fuzz_targets.h"
#include "sanitized.h"

namespace batten::internal::smoke_test {

// CPU time that no file of a few thousand bytes may take, and memory that none may add.
constexpr double kMostSeconds = 1;
constexpr double kMostBytes = 64 << 20;

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double PeakBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024;
}

struct Seed {
  std::string name, bytes;
};

// In the order of their names.
std::vector<Seed> Seeds(const std::string& target) {
  std::vector<Seed> seeds;
  const std::string folder = BATTEN_SOURCE_DIR "/tests/fuzz/seeds/" + target;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    seeds.push_back({entry.path().filename(), {std::istreambuf_iterator<char>(file), {}}});
  }
  std::sort(
      seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) { return a.name < b.name; });
  return seeds;
}

// Damages a file the way files are damaged, and the way an enemy would.
class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string Damaged(std::string bytes, const std::vector<Seed>& others) {
    for (std::uint64_t times = 1 + Below(3); times > 0; --times) {
      if (bytes.empty()) return bytes;
      switch (Below(6)) {
        case 0:
          bytes[Below(bytes.size())] ^= static_cast<char>(1u << Below(8));
          break;
        case 1:
          bytes[Below(bytes.size())] = static_cast<char>(Below(256));
          break;
        case 2:
          bytes.resize(Below(bytes.size()));
          break;
        case 3:
          Splice(bytes, others[Below(others.size())].bytes);
          break;
        case 4:
          Repeat(bytes);
          break;
        default:
          ReplaceNumber(bytes);
      }
    }
    return bytes;
  }

 private:
  std::uint64_t Below(std::uint64_t end) { return random_() % end; }

  // A piece of another file over a piece of this one.
  void Splice(std::string& bytes, const std::string& other) {
    const std::size_t from = Below(other.size() + 1), to = Below(bytes.size());
    bytes.replace(to, Below(32), other.substr(from, Below(64)));
  }

  void Repeat(std::string& bytes) {
    const std::size_t begin = Below(bytes.size());
    bytes.insert(begin, bytes.substr(begin, 1 + Below(40)));
  }

  void ReplaceNumber(std::string& bytes) {
    constexpr std::string_view kDigits = "0123456789";
    constexpr std::array<std::string_view, 12> kNumbers{"4294967295",
                                                        "2147483648",
                                                        "-1",
                                                        "0",
                                                        "1e308",
                                                        "-1e150",
                                                        "5e-324",
                                                        "nan",
                                                        "inf",
                                                        "1",
                                                        "3",
                                                        "9223372036854775807"};
    const std::size_t first = bytes.find_first_of(kDigits, Below(bytes.size()));
    if (first == bytes.npos) return;
    const std::size_t end =
        std::min(bytes.find_first_not_of(".eE+-0123456789", first), bytes.size());
    bytes.replace(first, end - first, kNumbers[Below(kNumbers.size())]);
  }

  std::mt19937_64 random_;
};

std::string Escaped(std::string_view bytes) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7f && c != '\\') {
      text += c;
    } else {
      text += std::string("\\x") + kHex[byte >> 4] + kHex[byte & 15];
    }
  }
  return text;
}

void ExpectLaws(void (*run)(std::string_view), std::string_view bytes, const std::string& what) {
  const double start = CpuSeconds();
  try {
    run(bytes);
  } catch (const std::exception& error) {
    ADD_FAILURE() << what << ": " << error.what() << "\n" << Escaped(bytes);
  }
  EXPECT_LT(CpuSeconds() - start, kMostSeconds) << what << "\n" << Escaped(bytes);
}

// Every seed, and `copies` damaged ones of each.
void Smoke(const std::string& target, void (*run)(std::string_view), int copies) {
  const std::vector<Seed> seeds = Seeds(target);
  ASSERT_FALSE(seeds.empty()) << target;
  ExpectLaws(run, seeds[0].bytes, seeds[0].name);  // what libraries take at their first call
  const double before = PeakBytes();
  for (const Seed& seed : seeds) {
    ExpectLaws(run, seed.bytes, seed.name);
    Mutator mutator(1);
    for (int k = 0; k < copies; ++k) {
      ExpectLaws(run, mutator.Damaged(seed.bytes, seeds), seed.name + ", damaged");
      if (::testing::Test::HasFailure()) return;
    }
  }
  if (kMemoryIsTheProgramsOwn) {
    EXPECT_LT(PeakBytes() - before, kMostBytes);
  }
}

TEST(FuzzSmokeTest, PcdIsReadOrRefused) { Smoke("pcd", FuzzPcd, 200); }
TEST(FuzzSmokeTest, PlyIsReadOrRefused) { Smoke("ply", FuzzPly, 300); }
TEST(FuzzSmokeTest, TextIsReadOrRefused) { Smoke("text", FuzzText, 300); }
TEST(FuzzSmokeTest, LasIsReadOrRefused) { Smoke("las", FuzzLas, 300); }
TEST(FuzzSmokeTest, ObjIsReadOrRefused) { Smoke("obj", FuzzObj, 300); }
TEST(FuzzSmokeTest, StlIsReadOrRefused) { Smoke("stl", FuzzStl, 300); }
TEST(FuzzSmokeTest, OffIsReadOrRefused) { Smoke("off", FuzzOff, 300); }
TEST(FuzzSmokeTest, PolygonsAreReadOrRefused) { Smoke("polygons", FuzzPolygons, 300); }
TEST(FuzzSmokeTest, JsonIsReadOrRefused) { Smoke("json", FuzzJson, 1000); }
TEST(FuzzSmokeTest, IgesIsReadOrRefused) { Smoke("iges", FuzzIges, 1000); }
TEST(FuzzSmokeTest, IgesEntitiesAreReadOrRefused) {
  Smoke("iges_entities", FuzzIgesEntities, 1000);
}
TEST(FuzzSmokeTest, StepSyntaxIsAcceptedOrRefused) { Smoke("step_syntax", FuzzStepSyntax, 2000); }
// OpenCASCADE behind it takes milliseconds a file, and some memory once.
TEST(FuzzSmokeTest, StepIsReadOrRefused) { Smoke("step", FuzzStep, 60); }
TEST(FuzzSmokeTest, BrepIsReadOrRefused) { Smoke("brep", FuzzBrep, 300); }

}  // namespace batten::internal::smoke_test
