// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/descriptor/cvfh.hpp"
#include "partpose/descriptor/esf.hpp"
#include "partpose/descriptor/global_descriptor.hpp"
#include "partpose/descriptor/good.hpp"
#include "partpose/descriptor/our_cvfh.hpp"
#include "partpose/descriptor/vfh.hpp"

#include <string>
#include <vector>

namespace partpose {

/// The options of every global descriptor. A new descriptor is a file pair with its options and `make_descriptor`, and
/// its lines here.
struct DescriptorOptions {
  VfhOptions vfh;
  CvfhOptions cvfh;
  OurCvfhOptions ourcvfh;
  EsfOptions esf;
  GoodOptions good;

  template <typename Self, typename Visit>
  static void describe(Self& self, Visit&& visit) {
    visit("vfh", self.vfh, "Viewpoint Feature Histogram");
    visit("cvfh", self.cvfh, "Clustered Viewpoint Feature Histogram");
    visit("ourcvfh", self.ourcvfh, "Oriented, Unique and Repeatable CVFH");
    visit("esf", self.esf, "Ensemble of Shape Functions");
    visit("good", self.good, "Global Orthographic Object Descriptor");
  }
};

/// The names that a configuration may give, in the order of DescriptorOptions.
const std::vector<std::string>& descriptor_names();

/// By its name in the configuration. Throws Error for a name that this version does not have.
std::unique_ptr<GlobalDescriptor> make_global_descriptor(const std::string& name, const DescriptorOptions& options);

/// How many nearest neighbours the configuration asks for with this descriptor.
int neighbours_of(const std::string& name, const DescriptorOptions& options);

}  // namespace partpose
