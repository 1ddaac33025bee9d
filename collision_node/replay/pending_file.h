/// Result files that appear under their names only when they are whole.
#pragma once

#include <fstream>
#include <string>
#include <vector>

namespace collision_node::replay {

/// A file that is written beside its name (`name.part`) and gets the name in keep(); without keep() it leaves
/// no trace. A name that exists and is no regular file (a device, a pipe) is written straight into: nothing
/// is ever renamed over it.
class PendingFile {
 public:
  /// Throws InputError: the name is a folder, its folder does not exist, or writing would touch one of
  /// `inputs` or what one of `others` writes (null: none).
  PendingFile(std::string name, const std::vector<std::string>& inputs,
              const std::vector<const PendingFile*>& others);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::string& name() const { return name_; }
  /// Where to write until keep().
  const std::string& path() const { return part_; }
  /// Written straight into, front to back: nothing that seeks may be kept there.
  bool isStream() const { return is_stream_; }

  /// Throws InputError when the file cannot get its name.
  void keep();

 private:
  void checkApart(const std::vector<std::string>& inputs,
                  const std::vector<const PendingFile*>& others) const;

  std::string name_;    // as the user gave it
  std::string target_;  // the name behind symbolic links
  std::string part_;
  bool is_stream_ = false;
};

/// Opens the file for text. Throws InputError.
void openText(std::ofstream& stream, const PendingFile& file);
/// Closes it and gives it its name. Throws InputError when it could not be written whole.
void finishText(std::ofstream& stream, PendingFile& file);

}  // namespace collision_node::replay
