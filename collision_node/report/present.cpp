#include "collision_node/report/present.h"

#include <spawn.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>

#include "collision_node/messages/resources.h"

extern char** environ;

namespace collision_node::report {
namespace {

namespace fs = std::filesystem;

/// Beside the installed program, else in the sources.
std::string pathOf(const std::string& script) {
  const fs::path self = fs::canonical("/proc/self/exe"), beside = self.parent_path() / script;
  if (fs::exists(beside)) return beside.string();
  return messages::makeResources(self.string()).package_path("collision_node") + "/collision_node/report/" +
         script;
}

}  // namespace

void writeFile(const std::string& path, const std::function<void(std::ostream&)>& write) {
  const fs::path folder = fs::path(path).parent_path();
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  std::ofstream file(path);
  write(file);
  file.flush();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

void present(const std::string& folder, std::ostream& out, const std::string& script) {
  out.flush();
  std::string python = "/usr/bin/python3", file = pathOf(script), where = folder;
  char* arguments[] = {python.data(), file.data(), where.data(), nullptr};
  pid_t child = 0;
  int status = -1;
  if (posix_spawn(&child, python.c_str(), nullptr, nullptr, arguments, environ) != 0 ||
      waitpid(child, &status, 0) != child || status != 0) {
    out << "No tables or diagrams: " << python << " " << file << " " << where
        << " failed; the CSV files are complete.\n";
  }
}

}  // namespace collision_node::report
