// SPDX-License-Identifier: MIT
#include "io/exchange/opencascade_module.h"

#include <dlfcn.h>
#include <link.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace batten::internal {
namespace {

constexpr const char* kModule = "libbatten_opencascade.so";
constexpr const char* kTable = "batten_opencascade_functions";
constexpr const char* kVariable = "BATTEN_MODULES";

// The program or shared library that holds this code; empty: it can't be told.
std::filesystem::path OwnObject() {
  Dl_info info{};
  link_map* object = nullptr;
  void* const here = reinterpret_cast<void*>(&OwnObject);
  if (dladdr1(here, &info, reinterpret_cast<void**>(&object), RTLD_DL_LINKMAP) == 0) return {};
  // The loader knows a program by the word it was called with, which need not be a path.
  const bool program = object == nullptr || *object->l_name == '\0';
  std::error_code unknown;
  return std::filesystem::canonical(program ? "/proc/self/exe" : object->l_name, unknown);
}

// What dlerror has to say since it was last asked.
std::string LoaderError() {
  const char* const text = dlerror();
  return text != nullptr ? text : "";
}

// Null where the file does not load or is no such module.
const OpenCascadeFunctions* Load(const std::string& file) {
  void* const module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) return nullptr;
  void* const table = dlsym(module, kTable);
  if (table == nullptr) return nullptr;
  return reinterpret_cast<const OpenCascadeFunctions* (*)()>(table)();
}

}  // namespace

std::vector<std::string> OpenCascadeFolders() {
  std::vector<std::string> folders;
  if (const char* said = std::getenv(kVariable); said != nullptr && *said != '\0') {
    folders.emplace_back(said);
  }
  if (const std::filesystem::path object = OwnObject(); !object.empty()) {
    const std::filesystem::path own = object.parent_path(), prefix = own.parent_path();
    for (const auto& folder : {own, prefix / "lib/batten", own / "batten"}) {
      folders.push_back(folder.string());
    }
#ifdef BATTEN_MODULE_SUBDIR
    folders.push_back((prefix / BATTEN_MODULE_SUBDIR).string());
#endif
  }
#ifdef BATTEN_MODULE_INSTALL_DIR
  folders.emplace_back(BATTEN_MODULE_INSTALL_DIR);
#endif
#ifdef BATTEN_MODULE_BUILD_DIR
  folders.emplace_back(BATTEN_MODULE_BUILD_DIR);
#endif
  folders.emplace_back();
  return folders;
}

const OpenCascadeFunctions& LoadOpenCascade(const std::vector<std::string>& folders) {
  std::string places, reason;
  for (const std::string& folder : folders) {
    const std::string file = (std::filesystem::path(folder) / kModule).string();
    if (const OpenCascadeFunctions* functions = Load(file)) return *functions;
    const std::string error = LoaderError();
    // Of all reasons the one of a file that is there says most.
    std::error_code unknown;
    if (reason.empty() || std::filesystem::exists(file, unknown)) reason = error;
    places += (places.empty() ? "" : ", ") + (folder.empty() ? "the loader's own" : folder);
  }
  throw std::runtime_error(std::string("STEP, and IGES that is written, need the module ") +
                           kModule + ", which does not load from any of " + places + " (" + reason +
                           "); set " + kVariable + " to the folder that holds it");
}

const OpenCascadeFunctions& OpenCascade() {
  static const OpenCascadeFunctions& functions = LoadOpenCascade(OpenCascadeFolders());
  return functions;
}

}  // namespace batten::internal
