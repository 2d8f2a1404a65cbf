// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace partpose {

/// The report's page without data: web/dist/report.html, which script/build_web makes from web/src. The data goes where
/// `report_data_mark` stands.
std::string_view report_page();
inline constexpr std::string_view report_data_mark = "<!--partpose-report-data-->";

}  // namespace partpose
