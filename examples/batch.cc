// SPDX-License-Identifier: MIT
// Many clouds, unattended: a surface and a report beside each, one line for each, and an exit code.
//   batch FOLDER CLOUD...
#include <batten/batten.h>

#include <exception>
#include <filesystem>
#include <iostream>

namespace {

// Whether the fit is good enough to be used unseen.
bool Fit(const std::string& cloud, const std::filesystem::path& result) {
  const batten::SurfaceFit fit = batten::FitSurface(batten::ReadCloud({cloud}).cloud);
  const std::string step = std::filesystem::path(result).replace_extension(".step");
  batten::WriteGeometry({fit.surface}, step);
  batten::ReportContext context;
  context.command = "batch";
  context.file = step;
  batten::AtomicFile report(std::filesystem::path(result).replace_extension(".report.json"));
  report.Write(batten::ToReportJson(fit.report, context));
  report.Commit();
  std::cout << cloud << ": " << fit.report.OneLine() << '\n';
  for (const std::string& warning : fit.report.warnings) std::cout << "  " << warning << '\n';
  return !fit.report.leaves_points();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  int failed = 0;
  for (int k = 2; k < argc; ++k) {
    try {
      const auto name = std::filesystem::path(argv[k]).filename();
      if (!Fit(argv[k], std::filesystem::path(argv[1]) / name)) ++failed;
    } catch (const std::exception& error) {  // this cloud's: the others go on
      std::cout << argv[k] << ": " << error.what() << '\n';
      ++failed;
    }
  }
  return failed == 0 ? 0 : 3;
}
