# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
from partpose._partpose.engine import *  # noqa: F403
