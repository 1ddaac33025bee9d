/// Files and pictures of a run.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

namespace collision_node::report {

/// Makes the folder where it is missing. Throws std::runtime_error that names the file.
void writeFile(const std::string& path, const std::function<void(std::ostream&)>& write);

/// Calls a script that makes tables and diagrams of the CSV files in `folder`. What it lacks it says
/// itself, and the CSV files are complete without it.
void present(const std::string& folder, std::ostream& out, const std::string& script = "present.py");

}  // namespace collision_node::report
