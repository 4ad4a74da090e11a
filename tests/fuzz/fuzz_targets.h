// SPDX-License-Identifier: MIT
// One function for every reader of files: bytes in, and nothing out unless the reader is wrong.
// libFuzzer drives them (fuzz_main.cc, preset `fuzz`), and the smoke test does in every build.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace batten::internal {

// A law the reader has broken.
class BrokenLaw : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void RequireLaw(bool holds, const std::string& law) {
  if (!holds) throw BrokenLaw(law);
}

// Each reads the bytes as a file of its format. ReadError is an answer; every other exception
// passes through and is a finding. What is read must be whole: finite numbers, counts that add up,
// and the same again by another way in.
void FuzzPcd(std::string_view bytes);
void FuzzPly(std::string_view bytes);
void FuzzText(std::string_view bytes);
void FuzzLas(std::string_view bytes);
void FuzzObj(std::string_view bytes);
void FuzzStl(std::string_view bytes);
void FuzzOff(std::string_view bytes);

// Geometry as JSON; what is read and written reads back the same.
void FuzzJson(std::string_view bytes);

// IGES as it stands, and as lines "type,form,transform,status;parameters" that are laid out in the
// columns of the format first, so that mutations get past them.
void FuzzIges(std::string_view bytes);
void FuzzIgesEntities(std::string_view bytes);

// The check of STEP's syntax before OpenCASCADE sees a file, and the whole reader.
void FuzzStepSyntax(std::string_view bytes);
void FuzzStep(std::string_view bytes);

// The whole reader of OpenCASCADE's own B-rep.
void FuzzBrep(std::string_view bytes);

// The reader of faces; the first byte says the format: o(bj), (of)f, s(tl), else PLY. The rest is
// the file. What is read and written as OBJ reads back the same.
void FuzzPolygons(std::string_view bytes);

// The file that FuzzIgesEntities reads.
std::string LaidOutIges(std::string_view entities);

}  // namespace batten::internal
