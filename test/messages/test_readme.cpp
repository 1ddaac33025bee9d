/// The README's tables of scene keys name every key that the reader of scenes asks for, and no other; each
/// line of "what must be true of your data" is quoted by a test.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace collision_node::messages {
namespace {

using Keys = std::set<std::string>;

std::string textOf(const std::string& file) {
  std::ifstream in(std::string(SOURCE_DIR) + "/" + file);
  EXPECT_TRUE(in) << file;
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void collect(const std::string& text, const std::regex& pattern, Keys& keys) {
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
    keys.insert((*match)[1]);
}

/// Every name that the sources hand to a MapReader.
Keys keysOfTheReader() {
  Keys keys;
  const std::regex call(
      R"re((?:\b(?:real|reals|vec3|text|flag|whole|choice|find|map|has|readList)\(|needReal\(\w+,\s*)"(\w+)")re");
  for (const char* file : {"scene_file", "object_reader", "source_reader", "pair_reader", "map_reader"})
    collect(textOf(std::string("collision_node/scene/file/") + file + ".cpp"), call, keys);
  // The shapes are a list of words.
  const std::string reader = textOf("collision_node/scene/file/object_reader.cpp");
  const auto from = reader.find("kShapeKeys = {");
  EXPECT_NE(from, std::string::npos);
  collect(reader.substr(from, reader.find('}', from) - from), std::regex("\"(\\w+)\""), keys);
  return keys;
}

/// Every part of every path in the tables, and the names in braces beside them.
Keys keysOfTheReadme() {
  Keys keys;
  std::istringstream in(textOf("README.md"));
  bool in_table = false;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("| key | default |", 0) == 0) in_table = true;
    if (line.empty() || line[0] != '|') in_table = false;
    if (!in_table || line.rfind("| `", 0) != 0) continue;
    const std::string first = line.substr(0, line.find('|', 1));
    Keys paths;
    collect(first, std::regex("`([\\w/]+)`"), paths);
    for (const auto& path : paths) collect(path, std::regex("(\\w+)"), keys);
    for (std::size_t open = line.find('{'); open != std::string::npos; open = line.find('{', open + 1))
      collect(line.substr(open, line.find('}', open) - open), std::regex("`(\\w+)`"), keys);
  }
  keys.erase("X");  // stands for a name
  return keys;
}

TEST(Readme, namesEveryKeyThatTheReaderKnows) {
  const Keys reader = keysOfTheReader();
  ASSERT_GT(reader.size(), 40u) << "the sources are not written as this test reads them";
  const Keys readme = keysOfTheReadme();
  for (const auto& key : reader) EXPECT_EQ(readme.count(key), 1u) << key << " is missing in README.md";
  for (const auto& key : readme)
    EXPECT_EQ(reader.count(key), 1u) << key << " is in README.md, but nobody reads it";
}

/// The first cells of a table.
std::vector<std::string> assumptions() {
  std::vector<std::string> out;
  std::istringstream in(textOf("README.md"));
  bool in_table = false;
  for (std::string line; std::getline(in, line);) {
    if (line.empty()) in_table = false;
    if (in_table && line.rfind("|--", 0) != 0) out.push_back(line.substr(2, line.find(" |", 2) - 2));
    if (line == "| what is assumed | when it is not |") in_table = true;
  }
  return out;
}

TEST(Readme, everyAssumptionIsQuotedByATest) {
  std::string tests;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(std::string(SOURCE_DIR) + "/test")) {
    const std::string kind = entry.path().extension();
    if (kind == ".cpp" || kind == ".py")
      tests += textOf("test/" +
                      std::filesystem::relative(entry.path(), std::string(SOURCE_DIR) + "/test").string());
  }
  tests = std::regex_replace(tests, std::regex("\n *//+ "), " ");  // comments are broken into lines
  const auto rows = assumptions();
  EXPECT_GE(rows.size(), 12u);
  for (const auto& row : rows)
    EXPECT_NE(tests.find("README: \"" + row + "\""), std::string::npos) << "no test quotes: " << row;
}

}  // namespace
}  // namespace collision_node::messages
