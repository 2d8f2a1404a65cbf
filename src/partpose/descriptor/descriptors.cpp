// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "partpose/descriptor/descriptors.hpp"

#include "partpose/core/error.hpp"
#include "partpose/core/text.hpp"

namespace partpose {

void check_neighbours(int k_nn) {
  if (k_nn < 1) throw Error("k_nn {}: must be 1 or more", k_nn);
}

const std::vector<std::string>& descriptor_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    const DescriptorOptions options;
    DescriptorOptions::describe(options, [&](const char* name, const auto&, const char*) { all.emplace_back(name); });
    return all;
  }();
  return names;
}

std::unique_ptr<GlobalDescriptor> make_global_descriptor(const std::string& name, const DescriptorOptions& options) {
  std::unique_ptr<GlobalDescriptor> descriptor;
  DescriptorOptions::describe(options, [&](const char* known, const auto& of_it, const char*) {
    if (name == known) descriptor = make_descriptor(of_it);
  });
  if (!descriptor)
    throw Error("global_descriptor \"{}\" is unknown; did you mean \"{}\"?", name,
                nearest_word(name, descriptor_names()));
  return descriptor;
}

int neighbours_of(const std::string& name, const DescriptorOptions& options) {
  int k_nn = 0;
  DescriptorOptions::describe(options, [&](const char* known, const auto& of_it, const char*) {
    if (name == known) k_nn = of_it.k_nn;
  });
  return k_nn;
}

}  // namespace partpose
