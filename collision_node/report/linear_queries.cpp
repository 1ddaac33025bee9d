#include "collision_node/report/linear_queries.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace collision_node::report {
namespace {

/// Each fraction is a double whose denominator is a power of two: both parts and their quotient are exact,
/// also those that no integer type holds.
double fraction(const std::string& numerator, const std::string& denominator) {
  return std::strtod(numerator.c_str(), nullptr) / std::strtod(denominator.c_str(), nullptr);
}

void readFile(const std::filesystem::path& path, std::vector<LinearQuery>& queries) {
  constexpr int kRows = 8;  // four vertices at the start, the same at the end
  std::ifstream file(path);
  LinearQuery query;
  query.edges = path.parent_path().filename() == "edge-edge";
  query.made_by_hand = path.parent_path().parent_path().filename() == "unit-tests";
  int row = 0;
  for (std::string line; std::getline(file, line); row = (row + 1) % kRows) {
    std::istringstream cells(line);
    std::array<std::string, 7> cell;
    for (std::string& one : cell) std::getline(cells, one, ',');
    if (cell[6].empty()) throw std::runtime_error(path.string() + ": not seven columns: " + line);
    impact::LinearVertex& vertex = query.vertices[row % 4];
    geometry::Vec3& x = row < 4 ? vertex.start : vertex.end;
    for (int i = 0; i < 3; ++i) x[i] = fraction(cell[2 * i], cell[2 * i + 1]);
    query.touches = cell[6][0] == '1';
    if (row == kRows - 1) queries.push_back(query);
  }
}

}  // namespace

std::vector<LinearQuery> readLinearQueries(const std::filesystem::path& folder) {
  std::vector<LinearQuery> queries;
  if (!std::filesystem::exists(folder)) return queries;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) readFile(file, queries);
  return queries;
}

}  // namespace collision_node::report
