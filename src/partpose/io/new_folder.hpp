// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace partpose {

/// A folder that comes into being all at once: written beside its place, then renamed. Nobody ever sees it half
/// written; when it is not finished, nothing of it remains. What processes that were killed left beside is removed.
class NewFolder {
 public:
  /// Throws Error when `target` exists and is neither empty nor a folder with the file `mark` and nothing but
  /// `entries`: what would be replaced must be an older one of its kind.
  NewFolder(const std::filesystem::path& target, std::string mark, std::set<std::string> entries);
  ~NewFolder();
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  /// Where to write.
  const std::filesystem::path& path() const { return partial_; }
  /// Puts it in its place.
  void finish();

 private:
  void check_replaceable() const;

  std::filesystem::path target_, partial_;
  std::string mark_;
  std::set<std::string> entries_;
};

}  // namespace partpose
