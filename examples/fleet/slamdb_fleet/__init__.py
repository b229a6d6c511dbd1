# SPDX-License-Identifier: BSD-3-Clause
"""Many thousand atlases, checked, described and written again by many processes: the parts of fleet.py."""
