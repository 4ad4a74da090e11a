// SPDX-License-Identifier: MIT
// batten-verify: proves anew, in interval arithmetic, what a certificate of batten claims. It
// shares no code with batten.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "claims.h"

namespace {

using verify::Json;

constexpr int kProved = 0, kUnusable = 1, kUsage = 2, kNotProved = 3;

const char kHelp[] =
    "Usage: batten-verify CERTIFICATE.json [--geometry FILE.json]\n"
    "\n"
    "Proves the claims of a certificate that `batten compare --certificate` or `batten fit\n"
    "... --certificate` wrote, in interval arithmetic rounded outwards, with code of its own:\n"
    "  upper bounds   the named place belongs to the geometry and is so near to the point\n"
    "  lower bounds   no place of the geometry is nearer\n"
    "  regularity     the normal vanishes nowhere, but in the parts the certificate lists\n"
    "\n"
    "  --geometry FILE.json   the certificate's geometry must be this file's, number by number\n"
    "  --help                 this page\n"
    "\n"
    "Exit codes: 0 everything is proved, 1 a file can't be used, 2 usage, 3 something is not "
    "proved.\n"
    "\n"
    "Example:\n"
    "  batten compare part.json scan.ply --certificate proof.json\n"
    "  batten-verify proof.json --geometry part.json\n";

Json Load(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + " can't be opened");
  return Json::parse(file);
}

class Verdict {
 public:
  void Count(bool proved, const std::string& claim) {
    ++claims_;
    if (proved) return;
    if (++open_ <= kShown) std::printf("not proved: %s\n", claim.c_str());
  }
  int Conclude() const {
    std::printf("%ld of %ld claims proved\n", claims_ - open_, claims_);
    return open_ == 0 ? kProved : kNotProved;
  }

 private:
  static constexpr long kShown = 20;
  long claims_ = 0, open_ = 0;
};

struct Geometry {
  verify::Shape shape;
  verify::Region region;
  explicit Geometry(const Json& entry) : shape(verify::Read(entry)), region(shape) {}
};

void CheckPoints(const Json& certificate,
                 const std::vector<Geometry>& geometries,
                 Verdict& verdict) {
  double max_upper = 0, max_lower = 0;
  const Json& rows = certificate.at("points");
  for (size_t k = 0; k < rows.size(); ++k) {
    const Json& row = rows[k];
    const verify::Point q{
        row.at(0).get<double>(), row.at(1).get<double>(), row.at(2).get<double>()};
    const auto lower = row.at(3).get<double>(), upper = row.at(4).get<double>();
    const auto index = row.at(5).get<size_t>();
    const auto loop = row.at(6).get<int>();
    const auto u = row.at(7).get<double>(), v = row.at(8).get<double>();
    max_upper = std::max(max_upper, upper);
    max_lower = std::max(max_lower, lower);
    const std::string name = "point " + std::to_string(k);
    const Geometry& near = geometries.at(index);
    verdict.Count(verify::ProveUpper(near.shape, near.region, q, upper, u, v, loop),
                  name + ": at most " + std::to_string(upper) + " from the geometry");
    for (const Geometry& geometry : geometries)
      verdict.Count(verify::ProveLower(geometry.shape, geometry.region, q, lower),
                    name + ": at least " + std::to_string(lower) + " from the geometry");
  }
  const Json& summary = certificate.at("certified");
  verdict.Count(summary.at("max_upper").get<double>() >= max_upper, "max_upper");
  verdict.Count(summary.at("max_lower").get<double>() <= max_lower, "max_lower");
}

// Whether one of the listed boxes holds the box.
bool Listed(const Json& boxes, const std::array<double, 4>& box) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const Json& listed) {
    const auto at = listed.get<std::array<double, 4>>();
    return at[0] <= box[0] && at[1] >= box[1] && at[2] <= box[2] && at[3] >= box[3];
  });
}

void CheckRegularity(const Json& certificate,
                     const std::vector<Geometry>& geometries,
                     Verdict& verdict) {
  for (const Json& claim : certificate.at("regularity")) {
    const auto index = claim.at("index").get<size_t>();
    const Geometry& geometry = geometries.at(index);
    long open = 0;
    for (const auto& box : verify::UnprovedRegularity(geometry.shape, geometry.region))
      open += !Listed(claim.at("unproved"), box);
    verdict.Count(open == 0,
                  "geometry " + std::to_string(index) + ": the normal vanishes nowhere (" +
                      std::to_string(open) + " parts)");
  }
}

int Run(const std::string& path, const std::string& geometry) {
  const Json certificate = Load(path);
  if (certificate.value("schema", "") != "batten-certificate-1")
    throw std::runtime_error("is no certificate (schema batten-certificate-1)");
  const Json& shape = certificate.at("geometry");
  Verdict verdict;
  if (!geometry.empty())
    verdict.Count(Load(geometry).at("shape").at("data") == shape.at("data"),
                  geometry + " is the certificate's geometry");
  std::vector<Geometry> geometries;
  for (const Json& entry : shape.at("data")) geometries.emplace_back(entry);
  CheckPoints(certificate, geometries, verdict);
  CheckRegularity(certificate, geometries, verdict);
  for (const Json& what : certificate.at("certified").at("unproved"))
    std::printf("the certificate leaves open: %s\n", what.get<std::string>().c_str());
  return verdict.Conclude();
}

int Usage(const std::string& reason) {
  std::fprintf(stderr, "batten-verify: %s; see batten-verify --help\n", reason.c_str());
  return kUsage;
}

}  // namespace

int main(int count, char** values) {
  std::string path, geometry;
  for (int k = 1; k < count; ++k) {
    const std::string word = values[k];
    if (word == "--help" || word == "-h") {
      std::fputs(kHelp, stdout);
      return kProved;
    }
    if (word == "--geometry") {
      if (++k == count) return Usage(word + " needs a value");
      geometry = values[k];
      continue;
    }
    if (word.starts_with("-") || !path.empty()) return Usage("'" + word + "' is not understood");
    path = word;
  }
  if (path.empty()) return Usage("a certificate is needed");
  try {
    return Run(path, geometry);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "batten-verify: %s: %s\n", path.c_str(), error.what());
    return kUnusable;
  }
}
