# SPDX-License-Identifier: Apache-2.0
"""How much longer everything takes on a machine that others use too: what is waited for is waited for so many times as
long."""
import os


def times():
    return max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))
