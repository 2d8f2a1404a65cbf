# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
from partpose._partpose.report import *  # noqa: F403
