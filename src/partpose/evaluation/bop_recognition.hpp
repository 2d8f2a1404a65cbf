// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/progress.hpp"
#include "partpose/io/bop.hpp"
#include "partpose/pipeline/recognizer.hpp"

#include <filesystem>
#include <map>
#include <vector>

namespace partpose {

/// The catalogue of those objects of a dataset that its targets ask for, kept under `cache_folder`; a part is named as
/// its model file is: obj_000001. Throws Error without targets.
Catalogue bop_catalogue(const BopDataset& dataset, const std::filesystem::path& cache_folder,
                        const Progress& progress = {});

/// The instances that are wanted, by obj_id, in one depth image: the best object is recognized, what it explains of the
/// image is taken out, and again, until all are found or nothing is recognized. Of a segment's candidates the first
/// that is wanted counts. `time_s` is the time of the whole.
std::vector<BopEstimate> recognize_bop_image(const PartRecognizer& recognizer, const DepthImage& depth,
                                             const Intrinsics& camera, std::map<int, int> wanted, float min_score);

/// The estimates of all targets' images, one image after the other. Throws Error when a depth image is missing or a
/// camera has skew.
std::vector<BopEstimate> recognize_bop(const BopDataset& dataset, const PartRecognizer& recognizer, float min_score,
                                       const Progress& progress = {});

}  // namespace partpose
