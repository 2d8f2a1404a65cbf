// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/io/new_folder.hpp"

#include "partpose/core/error.hpp"

#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <utility>

namespace partpose {

namespace fs = std::filesystem;

namespace {

void remove_leftovers(const fs::path& target) {
  const std::string prefix = target.filename().string() + ".partial-";
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(target.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    const int process = name.starts_with(prefix) ? std::atoi(name.c_str() + prefix.size()) : 0;
    if (process > 0 && kill(process, 0) != 0) fs::remove_all(entry.path(), ignored);
  }
}

}  // namespace

NewFolder::NewFolder(const fs::path& target, std::string mark, std::set<std::string> entries)
    : target_(fs::absolute(target).lexically_normal()), mark_(std::move(mark)), entries_(std::move(entries)) {
  if (!target_.has_filename()) target_ = target_.parent_path();
  entries_.insert(mark_);
  check_replaceable();
  remove_leftovers(target_);
  partial_ = target_.string() + fmt::format(".partial-{}", getpid());
  fs::create_directories(partial_);
}

NewFolder::~NewFolder() {
  std::error_code ignored;
  if (!partial_.empty()) fs::remove_all(partial_, ignored);
}

void NewFolder::check_replaceable() const {
  if (!fs::exists(target_)) return;
  if (!fs::is_directory(target_)) throw Error("{}: exists and is not a folder", target_.string());
  bool marked = fs::is_empty(target_);
  for (const auto& entry : fs::directory_iterator(target_)) {
    const std::string name = entry.path().filename().string();
    marked = marked || name == mark_;
    if (!entries_.contains(name))
      throw Error("{}: exists and holds other things (\"{}\") than an older output; give another folder",
                  target_.string(), name);
  }
  if (!marked) throw Error("{}: exists, but has no {}; give another folder, or an empty one", target_.string(), mark_);
}

void NewFolder::finish() {
  check_replaceable();
  const fs::path old = target_.string() + fmt::format(".old-{}", getpid());
  if (fs::exists(target_)) fs::rename(target_, old);
  fs::rename(partial_, target_);
  partial_.clear();
  fs::remove_all(old);
}

}  // namespace partpose
