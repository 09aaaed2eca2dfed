# SPDX-License-Identifier: Apache-2.0
"""The parts of tools/walk, a job each."""
