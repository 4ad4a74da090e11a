// SPDX-License-Identifier: MIT
// The report of a fit or a comparison as JSON text.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/form_deviation.h"
#include "batten/fitting/part_options.h"
#include "batten/fitting/profile_check.h"
#include "batten/fitting/rigid_alignment.h"
#include "batten/io/certificate.h"

namespace batten {

// What was proved and checked besides, each where it was asked for.
struct ReportChecks {
  std::optional<CertificateSummary> certified;
  std::optional<FormDeviation> form;
  std::optional<RigidAlignment> alignment;
  std::optional<ProfileVerdict> profile;
};

// What the program knows beyond the fit itself.
struct ReportContext {
  std::string command;                              // the command line
  std::string file;                                 // the geometry file the report is about
  std::string unit = "mm";                          // of the data
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates written
  std::int64_t peak_memory_bytes = 0;
  std::string version;    // of the program
  std::string date = {};  // as the page shows it; empty: none
  ReportChecks checks = {};
  const PartSummary* part = nullptr;  // the faces, where a part was taken to pieces
};

// The schema "batten-report-2", indented, ending with a line feed. Numbers are written in the
// shortest form that reads back bit by bit; one that is not finite, for which JSON has no form, as
// null, and so is what was not measured. Only where it applies: input.thinned_to, and parts, one
// {index, name, geometry, and the fields of an error} for each of several geometries. Of a part
// faces, one {index, kind, points, rms, max, primitive, touching} for each, and relations, {kind,
// faces, deviation, allowed, kept}.
std::string ToReportJson(const FitReport& report, const ReportContext& context);

}  // namespace batten
