// SPDX-License-Identifier: MIT
#include "batten/io/step_reader.h"

#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <istream>
#include <streambuf>

#include "batten/io/occt_session.h"
#include "batten/io/occt_shapes.h"
#include "batten/io/read_error.h"
#include "batten/io/step_model.h"
#include "batten/io/step_syntax.h"
#include "batten/io/step_units.h"
#include "batten/io/whole_file.h"

namespace batten {
namespace {

// Text in memory as a stream, without a copy.
class TextBuffer : public std::streambuf {
 public:
  explicit TextBuffer(std::string& text) {
    setg(text.data(), text.data(), text.data() + text.size());
  }
};

std::vector<Geometry> Translate(std::string& text, const std::string& path) {
  STEPControl_Controller::Init();
  STEPControl_Reader reader;
  TextBuffer buffer(text);
  std::istream stream(&buffer);
  if (reader.ReadStream("batten", stream) != IFSelect_RetDone) {
    throw ReadError(path, "is damaged: it can't be parsed as STEP");
  }
  CheckStepModel(reader.StepModel(), path);
  KeepNumbersOf(reader);
  reader.TransferRoots();
  std::vector<Geometry> result;
  ShapeCollector collector(result, path);
  for (int i = 1; i <= reader.NbShapes(); ++i) collector.Add(reader.Shape(i));
  if (result.empty()) throw ReadError(path, "holds no curves or surfaces that can be read");
  return result;
}

}  // namespace

std::vector<Geometry> ReadStep(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  std::string text = ReadWholeFile(path);
  CheckStepSyntax(text, name);
  try {
    const OcctSession session;
    return Translate(text, name);
  } catch (const Standard_Failure& failure) {
    throw ReadError(name, std::string("is damaged: ") + failure.GetMessageString());
  }
}

}  // namespace batten
