#include "collision_node/replay/pending_file.h"

#include <filesystem>
#include <utility>

#include "collision_node/replay/options.h"

namespace collision_node::replay {

namespace {

namespace fs = std::filesystem;

bool isSame(const std::string& a, const std::string& b) {
  std::error_code ignored;
  if (fs::equivalent(a, b, ignored)) return true;
  return fs::weakly_canonical(fs::absolute(a, ignored), ignored) ==
         fs::weakly_canonical(fs::absolute(b, ignored), ignored);
}

}  // namespace

PendingFile::PendingFile(std::string name, const std::vector<std::string>& inputs,
                         const std::vector<const PendingFile*>& others)
    : name_(std::move(name)), target_(name_) {
  std::error_code ignored;
  if (fs::is_directory(name_, ignored)) throw InputError(name_ + ": is a folder; a file name is expected");
  const fs::path folder = fs::path(name_).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, ignored))
    throw InputError(name_ + ": its folder " + folder.string() + " does not exist");
  is_stream_ = fs::exists(name_, ignored) && !fs::is_regular_file(name_, ignored);
  // A rename would put the file in the link's place.
  if (!is_stream_ && fs::is_symlink(name_, ignored) && fs::exists(name_, ignored))
    target_ = fs::canonical(name_, ignored).string();
  part_ = is_stream_ ? name_ : target_ + ".part";
  checkApart(inputs, others);
}

PendingFile::~PendingFile() {
  std::error_code ignored;
  if (!is_stream_) fs::remove(part_, ignored);
}

void PendingFile::checkApart(const std::vector<std::string>& inputs,
                             const std::vector<const PendingFile*>& others) const {
  if (is_stream_) return;
  for (const auto& input : inputs) {
    if (isSame(input, target_)) throw InputError(name_ + ": is an input; results need another name");
    if (isSame(input, part_))
      throw InputError(name_ + ": is written as " + part_ + " first, which is an input; give another name");
  }
  for (const PendingFile* other : others) {
    if (other == nullptr) continue;
    const bool apart = !isSame(target_, other->target_) && !isSame(target_, other->part_) &&
                       !isSame(part_, other->target_) && !isSame(part_, other->part_);
    if (!apart)
      throw InputError(name_ + ": is where " + other->name_ +
                       " is written; each result needs a file of its own");
  }
}

void PendingFile::keep() {
  if (is_stream_) return;
  std::error_code fault;
  fs::rename(part_, target_, fault);
  if (fault) throw InputError(name_ + ": cannot be written (" + fault.message() + ")");
}

void openText(std::ofstream& stream, const PendingFile& file) {
  stream.open(file.path(), std::ios::binary | (file.isStream() ? std::ios::app : std::ios::trunc));
  if (!stream) throw InputError(file.path() + ": cannot be written");
}

void finishText(std::ofstream& stream, PendingFile& file) {
  stream.close();
  if (!stream) throw InputError(file.path() + ": could not be written whole (disk full?)");
  file.keep();
}

}  // namespace collision_node::replay
