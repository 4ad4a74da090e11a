// SPDX-License-Identifier: MIT
// batten-verify: proves anew, in interval arithmetic, what a certificate of batten claims. It
// shares no code with batten.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "claims.h"

namespace {

using verify::Json;

constexpr int kProved = 0, kUnusable = 1, kUsage = 2, kNotProved = 3;

const char kHelp[] =
    "Usage: batten-verify CERTIFICATE.json [--geometry FILE.json]\n\n"
    "Proves the claims of a certificate that `batten compare --certificate` or `batten fit\n"
    "... --certificate` wrote, in interval arithmetic rounded outwards, with code of its own:\n"
    "  upper bounds   the named place belongs to the geometry and is so near to the point\n"
    "  lower bounds   no place of the geometry is nearer\n"
    "  regularity     the normal vanishes nowhere, but in the parts the certificate lists\n\n"
    "  --geometry FILE.json   the certificate's geometry must be this file's, number by number\n"
    "  --help                 this page\n\n"
    "Exit codes: 0 everything is proved, 1 a file can't be used, 2 usage, 3 not all is proved.\n\n"
    "Example:\n"
    "  batten compare part.json scan.ply --certificate proof.json\n"
    "  batten-verify proof.json --geometry part.json\n";

Json Load(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + " can't be opened");
  return Json::parse(file);
}

struct Geometry {
  verify::Shape shape;
  verify::Region region;
  explicit Geometry(const Json& entry) : shape(verify::Read(entry)), region(shape) {}
};

class Check {
 public:
  explicit Check(const Json& certificate) : certificate_(certificate) {
    for (const Json& entry : certificate.at("geometry").at("data")) geometries_.emplace_back(entry);
  }

  void Count(bool proved, const std::string& claim) {
    constexpr long kShown = 20;
    ++claims_;
    if (!proved && ++open_ <= kShown) std::printf("not proved: %s\n", claim.c_str());
  }

  void Points() {
    const Json& summary = certificate_.at("certified");
    const bool judged = summary.contains("tolerance");
    const double tolerance = judged ? summary.at("tolerance").get<double>() : 0;
    double max_upper = 0, max_lower = 0;
    long within = 0, out = 0, number = 0;
    for (const Json& row : certificate_.at("points")) {
      const auto q = verify::Point{row.at(0), row.at(1), row.at(2)};
      const double lower = row.at(3), upper = row.at(4);
      const verify::Place place{row.at(7), row.at(8), row.at(6)};
      max_upper = std::max(max_upper, upper);
      max_lower = std::max(max_lower, lower);
      within += upper <= tolerance, out += lower > tolerance;
      const std::string name = "point " + std::to_string(number++);
      const Geometry& near = geometries_.at(row.at(5).get<size_t>());
      Count(verify::ProveUpper(near.shape, near.region, q, upper, place),
            name + ": at most " + std::to_string(upper) + " from the geometry");
      for (const Geometry& geometry : geometries_)
        Count(verify::ProveLower(geometry.shape, geometry.region, q, lower),
              name + ": at least " + std::to_string(lower) + " from the geometry");
    }
    Count(summary.at("max_upper").get<double>() >= max_upper, "max_upper");
    Count(summary.at("max_lower").get<double>() <= max_lower, "max_lower");
    if (!judged) return;
    Count(summary.at("proved_within").get<long>() == within, "proved_within");
    Count(summary.at("proved_out").get<long>() == out, "proved_out");
  }

  void Regularity() {
    std::set<size_t> smooth;
    for (const Json& claim : certificate_.at("regularity")) {
      const auto index = claim.at("index").get<size_t>();
      const Geometry& geometry = geometries_.at(index);
      const auto listed = claim.at("unproved").get<verify::Boxes>();
      long open = 0;
      for (const auto& box : verify::UnprovedRegularity(geometry.shape, geometry.region))
        open += std::none_of(listed.begin(), listed.end(), [&](const auto& at) {
          return at[0] <= box[0] && at[1] >= box[1] && at[2] <= box[2] && at[3] >= box[3];
        });
      Count(open == 0,
            "geometry " + std::to_string(index) + ": no folds, but in " + std::to_string(open) +
                " parts more than are listed");
      if (listed.empty()) smooth.insert(index);
    }
    bool all = !smooth.empty();
    for (size_t k = 0; k < geometries_.size(); ++k)
      all = all && (!geometries_[k].shape.surface || smooth.count(k) > 0);
    const bool claimed = certificate_.at("certified").at("folds_proved_absent").get<bool>();
    Count(all || !claimed, "folds_proved_absent");
  }

  int Conclude() const {
    for (const Json& what : certificate_.at("certified").at("unproved"))
      std::printf("the certificate leaves open: %s\n", what.get<std::string>().c_str());
    std::printf("%ld of %ld claims proved\n", claims_ - open_, claims_);
    return open_ == 0 ? kProved : kNotProved;
  }

 private:
  const Json& certificate_;
  std::vector<Geometry> geometries_;
  long claims_ = 0, open_ = 0;
};

int Run(const std::string& path, const std::string& geometry) {
  const Json certificate = Load(path);
  if (certificate.value("schema", "") != "batten-certificate-1")
    throw std::runtime_error("is no certificate (schema batten-certificate-1)");
  Check check(certificate);
  if (!geometry.empty())
    check.Count(Load(geometry).at("shape").at("data") == certificate.at("geometry").at("data"),
                geometry + " is the certificate's geometry");
  check.Points();
  check.Regularity();
  return check.Conclude();
}

}  // namespace

int main(int count, char** values) {
  const std::vector<std::string> words(values + 1, values + count);
  if (words.size() == 1 && (words[0] == "--help" || words[0] == "-h")) {
    std::fputs(kHelp, stdout);
    return kProved;
  }
  const bool named = words.size() == 3 && words[1] == "--geometry";
  if (!(words.size() == 1 || named) || words[0].starts_with("-")) {
    std::fputs("batten-verify: a certificate is needed; see batten-verify --help\n", stderr);
    return kUsage;
  }
  try {
    return Run(words[0], named ? words[2] : "");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "batten-verify: %s: %s\n", words[0].c_str(), error.what());
    return kUnusable;
  }
}
