// SPDX-License-Identifier: MIT
#include "batten/io/file_format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <optional>
#include <string_view>

#include "batten/io/read_error.h"

namespace batten {
namespace {

struct KnownWord {
  std::string_view word;  // an extension without its dot, or a format word
  FileFormat format;
};
constexpr std::array kKnown{
    KnownWord{"pcd", FileFormat::kPcd},    KnownWord{"ply", FileFormat::kPly},
    KnownWord{"xyz", FileFormat::kXyz},    KnownWord{"csv", FileFormat::kCsv},
    KnownWord{"text", FileFormat::kText},  KnownWord{"txt", FileFormat::kText},
    KnownWord{"asc", FileFormat::kText},   KnownWord{"pts", FileFormat::kText},
    KnownWord{"xy", FileFormat::kText},    KnownWord{"dat", FileFormat::kText},
    KnownWord{"af", FileFormat::kText},    KnownWord{"fxs", FileFormat::kText},
    KnownWord{"xyzl", FileFormat::kText},  KnownWord{"xyzi", FileFormat::kText},
    KnownWord{"xyzn", FileFormat::kText},  KnownWord{"xyzrgb", FileFormat::kText},
    KnownWord{"uvxyz", FileFormat::kText}, KnownWord{"las", FileFormat::kLas},
    KnownWord{"obj", FileFormat::kObj},    KnownWord{"stl", FileFormat::kStl},
    KnownWord{"off", FileFormat::kOff},    KnownWord{"json", FileFormat::kJson},
    KnownWord{"step", FileFormat::kStep},  KnownWord{"stp", FileFormat::kStep},
    KnownWord{"iges", FileFormat::kIges},  KnownWord{"igs", FileFormat::kIges},
    KnownWord{"brep", FileFormat::kBrep},  KnownWord{"brp", FileFormat::kBrep},
    KnownWord{"rle", FileFormat::kBrep},   KnownWord{"glb", FileFormat::kGlb},
};

struct UnsupportedWord {
  std::string_view word, advice;
};
constexpr std::array kUnsupported{
    UnsupportedWord{"laz", "decompress it to .las, as with `laszip -i scan.laz -o scan.las`"},
    UnsupportedWord{
        "e57",
        "export it as .las, .ply or .xyz from the scanner's program or CloudCompare, or "
        "run `pdal translate scan.e57 scan.las`"},
    UnsupportedWord{"3dm", "export it as .step from Rhino"},
    UnsupportedWord{"g2", "export it as .step from a program that reads GoTools files"},
};

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return text;
}

std::optional<FileFormat> Known(std::string_view word) {
  for (const KnownWord& known : kKnown) {
    if (known.word == word) return known.format;
  }
  return std::nullopt;
}

const UnsupportedWord* Unsupported(std::string_view word) {
  const auto found = std::find_if(
      kUnsupported.begin(), kUnsupported.end(), [&](const auto& one) { return one.word == word; });
  return found == kUnsupported.end() ? nullptr : &*found;
}

// Without its dot, in lower case; empty where there is none.
std::string ExtensionOf(const std::string& path) {
  const std::string extension = Lower(std::filesystem::path(path).extension().string());
  // The word "text" is no extension.
  return extension.size() < 2 || extension == ".text" ? "" : extension.substr(1);
}

FileFormat FormatOfWord(const std::string& word, const std::string& subject) {
  if (const auto format = Known(word)) return *format;
  if (const UnsupportedWord* unsupported = Unsupported(word)) {
    throw UsageError(subject + ": ." + word +
                     " files are not supported: " + std::string(unsupported->advice));
  }
  throw UsageError(subject + ": unknown format '" + word +
                   "'; known are pcd, ply, las, obj, stl, off, glb, text, xyz, csv, json, step, "
                   "iges and brep (say "
                   "which with --format, of an output with --output-format)");
}

}  // namespace

std::optional<FileFormat> FormatOfName(const std::string& path) { return Known(ExtensionOf(path)); }

bool IsUnsupportedName(const std::string& path) {
  return Unsupported(ExtensionOf(path)) != nullptr;
}

FileFormat FormatOf(const std::string& path, const std::string& format) {
  if (!format.empty()) return FormatOfWord(Lower(format), path);
  if (path == "-")
    throw UsageError(
        "-: standard input needs --format, standard output --format or --output-format");
  const std::string extension = ExtensionOf(path);
  if (path.empty()) throw UsageError("the name of a file is empty: it does not say the format");
  if (extension.empty()) {
    throw UsageError(path +
                     ": the name does not say the format; say it with --format, of an output with "
                     "--output-format (pcd, ply, las, obj, stl, off, glb, text, xyz, csv, json, "
                     "step, iges, brep)");
  }
  return FormatOfWord(extension, path);
}

const char* FormatName(FileFormat format) {
  switch (format) {
    case FileFormat::kPcd:
      return "pcd";
    case FileFormat::kPly:
      return "ply";
    case FileFormat::kText:
      return "text";
    case FileFormat::kXyz:
      return "xyz";
    case FileFormat::kCsv:
      return "csv";
    case FileFormat::kLas:
      return "las";
    case FileFormat::kObj:
      return "obj";
    case FileFormat::kStl:
      return "stl";
    case FileFormat::kOff:
      return "off";
    case FileFormat::kGlb:
      return "glb";
    case FileFormat::kJson:
      return "json";
    case FileFormat::kStep:
      return "step";
    case FileFormat::kIges:
      return "iges";
    case FileFormat::kBrep:
      return "brep";
  }
  return "?";
}

bool IsGeometryFormat(FileFormat format) {
  return format == FileFormat::kJson || format == FileFormat::kStep ||
         format == FileFormat::kIges || format == FileFormat::kBrep;
}

bool IsCloudFormat(FileFormat format) { return !IsGeometryFormat(format); }

bool IsTextFormat(FileFormat format) {
  return format == FileFormat::kText || format == FileFormat::kXyz || format == FileFormat::kCsv;
}

bool IsReadable(FileFormat) { return true; }

bool IsWritable(FileFormat format) {
  return format != FileFormat::kLas && format != FileFormat::kObj && format != FileFormat::kStl &&
         format != FileFormat::kOff && format != FileFormat::kGlb;
}

}  // namespace batten
