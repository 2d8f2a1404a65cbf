# SPDX-FileCopyrightText: 2026 partpose contributors
# SPDX-License-Identifier: Apache-2.0
"""`python -m partpose live ...`: the command of partpose/live.py."""

import sys

from partpose.live import main

if len(sys.argv) < 2 or sys.argv[1] != "live":
    print("usage: python -m partpose live SOURCE --models PARTS; the other commands are the program partpose's", file=sys.stderr)
    sys.exit(2)
sys.exit(main(sys.argv[2:]))
